//! JPEG pictures: ITU-T T.81 and JFIF, decoded by `zune-jpeg`, with what that crate does not tell:
//! whether the file ends as one should, and whether it holds scans that the crate misreads.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::error::{Error, Result};
use crate::frames::displayed::{Codes, Meaning, refuse_spectral};
use crate::frames::format::{Footage, Format};
use crate::frames::options::ReadOptions;
use crate::frames::picture::{DENSEST, Header, believable};
use crate::frames::turn::{Turn, exif_orientation};
use crate::light::{Frame, Planes};
use crate::vision::Projection;

/// Where a header must have told the size of its picture, bytes.
const LONGEST_HEADER: u64 = 1 << 24;
/// More bytes of a file than this for each pixel are not read.
const MOST_PER_PIXEL: u64 = 8;

pub(super) static FORMAT: Format = Format {
    name: "JPEG",
    extensions: &["jpg", "jpeg", "jpe", "jfif"],
    recognise: |_, start| start.starts_with(&[0xff, 0xd8, 0xff]),
    open: |path, options| Ok(Box::new(JpegPicture::open(path, options)?)),
    outline: |_| None,
};

struct JpegPicture {
    path: PathBuf,
    bytes: Vec<u8>,
    meaning: Meaning,
    header: Header,
    options: ReadOptions,
}

impl JpegPicture {
    fn open(path: &Path, options: &ReadOptions) -> Result<JpegPicture> {
        refuse_spectral(path, options)?;
        let fail = |problem: &str| Error::file(path, problem);
        let (bytes, size) = read(path, options)?;
        let outline = Outline::of(&bytes).map_err(fail)?;
        if !outline.ends {
            return Err(fail("is damaged or cut short: it has no end marker"));
        }
        if outline.is_split {
            return Err(fail(
                "keeps its colours in scans of their own; those of one scan are read",
            ));
        }
        let mut meaning = Meaning::srgb();
        meaning.turn = Turn::of_exif(outline.orientation);
        meaning.transfer = options.transfer.unwrap_or(meaning.transfer);
        if outline.has_profile {
            meaning.notes.push("its ICC profile is passed over: decoded as sRGB".into());
        }
        let header = meaning.header(size, options);
        Ok(JpegPicture { path: path.to_owned(), bytes, meaning, header, options: options.clone() })
    }
}

/// The bytes of a file, no more than its picture can need, and the size of the picture as stored.
fn read(path: &Path, options: &ReadOptions) -> Result<(Vec<u8>, (usize, usize))> {
    let mut file = File::open(path).map_err(Error::io(path, "read"))?;
    let mut bytes = Vec::new();
    let mut more = |most: u64, bytes: &mut Vec<u8>| {
        file.by_ref().take(most).read_to_end(bytes).map_err(Error::io(path, "read"))
    };
    more(LONGEST_HEADER, &mut bytes)?;
    let outline = Outline::of(&bytes).map_err(|problem| Error::file(path, problem))?;
    let (width, height) = outline.size;
    believable(path, (width, height), 3, DENSEST, options.max_pixels)?;
    more(MOST_PER_PIXEL * width as u64 * height as u64, &mut bytes)?;
    Ok((bytes, (width, height)))
}

/// What the markers of a file say.
#[derive(Clone, Debug, Default, PartialEq)]
struct Outline {
    size: (usize, usize),
    orientation: u16,
    has_profile: bool,
    /// Sequential, with scans of fewer components than the frame has, of which some are subsampled.
    is_split: bool,
    /// The marker of the end was met.
    ends: bool,
}

