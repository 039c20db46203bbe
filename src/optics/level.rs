//! One level of the pyramid, and the veil that comes down to it.

use rayon::prelude::*;

use super::levels::LONGEST;
use super::rows::{Around, BAND, Blur, EXPANDING, Expand, Taps, guarded};
use super::shape::{MARGIN, Shape};
use super::whole::Polynomials;
use crate::kernel::{prefetch_run, vectorised};

/// Samples that are worth another thread.
pub(super) const WORTHWHILE: usize = 1 << 15;

/// One level: light going up, veil coming down.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub(super) shape: Shape,
    pub(super) gaussians: Vec<Taps>,
    /// Empty where it is the picture's own and nobody comes back to it.
    pub(super) light: Vec<f32>,
    pub(super) veil: Vec<f32>,
}

/// What becomes of a row of the picture: its number, its veil, all planes, and room for one plane.
pub(super) trait Finish: Fn(usize, &[f32], &mut [f32], &mut [f32]) + Sync {}

impl<F: Fn(usize, &[f32], &mut [f32], &mut [f32]) + Sync> Finish for F {}

/// Where the veil of a level comes from.
pub(super) struct Down<'a> {
    pub(super) shape: &'a Shape,
    pub(super) gaussians: &'a [Taps],
    pub(super) light: &'a [f32],
    pub(super) coarser: Option<&'a Level>,
    /// What every place gets from the whole picture: from the coarsest level.
    pub(super) whole: &'a Polynomials,
}

/// What a thread works in.
pub(super) struct Room {
    between: Vec<f32>,
    half: Vec<f32>,
    zeros: Vec<f32>,
}

impl Down<'_> {
    pub(super) fn room(&self) -> Room {
        let plane = self.shape.plane;
        Room {
            between: vec![0.0; self.gaussians.len() * BAND * guarded(plane)],
            half: vec![0.0; plane / 2 + EXPANDING],
            zeros: vec![0.0; plane],
        }
    }

    /// The veil of a band that begins at `row`, counted from the margin; whole rows.
    pub(super) fn band(&self, row: usize, room: &mut Room, out: &mut [f32]) {
        if self.gaussians.is_empty() {
            out.fill(0.0);
        }
        for plane in 0..self.shape.count {
            if !self.gaussians.is_empty() {
                self.blur(row, plane, room, out);
            }
            for (i, out) in out.chunks_exact_mut(self.shape.stride).enumerate() {
                self.expand(row + i, plane, room, out);
            }
        }
        if self.coarser.is_none() {
            self.whole.add(row, self.shape, out);
        }
    }

    /// The rows of the picture, each finished while its veil is near.
    pub(super) fn to_the_picture(&self, out: &mut [f32], finish: impl Finish) {
        let Shape { width, count, stride, .. } = *self.shape;
        let together = if self.gaussians.is_empty() { 1 } else { BAND };
        let samples = together * width * count;
        let bands = out.par_chunks_mut(samples);
        let bands = bands.with_min_len(WORTHWHILE.div_ceil(samples)).enumerate();
        bands.for_each_init(
            || (self.room(), vec![0.0; together * stride], vec![0.0; width]),
            |(room, veil, light), (i, out)| {
                let veil = &mut veil[..out.len() / (width * count) * stride];
                self.band(MARGIN + together * i, room, veil);
                for (j, out) in out.chunks_exact_mut(width * count).enumerate() {
                    finish(together * i + j, &veil[j * stride..][..stride], light, out);
                }
            },
        );
    }

    fn blur(&self, row: usize, plane: usize, room: &mut Room, out: &mut [f32]) {
        let Shape { plane: width, stride, .. } = *self.shape;
        let (from, rows, zeros) = (plane * width, self.shape.rows(), &room.zeros);
        let rows: Around = std::array::from_fn(|i| {
            let row = (row + i).checked_sub(LONGEST).filter(|row| *row < rows);
            row.map_or(&zeros[..], |row| &self.light[row * stride + from..][..width])
        });
        let (gaussians, between) = (self.gaussians, &mut room.between);
        vectorised(Blur { rows: &rows, gaussians, between, out, stride, from, width });
    }

    fn expand(&self, row: usize, plane: usize, room: &mut Room, out: &mut [f32]) {
        let Some(Level { shape, veil, .. }) = self.coarser else { return };
        // Row 2 i of this level lies on row i of the coarser one, both without their margins.
        let first = (row + MARGIN) / 2 - 1;
        let rows = [0, 1, 2, 3]
            .map(|i| &veil[(first + i) * shape.stride + plane * shape.plane..][..shape.plane]);
        let out = &mut out[plane * self.shape.plane..][..self.shape.plane];
        if row.is_multiple_of(2) {
            prefetch_run(rows[3], shape.stride);
        }
        vectorised(Expand { rows, odd: row % 2 == 1, room: &mut room.half, out });
    }
}
