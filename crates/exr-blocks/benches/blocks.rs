//! One block of 1920 pixels: PIZ here and by the `exr` crate, ZIP here and by the `exr` crate.
//! `cargo bench -p exr-blocks`.

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Vec2, f16};
use exr_blocks::{piz, zip};

fn main() {
    divan::main();
}

/// Halves of RGB, and floats of 31 bands.
const KINDS: [(SampleType, usize); 2] = [(SampleType::F16, 3), (SampleType::F32, 31)];
const WIDTH: usize = 1920;

struct Block {
    header: Header,
    area: IntegerBounds,
    bytes: Vec<u8>,
    channels: Vec<piz::Channel>,
}

/// A soft gradient under noise of two per cent.
fn block((kind, count): (SampleType, usize), compression: Compression) -> Block {
    let channels =
        (0..count).map(|i| ChannelDescription::named(format!("{i:02}").as_str(), kind)).collect();
    let height = compression.scan_lines_per_block();
    let (size, blocks) = (Vec2(WIDTH, height), BlockDescription::ScanLines);
    let header = Header::new("a".into(), size, channels).with_encoding(
        compression,
        blocks,
        LineOrder::Increasing,
    );
    let mut seed = 1u32;
    let mut bytes = Vec::new();
    for i in 0..WIDTH * height * count {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let soft = 1.0 + (i % WIDTH) as f32 / WIDTH as f32 + (i / WIDTH / count) as f32 * 0.01;
        let value = soft * (1.0 + 0.02 * (seed >> 8) as f32 / 16_777_216.0);
        match kind {
            SampleType::F16 => bytes.extend(f16::from_f32(value).to_le_bytes()),
            _ => bytes.extend(value.to_le_bytes()),
        }
    }
    let channels = vec![piz::Channel { wide: kind != SampleType::F16, sampling: (1, 1) }; count];
    Block { header, area: IntegerBounds::from_dimensions(size), bytes, channels }
}

impl Block {
    fn packed(&self) -> Vec<u8> {
        let compression = self.header.compression;
        compression
            .compress_image_section_to_le(&self.header, self.bytes.clone(), self.area)
            .unwrap()
    }
}

#[divan::bench(args = KINDS)]
fn piz_decoded(bencher: Bencher, kind: (SampleType, usize)) {
    let block = block(kind, Compression::PIZ);
    let packed = block.packed();
    bencher
        .counter(BytesCount::new(block.bytes.len()))
        .bench(|| piz::decoded(black_box(&packed), &block.channels, WIDTH, 0..32).unwrap());
}

#[divan::bench(args = KINDS)]
fn piz_decoded_by_exr(bencher: Bencher, kind: (SampleType, usize)) {
    decoded_by_exr(bencher, block(kind, Compression::PIZ));
}

#[divan::bench(args = KINDS)]
fn zip_decoded_by_exr(bencher: Bencher, kind: (SampleType, usize)) {
    decoded_by_exr(bencher, block(kind, Compression::ZIP16));
}

fn decoded_by_exr(bencher: Bencher, block: Block) {
    let packed = block.packed();
    let decoded = |packed| {
        block.header.compression.decompress_image_section_from_le(
            &block.header,
            packed,
            block.area,
            true,
        )
    };
    bencher
        .counter(BytesCount::new(block.bytes.len()))
        .with_inputs(|| packed.clone())
        .bench_values(|packed| decoded(packed).unwrap());
}

#[divan::bench(args = KINDS)]
fn zip_encoded(bencher: Bencher, kind: (SampleType, usize)) {
    let block = block(kind, Compression::ZIP16);
    let count = BytesCount::new(block.bytes.len());
    bencher.counter(count).with_inputs(|| block.bytes.clone()).bench_values(zip::compressed);
}

#[divan::bench(args = KINDS)]
fn zip_encoded_by_exr(bencher: Bencher, kind: (SampleType, usize)) {
    let block = block(kind, Compression::ZIP16);
    bencher.counter(BytesCount::new(block.bytes.len())).bench(|| block.packed());
}