impl Outline {
    /// Walks from marker to marker. The problem, if there is one, is a message.
    fn of(bytes: &[u8]) -> Result<Outline, &'static str> {
        if !bytes.starts_with(&[0xff, 0xd8]) {
            return Err("is not a JPEG: it does not begin with its marker");
        }
        let mut outline = Outline { orientation: 1, ..Outline::default() };
        let (mut at, mut subsampled) = (2, 0);
        while let Some((marker, segment)) = segment(bytes, &mut at) {
            match marker {
                0xd9 => {
                    outline.ends = true;
                    break;
                }
                0xc0..=0xcf if !matches!(marker, 0xc4 | 0xc8 | 0xcc) => {
                    let Some((size, components)) = frame(segment) else { break };
                    outline.size = size;
                    subsampled = if marker < 0xc2 { components } else { 0 };
                }
                0xda => {
                    let in_scan = segment.first().copied().unwrap_or_default();
                    outline.is_split |= in_scan < subsampled;
                }
                0xe1 if segment.starts_with(b"Exif\0\0") => {
                    outline.orientation = exif_orientation(&segment[6..]);
                }
                0xe2 if segment.starts_with(b"ICC_PROFILE\0") => outline.has_profile = true,
                _ => {}
            }
        }
        match outline.size {
            (0, _) | (_, 0) => Err("is damaged or cut short: it does not tell its size"),
            _ => Ok(outline),
        }
    }
}

/// Size, and the number of components if some are subsampled, else 0.
fn frame(segment: &[u8]) -> Option<((usize, usize), u8)> {
    let [_, h0, h1, w0, w1, components, rest @ ..] = segment else { return None };
    let size = |a: u8, b: u8| usize::from(u16::from_be_bytes([a, b]));
    let alike = rest.as_chunks::<3>().0.windows(2).all(|pair| pair[0][1] == pair[1][1]);
    Some(((size(*w0, *w1), size(*h0, *h1)), if alike { 0 } else { *components }))
}

/// The next marker and its segment; coded data, stuffing and restarts are passed over.
fn segment<'a>(bytes: &'a [u8], at: &mut usize) -> Option<(u8, &'a [u8])> {
    loop {
        *at += bytes.get(*at..)?.iter().position(|byte| *byte == 0xff)?;
        while bytes.get(*at) == Some(&0xff) {
            *at += 1;
        }
        let marker = *bytes.get(*at)?;
        *at += 1;
        match marker {
            0x00 | 0x01 | 0xd0..=0xd8 => {}
            0xd9 => return Some((marker, &[])),
            _ => {
                let length = bytes.get(*at..*at + 2)?;
                let length = usize::from(u16::from_be_bytes([length[0], length[1]])).max(2);
                let segment = bytes.get(*at + 2..*at + length)?;
                *at += length;
                return Some((marker, segment));
            }
        }
    }
}

impl Footage for JpegPicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, _: usize, _: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
        let damaged = |error| Error::file(&self.path, format!("is damaged or cut short: {error}"));
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&self.bytes), limits());
        decoder.decode_headers().map_err(damaged)?;
        let grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
        if !grey {
            decoder.set_options(limits().jpeg_set_out_colorspace(ColorSpace::RGB));
        }
        let pixels = decoder.decode().map_err(damaged)?;
        let Some(size) = decoder.dimensions() else {
            return Err(Error::file(&self.path, "does not tell its size"));
        };
        let channels = if grey { 1 } else { 3 };
        if pixels.len() != size.0 * size.1 * channels
            || self.meaning.turn.size(size.0, size.1) != (self.header.width, self.header.height)
        {
            return Err(Error::file(&self.path, "is damaged: it holds another size than it says"));
        }
        let codes = Codes::of_bytes(size, channels, &pixels);
        self.meaning.light(&codes, &self.path, &self.options)
    }
}

/// Sizes were held to `max_pixels` before.
fn limits() -> DecoderOptions {
    DecoderOptions::default().set_max_width(usize::MAX).set_max_height(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_markers_are_fatal(
            mut bytes in prop::collection::vec(
                prop_oneof![Just(0xff), Just(0xd9), Just(0xda), Just(0xe1), Just(0xc0), Just(0), any::<u8>()],
                0..200,
            ),
        ) {
            bytes.splice(0..0, [0xff, 0xd8]);
            if let Ok(outline) = Outline::of(&bytes) {
                prop_assert!(outline.size.0 > 0 && outline.size.1 > 0);
            }
        }
    }
}
