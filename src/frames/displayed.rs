//! Pictures made for a display, PNG and JPEG: integer codes, decoded to linear light by a transfer
//! curve.
//!
//! Such a picture has lost its sun: whatever was brighter than white is white. A note says so, and
//! samples at the top of their range are counted.

use std::path::Path;

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::options::{ReadOptions, Wanted};
use crate::frames::picture::{Header, Kind, examined};
use crate::frames::transfer::Transfer;
use crate::frames::turn::Turn;
use crate::light::Frame;
use crate::units::Nits;

/// The codes of a picture, row by row and pixel by pixel.
pub(super) struct Codes {
    width: usize,
    height: usize,
    /// 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha.
    channels: usize,
    /// The greatest code.
    pub(crate) top: u16,
    pub(crate) samples: Vec<u16>,
}

/// What a file says its codes mean.
#[derive(Clone, Debug)]
pub(super) struct Meaning {
    pub(crate) primaries: Primaries,
    pub(crate) transfer: Transfer,
    pub(crate) turn: Turn,
    pub(crate) notes: Vec<String>,
}

/// Refuses what cannot be asked of such a picture.
pub(super) fn refuse_spectral(path: &Path, options: &ReadOptions) -> Result<()> {
    match options.wanted {
        Wanted::Spectral => {
            Err(Error::file(path, "is an RGB picture; `kind` asks for spectral light"))
        }
        _ => Ok(()),
    }
}

impl Meaning {
    /// Codes of sRGB, the right way up.
    pub(super) fn srgb() -> Meaning {
        let (primaries, transfer) = (Primaries::REC709, Transfer::Srgb);
        Meaning { primaries, transfer, turn: Turn::default(), notes: Vec::new() }
    }

    /// The header of a picture that is stored in this width and height.
    pub(super) fn header(&self, (width, height): (usize, usize), options: &ReadOptions) -> Header {
        let (width, height) = self.turn.size(width, height);
        let mut notes = Vec::new();
        if self.transfer == Transfer::Pq {
            notes.push("decoded by the PQ curve (ST 2084), in cd/m2".into());
        } else {
            notes.push(format!(
                "display-referred (decoded by {}): light brighter than white was cut off, so a \
                 sun in it is far too dim",
                self.transfer
            ));
        }
        notes.extend(self.notes.iter().cloned());
        let white = self.transfer.white().or(options.peak_cd_m2.map(Nits));
        let transfer = Some(self.transfer);
        let kind = Kind::Rgb(options.primaries.unwrap_or(self.primaries));
        Header { white, transfer, notes, ..Header::new(width, height, kind) }
    }

    /// The light of the codes.
    pub(super) fn light(&self, codes: &Codes, path: &Path, options: &ReadOptions) -> Result<Frame> {
        let top = f64::from(codes.top);
        let curve: Vec<f32> =
            (0..=codes.top).map(|code| self.transfer.light(f64::from(code) / top) as f32).collect();
        let (width, height) = self.turn.size(codes.width, codes.height);
        let mut planes = vec![0.0; width * height * 3];
        let mut clipped = 0;
        for (y, out) in planes.chunks_exact_mut(width * 3).enumerate() {
            for x in 0..width {
                let (column, row) = self.turn.source((x, y), (codes.width, codes.height));
                let rgb = codes.rgb(column, row);
                clipped += rgb.iter().filter(|code| **code == codes.top).count() as u64;
                let light = self.transfer.shown(rgb.map(|code| curve[usize::from(code)]));
                (0..3).for_each(|plane| out[plane * width + x] = light[plane]);
            }
        }
        let mut frame = examined(path, planes, (width, height), options)?;
        frame.tally.clipped = clipped;
        Ok(frame)
    }
}

impl Codes {
    /// Eight-bit codes.
    pub(super) fn of_bytes(size: (usize, usize), channels: usize, bytes: &[u8]) -> Codes {
        let samples = bytes.iter().map(|byte| u16::from(*byte)).collect();
        Codes { width: size.0, height: size.1, channels, top: 255, samples }
    }

    fn rgb(&self, x: usize, y: usize) -> [u16; 3] {
        let pixel = &self.samples[(y * self.width + x) * self.channels..][..self.channels];
        if self.channels < 3 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] }
    }
}
