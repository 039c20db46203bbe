//! Radiance pictures (`.hdr`, `.pic`): shared-exponent RGB or XYZ.
//!
//! Ward (1991), "Real Pixels", Graphics Gems II; the Radiance reference manual. Stored numbers are
//! divided by the product of all EXPOSURE lines and by the product of all COLORCORR lines; then 179
//! times 1.0 is cd/m2. The `image` crate decodes the runs; it neither divides nor knows PRIMARIES
//! and XYZE.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::footage::{DENSEST, Picture, believable, examined};
use crate::frames::{Header, Kind, ReadOptions, Wanted};
use crate::light::{Frame, Planes};
use crate::vision::Projection;

/// Header lines beyond this are no header.
const LONGEST_HEADER: u64 = 1 << 20;

/// XYZ to linear RGB of Rec. 709, D65 (IEC 61966-2-1, inverse of the RGB to XYZ matrix).
const XYZ_TO_REC709: [[f32; 3]; 3] = [
    [3.240_97, -1.537_383_2, -0.498_610_8],
    [-0.969_243_6, 1.875_967_5, 0.041_555_1],
    [0.055_630_1, -0.203_977, 1.056_971_5],
];

/// What the lines before the pixels say.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lines {
    width: usize,
    height: usize,
    from_right: bool,
    from_bottom: bool,
    /// What each of R, G, B is divided by.
    gain: [f32; 3],
    primaries: Option<Primaries>,
    is_xyz: bool,
}

pub(super) struct RadiancePicture {
    path: PathBuf,
    lines: Lines,
    header: Header,
    options: ReadOptions,
}

impl RadiancePicture {
    pub fn open(path: &Path, options: &ReadOptions) -> Result<RadiancePicture> {
        if options.wanted == Wanted::Spectral {
            return Err(Error::file(
                path,
                "is a Radiance picture, RGB; `kind` asks for spectral light",
            ));
        }
        let (lines, _) = opened(path)?;
        believable(path, (lines.width, lines.height), 12, DENSEST, options.max_pixels)?;
        let mut notes = Vec::new();
        if lines.is_xyz {
            notes.push("XYZ, read as linear RGB of Rec. 709".into());
        } else if lines.primaries.is_none() {
            notes.push("no PRIMARIES line: taken as Rec. 709".into());
        }
        let kind =
            Kind::Rgb(lines.primaries.filter(|_| !lines.is_xyz).unwrap_or(Primaries::REC709));
        let (width, height) = (lines.width, lines.height);
        let header = Header { width, height, kind, white: None, frames_per_second: None, notes };
        Ok(RadiancePicture { path: path.to_owned(), lines, header, options: options.clone() })
    }
}

/// Opens the file and reads up to the first pixel.
fn opened(path: &Path) -> Result<(Lines, BufReader<File>)> {
    let mut reader = BufReader::new(File::open(path).map_err(Error::io(path, "read"))?);
    let lines = read_lines(&mut reader).map_err(|problem| Error::file(path, problem))?;
    Ok((lines, reader))
}

/// Reads the header's lines. The problem, if there is one, is a message.
pub(super) fn read_lines(reader: &mut impl BufRead) -> Result<Lines, String> {
    let mut limited = reader.take(LONGEST_HEADER);
    let mut line = || -> Result<String, String> {
        let mut bytes = Vec::new();
        limited
            .read_until(b'\n', &mut bytes)
            .map_err(|error| format!("cannot be read: {error}"))?;
        if bytes.pop() != Some(b'\n') {
            return Err("is cut short inside its header".into());
        }
        Ok(String::from_utf8_lossy(&bytes).trim().to_owned())
    };
    if !line()?.starts_with("#?") {
        return Err("is not a Radiance picture: it does not begin with #?".into());
    }
    let mut gain = [1.0f32; 3];
    let (mut primaries, mut is_xyz) = (None, false);
    loop {
        let text = line()?;
        if text.is_empty() {
            break;
        }
        let Some((key, value)) = text.split_once('=') else { continue };
        match key.trim() {
            "EXPOSURE" => multiply(&mut gain, &numbers::<1>(value)?.repeat(3)),
            "COLORCORR" => multiply(&mut gain, &numbers::<3>(value)?),
            "PRIMARIES" => {
                let [a, b, c, d, e, f, g, h] = numbers::<8>(value)?;
                primaries =
                    Some(Primaries { red: [a, b], green: [c, d], blue: [e, f], white: [g, h] });
            }
            "FORMAT" => is_xyz = format_is_xyz(value.trim())?,
            _ => {}
        }
    }
    if gain.iter().any(|gain| !gain.is_normal() || *gain < 0.0) {
        return Err(format!("has an EXPOSURE or COLORCORR that cannot be divided by: {gain:?}"));
    }
    let (height, from_bottom, width, from_right) = resolution(&line()?)?;
    Ok(Lines { width, height, from_right, from_bottom, gain, primaries, is_xyz })
}

