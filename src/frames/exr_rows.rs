//! Decompressed rows of an OpenEXR part, and the samples of its channels in them.

use std::ops::Range;

use exr::meta::attribute::{ChannelList, SampleType};
use half::f16;

use crate::frames::census::widen;
use crate::light::Sample;

/// Where the samples of a channel lie in a row of a block, and what they are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Bytes of the channels before it, per pixel.
    before: usize,
    pub(crate) kind: SampleType,
}

impl Place {
    /// The place of a channel.
    pub(super) fn of(channels: &ChannelList, channel: usize) -> Place {
        let list = &channels.list;
        let before = list[..channel].iter().map(|c| c.sample_type.bytes_per_sample()).sum();
        Place { before, kind: list[channel].sample_type }
    }
}

/// Consecutive rows, decompressed: one block of scan lines, or one row of tiles.
pub(super) struct Rows {
    /// Columns of the data window, and their bytes: row by row, channel by channel.
    pub(crate) blocks: Vec<(Range<usize>, Vec<u8>)>,
    pub(crate) bytes_per_pixel: usize,
    /// Row of the data window that the blocks begin with.
    pub(crate) first: usize,
    /// Rows of the data window that lie in the window.
    pub(crate) seen: Range<usize>,
    /// Columns of the data window that lie in the window.
    pub(crate) columns: Range<usize>,
    /// Where the data window stands in the window.
    pub(crate) offset: (i64, i64),
}

impl Rows {
    /// Rows of the window, with each one's index among the items that `visit` was given.
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<'_> {
        self.seen.clone().enumerate().map(|(i, row)| (i, (row as i64 + self.offset.1) as usize))
    }

    /// Columns of the window that have data.
    pub(super) fn columns(&self) -> Range<usize> {
        let to_window = |column: usize| (column as i64 + self.offset.0) as usize;
        to_window(self.columns.start)..to_window(self.columns.end)
    }

    /// Converts the seen samples of a channel in the `i`th of [`Rows::rows`].
    pub(super) fn fetch<T: Stored>(&self, i: usize, place: Place, out: &mut [T]) {
        self.pieces(i, place, |columns, bytes| T::load(bytes, place.kind, &mut out[columns]));
    }

    /// Copies them as bytes.
    pub(super) fn copy(&self, i: usize, place: Place, out: &mut [u8]) {
        let size = place.kind.bytes_per_sample();
        self.pieces(i, place, |columns, bytes| {
            out[columns.start * size..columns.end * size].copy_from_slice(bytes);
        });
    }

    /// The seen samples of a channel in the `i`th of [`Rows::rows`], block by block: the columns
    /// among the seen ones, and their bytes.
    fn pieces(&self, i: usize, place: Place, mut visit: impl FnMut(Range<usize>, &[u8])) {
        let row = self.seen.start + i - self.first;
        for (columns, bytes) in &self.blocks {
            let seen = columns.start.max(self.columns.start)..columns.end.min(self.columns.end);
            if seen.is_empty() {
                continue;
            }
            let size = place.kind.bytes_per_sample();
            let start = (row * self.bytes_per_pixel + place.before) * columns.len()
                + (seen.start - columns.start) * size;
            let bytes = &bytes[start..][..seen.len() * size];
            visit(seen.start - self.columns.start..seen.end - self.columns.start, bytes);
        }
    }
}

/// A sample that the bytes of a file are read into.
pub(super) trait Stored: Sample {
    fn load(bytes: &[u8], kind: SampleType, out: &mut [Self]);
}

impl Stored for f16 {
    fn load(bytes: &[u8], _: SampleType, out: &mut [f16]) {
        for (out, bytes) in out.iter_mut().zip(bytes.as_chunks().0) {
            *out = f16::from_ne_bytes(*bytes);
        }
    }
}

impl Stored for f32 {
    fn load(bytes: &[u8], kind: SampleType, out: &mut [f32]) {
        match kind {
            SampleType::F16 => {
                let mut halves = [f16::ZERO; 512];
                for (out, bytes) in out.chunks_mut(512).zip(bytes.chunks(1024)) {
                    let halves = &mut halves[..out.len()];
                    f16::load(bytes, kind, halves);
                    widen(halves, out);
                }
            }
            SampleType::F32 => {
                for (out, bytes) in out.iter_mut().zip(bytes.as_chunks().0) {
                    *out = f32::from_ne_bytes(*bytes);
                }
            }
            SampleType::U32 => {
                for (out, bytes) in out.iter_mut().zip(bytes.as_chunks().0) {
                    *out = u32::from_ne_bytes(*bytes) as f32;
                }
            }
        }
    }
}
