//! PNG pictures. PNG specification, third edition (W3C 2025): what the codes mean is told by cICP,
//! else iCCP, else sRGB, else gAMA and cHRM; without any of them they are sRGB.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Decoder, Info, Limits, Reader, Transformations};

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::displayed::{Codes, Meaning, refuse_spectral};
use crate::frames::format::{Footage, Format};
use crate::frames::options::ReadOptions;
use crate::frames::picture::{DENSEST, Header, believable};
use crate::frames::transfer::{Transfer, coded_primaries, coded_transfer};
use crate::frames::turn::{Turn, exif_orientation};
use crate::light::{Frame, Planes};
use crate::vision::Projection;

/// The most that side chunks (profiles) may be inflated to, bytes.
const LARGEST_CHUNK: usize = 1 << 26;

/// gAMA of sRGB, which writers add for readers that know no more (PNG specification, 13.14).
const GAMMA_OF_SRGB: u32 = 45_455;

pub(super) static FORMAT: Format = Format {
    name: "PNG",
    extensions: &["png"],
    recognise: |_, start| start.starts_with(b"\x89PNG"),
    open: |path, options| Ok(Box::new(PngPicture::open(path, options)?)),
    outline: |_| None,
};

struct PngPicture {
    path: PathBuf,
    meaning: Meaning,
    header: Header,
    options: ReadOptions,
}

impl PngPicture {
    fn open(path: &Path, options: &ReadOptions) -> Result<PngPicture> {
        refuse_spectral(path, options)?;
        let reader = reader(path)?;
        let info = reader.info();
        let size = (info.width as usize, info.height as usize);
        let densest = DENSEST * 8 / info.bits_per_pixel() as u64;
        believable(path, size, 1, densest, options.max_pixels)?;
        let meaning = meaning(info, options).map_err(|problem| Error::file(path, problem))?;
        let header = meaning.header(size, options);
        Ok(PngPicture { path: path.to_owned(), meaning, header, options: options.clone() })
    }
}

fn reader(path: &Path) -> Result<Reader<BufReader<File>>> {
    let file = BufReader::new(File::open(path).map_err(Error::io(path, "read"))?);
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: LARGEST_CHUNK });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.read_info().map_err(damaged(path))
}

fn damaged(path: &Path) -> impl Fn(png::DecodingError) -> Error {
    let path = path.to_owned();
    move |error| Error::file(&path, format!("is damaged or cut short: {error}"))
}

/// What the chunks say. The problem, if there is one, is a message.
fn meaning(info: &Info, options: &ReadOptions) -> Result<Meaning, String> {
    let mut meaning = Meaning::srgb();
    if let Some(code) = info.coding_independent_code_points {
        if code.matrix_coefficients != 0 || !code.is_video_full_range_image {
            return Err(
                "has a cICP of limited range or with a matrix; RGB of full range is read".into()
            );
        }
        meaning.primaries = coded_primaries(code.color_primaries)?;
        meaning.transfer = coded_transfer(code.transfer_function, options.peak_cd_m2)?;
    } else if info.icc_profile.is_some() {
        meaning.notes.push("its ICC profile is passed over: decoded as sRGB".into());
    } else if info.srgb.is_none() {
        meaning.transfer =
            info.gama_chunk.map_or(Ok(Transfer::Srgb), |g| power(g.into_scaled()))?;
        meaning.primaries = info.chrm_chunk.map_or(Primaries::REC709, primaries);
    }
    meaning.transfer = options.transfer.unwrap_or(meaning.transfer);
    let exif = info.exif_metadata.as_deref().map_or(1, exif_orientation);
    meaning.turn = Turn::of_exif(exif);
    if matches!(info.color_type, ColorType::Rgba | ColorType::GrayscaleAlpha) || info.trns.is_some()
    {
        meaning.notes.push("passed over its alpha".into());
    }
    Ok(meaning)
}

/// The curve of gAMA, the exponent that codes were made with times 100 000.
fn power(gamma: u32) -> Result<Transfer, String> {
    match gamma {
        0 => Err("has a gAMA of 0".into()),
        100_000 => Ok(Transfer::Linear),
        GAMMA_OF_SRGB => Ok(Transfer::Srgb),
        gamma => Ok(Transfer::Power(1e5 / f64::from(gamma))),
    }
}

fn primaries(c: png::SourceChromaticities) -> Primaries {
    let point = |(x, y): (png::ScaledFloat, png::ScaledFloat)| {
        [x, y].map(|value| f64::from(value.into_scaled()) / 1e5)
    };
    Primaries {
        red: point(c.red),
        green: point(c.green),
        blue: point(c.blue),
        white: point(c.white),
    }
}

impl Footage for PngPicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, _: usize, _: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
        let damaged = damaged(&self.path);
        let mut reader = reader(&self.path)?;
        let size = (reader.info().width as usize, reader.info().height as usize);
        if self.meaning.turn.size(size.0, size.1) != (self.header.width, self.header.height) {
            return Err(Error::file(&self.path, "changed while it was read"));
        }
        let (colour, depth) = reader.output_color_type();
        let length = reader.output_buffer_size();
        let length = length.ok_or_else(|| Error::file(&self.path, "is too large to be read"))?;
        let mut bytes = vec![0; length];
        reader.next_frame(&mut bytes).map_err(&damaged)?;
        reader.finish().map_err(&damaged)?;
        let mut codes = Codes::of_bytes(size, colour.samples(), &[]);
        if depth == BitDepth::Sixteen {
            codes.top = u16::MAX;
            codes.samples =
                bytes.as_chunks().0.iter().map(|bytes| u16::from_be_bytes(*bytes)).collect();
        } else {
            codes.samples = bytes.into_iter().map(u16::from).collect();
        }
        self.meaning.light(&codes, &self.path, &self.options)
    }
}
