//! PNG and JPEG: pictures made for a display, decoded to linear light by the sRGB curve (IEC
//! 61966-2-1).
//!
//! Such a picture has lost its sun: whatever was brighter than white is white. The note says so,
//! and samples at the top of their range are counted.

use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageReader, Limits};

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::footage::{DENSEST, Picture, believable, examined};
use crate::frames::{Header, Kind, ReadOptions, Wanted};
use crate::light::{Frame, Planes};
use crate::vision::Projection;

const WARNING: &str = "display-referred (decoded by the sRGB curve): light brighter than white was cut off, so a sun in it is far too dim";

pub(super) struct DisplayedPicture {
    path: PathBuf,
    header: Header,
    options: ReadOptions,
}

impl DisplayedPicture {
    pub fn open(path: &Path, options: &ReadOptions) -> Result<DisplayedPicture> {
        if options.wanted == Wanted::Spectral {
            return Err(Error::file(path, "is an RGB picture; `kind` asks for spectral light"));
        }
        let decoder = decoder(path)?;
        let (width, height) = (decoder.dimensions().0 as usize, decoder.dimensions().1 as usize);
        believable(path, (width, height), 3, DENSEST, options.max_pixels)?;
        let mut notes = vec![WARNING.to_owned()];
        if decoder.color_type().has_alpha() {
            notes.push("passed over its alpha".into());
        }
        let kind = Kind::Rgb(Primaries::REC709);
        let header = Header { width, height, kind, white: None, frames_per_second: None, notes };
        Ok(DisplayedPicture { path: path.to_owned(), header, options: options.clone() })
    }
}

fn decoder(path: &Path) -> Result<impl ImageDecoder> {
    let mut reader = ImageReader::open(path).map_err(Error::io(path, "read"))?;
    reader = reader.with_guessed_format().map_err(Error::io(path, "read"))?;
    reader.limits(Limits::no_limits());
    reader.into_decoder().map_err(|error| unreadable(path, error))
}

fn unreadable(path: &Path, error: image::ImageError) -> Error {
    Error::file(path, format!("is damaged or cut short: {error}"))
}

/// Linear light of a display's signal in 0..=1.
fn linear(signal: f64) -> f32 {
    let light =
        if signal <= 0.04045 { signal / 12.92 } else { ((signal + 0.055) / 1.055).powf(2.4) };
    light as f32
}

impl Picture for DisplayedPicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn decode(&self, _: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
        let (width, height) = (self.header.width, self.header.height);
        let decoder = decoder(&self.path)?;
        if decoder.dimensions() != (width as u32, height as u32) {
            return Err(Error::file(&self.path, "changed while it was read"));
        }
        let color = decoder.color_type();
        let deep = color.bytes_per_pixel() > color.channel_count();
        let top = if deep { u16::MAX } else { u8::MAX.into() };
        let image =
            DynamicImage::from_decoder(decoder).map_err(|error| unreadable(&self.path, error))?;
        let samples: Vec<u16> = if deep {
            image.into_rgb16().into_raw()
        } else {
            image.into_rgb8().into_raw().into_iter().map(u16::from).collect()
        };
        let curve: Vec<f32> =
            (0..=top).map(|code| linear(f64::from(code) / f64::from(top))).collect();
        let mut planes = vec![0.0; samples.len()];
        for (row, out) in samples.chunks_exact(width * 3).zip(planes.chunks_exact_mut(width * 3)) {
            for (i, code) in row.iter().enumerate() {
                out[i % 3 * width + i / 3] = curve[usize::from(*code)];
            }
        }
        let mut frame = examined(&self.path, planes, (width, height), &self.options)?;
        frame.tally.clipped = samples.iter().filter(|code| **code == top).count() as u64;
        Ok(frame)
    }
}
