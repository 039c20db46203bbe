//! Pictures out: OpenEXR with its blocks compressed in the current rayon pool, and sRGB PNG.
//!
//! The same planes give the same bytes, whatever the number of threads. (The `exr` crate keeps free
//! attributes in a hash map, so there is only one, `sungaze`; everything else goes into named
//! fields.)

use std::path::Path;
use std::str::FromStr;

use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::writer::ChunksWriter;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, LineOrder, Rational,
    SampleType, Text,
};
use exr::meta::header::Header;
use exr_blocks::zip;
use half::f16;
use rayon::prelude::*;

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::atomic::{Sink, write_whole};
use crate::light::{Planes, Row, Samples};
use crate::units::Nits;

/// How the blocks of a written file are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    None,
    Rle,
    Zips,
    Zip,
    Piz,
    Pxr24,
    B44,
    B44a,
    Dwaa,
    Dwab,
}

impl Compression {
    /// Every compression, under the name it has in a configuration.
    pub const ALL: [(&'static str, Compression); 10] = [
        ("none", Compression::None),
        ("rle", Compression::Rle),
        ("zips", Compression::Zips),
        ("zip", Compression::Zip),
        ("piz", Compression::Piz),
        ("pxr24", Compression::Pxr24),
        ("b44", Compression::B44),
        ("b44a", Compression::B44a),
        ("dwaa", Compression::Dwaa),
        ("dwab", Compression::Dwab),
    ];

    pub(super) fn in_file(self) -> exr::compression::Compression {
        use exr::compression::Compression as Code;
        match self {
            Compression::None => Code::Uncompressed,
            Compression::Rle => Code::RLE,
            Compression::Zips => Code::ZIP1,
            Compression::Zip => Code::ZIP16,
            Compression::Piz => Code::PIZ,
            Compression::Pxr24 => Code::PXR24,
            Compression::B44 => Code::B44,
            Compression::B44a => Code::B44A,
            Compression::Dwaa => Code::DWAA(None),
            Compression::Dwab => Code::DWAB(None),
        }
    }
}

impl FromStr for Compression {
    type Err = String;

    /// A name of [`Compression::ALL`]; the problem lists them.
    fn from_str(name: &str) -> Result<Self, String> {
        let found = Compression::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, compression)| *compression).ok_or_else(|| {
            let names: Vec<&str> = Compression::ALL.iter().map(|(known, _)| *known).collect();
            format!("`{name}` is no compression; there are {}", names.join(", "))
        })
    }
}

/// What a written file says of itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    pub primaries: Option<Primaries>,
    pub white: Option<Nits>,
    pub frames_per_second: Option<f64>,
    /// The text of the attribute `sungaze`, JSON: what made the file, and from what.
    pub sungaze: Option<String>,
}

/// Writes planes as the channels `names`, each plane in the width that it has. Halves beyond the
/// largest finite half are written as that.
pub fn write_exr(
    path: &Path,
    names: &[&str],
    planes: &Planes,
    compression: Compression,
    about: &About,
) -> Result<()> {
    let (header, order) = header(names, planes, compression, about);
    let blocks = packed_blocks(planes, &header, &order, compression)
        .map_err(|error| Error::file(path, format!("cannot be written as OpenEXR: {error}")))?;
    write_whole(path, |sink| {
        let written = write_blocks(sink, header, blocks);
        written.map_err(|error| match error {
            exr::error::Error::Io(error) => error,
            other => std::io::Error::other(other),
        })
    })
}

/// The blocks of a file as they are stored, from the top.
fn packed_blocks(
    planes: &Planes,
    header: &Header,
    order: &[usize],
    compression: Compression,
) -> exr::error::Result<Vec<Vec<u8>>> {
    let lines = header.compression.scan_lines_per_block();
    let row_length = planes.width * header.channels.bytes_per_pixel;
    let block = |block: usize| {
        let rows = block * lines..planes.height.min((block + 1) * lines);
        let mut bytes = vec![0; rows.len() * row_length];
        for (y, bytes) in rows.clone().zip(bytes.chunks_exact_mut(row_length)) {
            fill_row(planes, y, order, bytes);
        }
        packed(bytes, header, compression, rows)
    };
    (0..planes.height.div_ceil(lines)).into_par_iter().map(block).collect()
}

fn write_blocks(
    sink: &mut dyn Sink,
    header: Header,
    blocks: Vec<Vec<u8>>,
) -> exr::error::Result<()> {
    let lines = header.compression.scan_lines_per_block();
    exr::block::write(sink, [header].into_iter().collect(), true, |_, writer| {
        for (i, compressed_pixels_le) in blocks.into_iter().enumerate() {
            let y_coordinate = (i * lines) as i32;
            let block = CompressedScanLineBlock { y_coordinate, compressed_pixels_le };
            let compressed_block = CompressedBlock::ScanLine(block);
            writer.write_chunk(i, Chunk { layer_index: 0, compressed_block })?;
        }
        Ok(())
    })
}

