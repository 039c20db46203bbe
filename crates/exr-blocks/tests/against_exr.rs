//! What the `exr` crate and this one make of the same blocks.

use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType};
use exr::meta::header::Header;
use exr::prelude::Vec2;
use exr_blocks::{piz, zip};
use proptest::prelude::*;

fn header(kinds: &[SampleType], width: usize, height: usize, compression: Compression) -> Header {
    let channel = |(i, kind): (usize, &SampleType)| {
        ChannelDescription::named(format!("c{i:02}").as_str(), *kind)
    };
    let channels = kinds.iter().enumerate().map(channel).collect();
    let encoding = (compression, BlockDescription::ScanLines, LineOrder::Increasing);
    Header::new("part".into(), Vec2(width, height), channels)
        .with_encoding(encoding.0, encoding.1, encoding.2)
}

/// Encodes a block by the `exr` crate and decodes it by both; a block that does not shrink is left
/// out.
fn piz_comes_back(kinds: &[SampleType], width: usize, height: usize, block: Vec<u8>) {
    let header = header(kinds, width, height, Compression::PIZ);
    let area = IntegerBounds::from_dimensions(Vec2(width, height));
    let packed =
        Compression::PIZ.compress_image_section_to_le(&header, block.clone(), area).unwrap();
    if packed.len() == block.len() {
        return;
    }
    let channel =
        |kind: &SampleType| piz::Channel { wide: *kind != SampleType::F16, sampling: (1, 1) };
    let channels: Vec<piz::Channel> = kinds.iter().map(channel).collect();
    assert_eq!(piz::decoded(&packed, &channels, width, 0..height as i32).as_ref(), Ok(&block));
    assert_eq!(
        Compression::PIZ.decompress_image_section_from_le(&header, packed, area, true).unwrap(),
        block
    );
}

fn kind() -> impl Strategy<Value = SampleType> {
    prop_oneof![Just(SampleType::F16), Just(SampleType::F32), Just(SampleType::U32)]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn every_piz_block_is_decoded_to_the_same_bits(
        kinds in prop::collection::vec(kind(), 1..6),
        width in 1usize..90,
        height in 1usize..=32,
        seed in any::<u32>(),
        kept_bits in 0u32..=16,
        run in 1usize..400,
    ) {
        let words: usize = kinds.iter().map(|kind| kind.bytes_per_sample() / 2).sum();
        let words = words * width * height;
        let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        let noise: Vec<u32> = std::iter::successors(Some(seed), next).take(words).collect();
        let word = |i: usize| (noise[i / run] >> 16).checked_shr(16 - kept_bits).unwrap_or(0) as u16;
        let block = (0..words).flat_map(|i| word(i).to_le_bytes()).collect();
        piz_comes_back(&kinds, width, height, block);
    }

    #[test]
    fn every_zip_block_is_read_by_the_exr_crate(
        width in 1usize..300,
        height in 1usize..=16,
        seed in any::<u32>(),
        run in 1usize..100,
    ) {
        let header = header(&[SampleType::F16; 3], width, height, Compression::ZIP16);
        let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        let noise: Vec<u32> =
            std::iter::successors(Some(seed), next).take(6 * width * height).collect();
        let block: Vec<u8> = (0..6 * width * height).map(|i| (noise[i / run] >> 26) as u8).collect();
        let area = IntegerBounds::from_dimensions(Vec2(width, height));
        let packed = zip::compressed(block.clone());
        prop_assert!(packed.len() <= block.len());
        let read = Compression::ZIP16.decompress_image_section_from_le(&header, packed, area, true).unwrap();
        prop_assert_eq!(read, block);
    }
}

#[test]
fn smooth_and_constant_pictures_come_back() {
    for (width, height) in [(64, 32), (33, 17), (1, 32), (640, 1), (5, 31)] {
        let ramp = (0..3 * width * height)
            .flat_map(|i| (0x3000 + (i % 977) as u16).to_le_bytes())
            .collect();
        piz_comes_back(&[SampleType::F16; 3], width, height, ramp);
        piz_comes_back(&[SampleType::F32], width, height, vec![0; 4 * width * height]);
        let floats =
            (0..2 * width * height).flat_map(|i| (i as f32 * 0.37).sin().to_le_bytes()).collect();
        piz_comes_back(&[SampleType::F32; 2], width, height, floats);
    }
}

#[test]
fn words_whose_code_is_long_come_back() {
    // Fibonacci counts give Huffman's tree a branch of more than twenty.
    let (mut count, mut next, mut block) = (1usize, 2usize, Vec::new());
    for word in 1u16..24 {
        block.extend(std::iter::repeat_n(word * 2741, count));
        (count, next) = (next, count + next);
    }
    let mixed: Vec<u16> = (0..block.len()).map(|i| block[i * 7919 % block.len()]).collect();
    let width = mixed.len() / 32;
    let bytes = mixed[..32 * width].iter().flat_map(|word| word.to_le_bytes()).collect();
    piz_comes_back(&[SampleType::F16], width, 32, bytes);
}