fn multiply(gain: &mut [f32; 3], by: &[f64]) {
    gain.iter_mut().zip(by).for_each(|(gain, by)| *gain *= *by as f32);
}

fn format_is_xyz(format: &str) -> Result<bool, String> {
    match format {
        "32-bit_rle_rgbe" => Ok(false),
        "32-bit_rle_xyze" => Ok(true),
        other => {
            Err(format!("is in the format `{other}`; 32-bit_rle_rgbe and 32-bit_rle_xyze are read"))
        }
    }
}

fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split_whitespace().map_while(|word| word.parse().ok()).collect();
    <[f64; N]>::try_from(numbers)
        .map_err(|_| format!("has `{}` in its header where {N} numbers belong", text.trim()))
}

/// Height, whether from the bottom, width, whether from the right, of `-Y 480 +X 640`.
fn resolution(text: &str) -> Result<(usize, bool, usize, bool), String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let size =
        |text: &str| text.parse::<u32>().ok().filter(|size| *size > 0).map(|size| size as usize);
    let read = match words[..] {
        [y @ ("-Y" | "+Y"), height, x @ ("+X" | "-X"), width] => size(height)
            .zip(size(width))
            .map(|(height, width)| (height, y == "+Y", width, x == "-X")),
        _ => None,
    };
    read.ok_or_else(|| {
        format!("has the resolution line `{text}`; rows from top or bottom are read, as in -Y 480 +X 640")
    })
}

impl Picture for RadiancePicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn decode(&self, _: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
        let (lines, reader) = opened(&self.path)?;
        let (width, height) = (self.lines.width, self.lines.height);
        if lines != self.lines {
            return Err(Error::file(&self.path, "changed while it was read"));
        }
        let plain = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
        let damaged = |error| Error::file(&self.path, format!("is damaged or cut short: {error}"));
        let decoder = HdrDecoder::new(Cursor::new(plain).chain(reader)).map_err(damaged)?;
        let mut bytes = vec![0; width * height * 12];
        decoder.read_image(&mut bytes).map_err(damaged)?;
        let mut planes = vec![0.0; width * height * 3];
        for (row, bytes) in bytes.chunks_exact(width * 12).enumerate() {
            let y = if lines.from_bottom { height - 1 - row } else { row };
            let out = &mut planes[y * width * 3..][..width * 3];
            for (column, pixel) in bytes.as_chunks::<4>().0.as_chunks::<3>().0.iter().enumerate() {
                let x = if lines.from_right { width - 1 - column } else { column };
                let rgb = lines.light(pixel.map(f32::from_ne_bytes));
                (0..3).for_each(|plane| out[plane * width + x] = rgb[plane]);
            }
        }
        examined(&self.path, planes, (width, height), &self.options)
    }
}

impl Lines {
    /// Stored numbers to light.
    fn light(&self, stored: [f32; 3]) -> [f32; 3] {
        let light = [0, 1, 2].map(|i| stored[i] / self.gain[i]);
        if !self.is_xyz {
            return light;
        }
        XYZ_TO_REC709.map(|row| row[0] * light[0] + row[1] * light[1] + row[2] * light[2])
    }
}