/// The header, and the plane of each channel in the file's alphabetical order.
fn header(
    names: &[&str],
    planes: &Planes,
    compression: Compression,
    about: &About,
) -> (Header, Vec<usize>) {
    let kind = match planes.samples {
        Samples::Half(_) => SampleType::F16,
        Samples::Float(_) => SampleType::F32,
    };
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by_key(|&plane| names[plane]);
    let channels =
        order.iter().map(|&plane| ChannelDescription::named(names[plane], kind)).collect();
    let size = Vec2(planes.width, planes.height);
    let mut header = Header::new(Text::default(), size, channels).with_encoding(
        compression.in_file(),
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    header.shared_attributes.display_window = IntegerBounds::from_dimensions(size);
    tell(&mut header, about);
    (header, order)
}

/// Puts what a file says of itself into its header.
pub(super) fn tell(header: &mut Header, about: &About) {
    header.shared_attributes.chromaticities = about.primaries.map(chromaticities);
    let own = &mut header.own_attributes;
    own.layer_name = None;
    own.software_name = Some(Text::from(concat!("sungaze ", env!("CARGO_PKG_VERSION"))));
    own.white_luminance = about.white.map(|white| white.0 as f32);
    own.frames_per_second = about.frames_per_second.map(rational);
    let text = |json: &str| Text::new_or_none(json_ascii(json)).map(AttributeValue::Text);
    let sungaze = about.sungaze.as_deref().and_then(text);
    own.other.extend(sungaze.map(|text| (Text::from("sungaze"), text)));
}

/// The same JSON in ASCII, all that a text attribute is sure to hold.
fn json_ascii(json: &str) -> String {
    let mut units = [0; 2];
    let mut escaped = |c: char| match c {
        c if c.is_ascii() => c.to_string(),
        c => c.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")).collect(),
    };
    json.chars().map(&mut escaped).collect()
}

fn chromaticities(primaries: Primaries) -> Chromaticities {
    let point = |[x, y]: [f64; 2]| Vec2(x as f32, y as f32);
    Chromaticities {
        red: point(primaries.red),
        green: point(primaries.green),
        blue: point(primaries.blue),
        white: point(primaries.white),
    }
}

/// A frame rate as film and video count it: whole, or a whole number of frames in 1.001 s, or in
/// thousandths.
fn rational(rate: f64) -> Rational {
    let ntsc = rate * 1.001;
    if (rate - rate.round()).abs() < 1e-6 {
        (rate.round() as i32, 1)
    } else if (ntsc - ntsc.round()).abs() < 1e-3 {
        (ntsc.round() as i32 * 1000, 1001)
    } else {
        ((rate * 1000.0).round() as i32, 1000)
    }
}

/// One row as it stands in the file: channel after channel, little-endian.
fn fill_row(planes: &Planes, y: usize, order: &[usize], bytes: &mut [u8]) {
    let width = planes.width;
    let channels = order.iter().zip(bytes.chunks_exact_mut(bytes.len() / order.len()));
    match planes.row(y) {
        Row::Half(row) => channels.for_each(|(plane, bytes)| {
            for (bytes, half) in
                bytes.as_chunks_mut().0.iter_mut().zip(&row[plane * width..][..width])
            {
                *bytes = finite(*half).to_le_bytes();
            }
        }),
        Row::Float(row) => channels.for_each(|(plane, bytes)| {
            for (bytes, float) in
                bytes.as_chunks_mut().0.iter_mut().zip(&row[plane * width..][..width])
            {
                *bytes = float.to_le_bytes();
            }
        }),
    }
}

fn finite(half: f16) -> f16 {
    let infinite = half.to_bits() & 0x7fff == 0x7c00;
    if infinite { f16::from_bits(half.to_bits() - 1) } else { half }
}

/// One block as it is stored.
pub(super) fn packed(
    bytes: Vec<u8>,
    header: &Header,
    compression: Compression,
    rows: std::ops::Range<usize>,
) -> exr::error::Result<Vec<u8>> {
    match compression {
        Compression::None => Ok(bytes),
        Compression::Zip | Compression::Zips => Ok(zip::compressed(bytes)),
        _ => {
            let position = Vec2(0, rows.start as i32);
            let area = IntegerBounds::new(position, Vec2(header.layer_size.width(), rows.len()));
            header.compression.compress_image_section_to_le(header, bytes, area)
        }
    }
}

/// Writes an 8-bit sRGB picture: `width * height` pixels of red, green, blue.
pub fn write_png(path: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<()> {
    write_whole(path, |sink| encode_png(sink, width, height, rgb))
}

/// Encodes such a picture.
pub(crate) fn encode_png(
    sink: impl std::io::Write,
    width: usize,
    height: usize,
    rgb: &[u8],
) -> std::io::Result<()> {
    let mut encoder = png::Encoder::new(sink, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    Ok(writer.finish()?)
}
