//! The pyramid: K s, the light that the places of a picture send each other.
//!
//! ```text
//! up      light_0 = s, light_(l+1) = reduce light_l
//! down    veil_l = sum over Gaussians of level l: w_j blur_j light_l + expand veil_(l+1)             K s = veil_0
//! ```
//!
//! Expanding is the transpose of reducing, so K is symmetric: no light is lost or made. All planes
//! of a level are done in one pass, rows by any number of threads. Beyond the picture is nothing,
//! and the margins of the levels hold all that filters spread there: the kernel is the same up to
//! the border.

use rayon::prelude::*;

use super::gaussians::Gaussians;
use super::level::{Down, Finish, Level, WORTHWHILE};
use super::levels::{Depth, Placed};
use super::rows::{BAND, Exchange, Reduce, Taps, reducing};
use super::shape::{MARGIN, Shape};
use super::whole::Whole;
use crate::kernel::{prefetch_run, vectorised};
use crate::light::{Planes, Row, Samples};

/// Rows of a coarser level that a thread makes of rows that are widened as they come.
const RUN: usize = 16;

/// How many rows of the picture are asked for ahead.
const NEXT: usize = 2;

/// Levels for pictures of one size, and what is left for the whole picture.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
    whole: Whole,
}

impl Pyramid {
    /// The pyramid of a sum of Gaussians, for `count` planes.
    pub(super) fn new(
        sum: &Gaussians,
        depth: &Depth,
        [width, height]: [usize; 2],
        count: usize,
    ) -> Pyramid {
        let placed = depth.place(sum);
        let top = placed.iter().map(|gaussian| gaussian.level).max().unwrap_or(0);
        let mut shape = Shape::new(width, height, count);
        let mut levels = Vec::new();
        for level in 0..=top {
            let gaussians: Vec<_> = placed.iter().filter(|g| g.level == level).map(taps).collect();
            let passes = level == 0 && gaussians.is_empty() && width * height > WORTHWHILE;
            let light = vec![0.0; if passes { 0 } else { shape.samples() }];
            let veil = vec![0.0; if level == 0 { 0 } else { shape.samples() }];
            levels.push(Level { shape, gaussians, light, veil });
            shape = shape.halved();
        }
        Pyramid { levels, whole: Whole::new(sum, top) }
    }

    /// How many planes it is made for.
    pub(super) fn count(&self) -> usize {
        self.levels[0].shape.count
    }

    /// Levels, the picture's own included.
    pub(super) fn height(&self) -> usize {
        self.levels.len()
    }

    /// The veil of a picture that is the same everywhere, of one plane: K 1.
    pub(super) fn of_ones(&mut self) -> Vec<f32> {
        let Shape { width, height, .. } = self.levels[0].shape;
        let mut veil = vec![0.0; width * height];
        self.veil(&ones(width, height), &mut veil);
        veil
    }

    /// The veil of a picture: K s.
    pub(super) fn veil(&mut self, s: &Planes, out: &mut [f32]) {
        let Shape { width, plane, .. } = self.levels[0].shape;
        self.climb(s);
        self.descend(out, |_, veil, _, out| {
            for (out, veil) in out.chunks_exact_mut(width).zip(veil.chunks_exact(plane)) {
                out.copy_from_slice(&veil[MARGIN..][..width]);
            }
        });
    }

    /// The light of a level after the climb. That of a large picture itself is not kept.
    pub(super) fn light(&self, level: usize) -> (&Shape, &[f32]) {
        (&self.levels[level].shape, &self.levels[level].light)
    }

    /// The light on the retina: `kept` and `beyond` as [`Exchange`] has them, `beyond` for each
    /// plane. `met` is shown each row, all planes, while it is near.
    pub(super) fn exchange(
        &mut self,
        s: &Planes,
        kept: &[f32],
        beyond: &[Option<(f32, f32)>],
        out: &mut [f32],
        met: impl Fn(usize, &[f32]) + Sync,
    ) {
        let Shape { width, plane, .. } = self.levels[0].shape;
        self.climb(s);
        self.descend(out, |y, veil, room, row| {
            let kept = &kept[y * width..][..width];
            for ((i, out), &beyond) in row.chunks_exact_mut(width).enumerate().zip(beyond) {
                let (light, veil) = (s.run(i, y, 0..width, room), &veil[i * plane + MARGIN..]);
                let veil = &veil[..width];
                vectorised(Exchange { light, veil, kept, beyond, out });
            }
            met(y, row);
        });
    }

    /// Up: the picture's light on every level.
    pub(super) fn climb(&mut self, s: &Planes) {
        let Level { shape, light, .. } = &mut self.levels[0];
        let Shape { width, height, count, plane, stride } = *shape;
        debug_assert_eq!([s.width, s.height, s.count], [width, height, count]);
        let rows = light.par_chunks_exact_mut(stride).skip(MARGIN).take(height);
        rows.with_min_len(WORTHWHILE.div_ceil(stride)).enumerate().for_each(|(y, row)| {
            for (i, out) in row.chunks_exact_mut(plane).enumerate() {
                widen(s, i, y, out);
            }
        });
        for level in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            match &finer[level - 1] {
                picture if picture.light.is_empty() => reduce_picture(s, picture, &mut coarser[0]),
                finer => reduce(finer, &mut coarser[0]),
            }
        }
    }

    /// Down: the veil of every level, to the rows of the picture.
    fn descend(&mut self, out: &mut [f32], finish: impl Finish) {
        let top = &self.levels[self.levels.len() - 1];
        let whole = self.whole.over(&top.light, &top.shape);
        for level in (1..self.levels.len()).rev() {
            let (finer, coarser) = self.levels.split_at_mut(level + 1);
            let (last, Level { shape, gaussians, light, veil }) =
                (coarser.first(), &mut finer[level]);
            let down = Down { shape, gaussians, light, coarser: last, whole: &whole };
            let bands = veil.par_chunks_mut(BAND * shape.stride);
            let bands = bands.with_min_len(WORTHWHILE.div_ceil(BAND * shape.stride)).enumerate();
            bands.for_each_init(
                || down.room(),
                |room, (i, band)| {
                    down.band(BAND * i, room, band);
                },
            );
        }
        let coarser = self.levels.get(1);
        let Level { shape, gaussians, light, .. } = &self.levels[0];
        Down { shape, gaussians, light, coarser, whole: &whole }.to_the_picture(out, finish);
    }
}

/// A picture of one plane that is 1 everywhere.
pub(super) fn ones(width: usize, height: usize) -> Planes {
    let samples = Samples::Float(vec![1.0; width * height]);
    Planes { width, height, count: 1, samples }
}

/// A Gaussian as the loops take it.
fn taps(gaussian: &Placed) -> Taps {
    Taps {
        down: gaussian.taps.iter().map(|tap| *tap as f32).collect(),
        along: gaussian.taps.iter().map(|tap| (gaussian.weight * tap) as f32).collect(),
    }
}

/// A row of a plane of a picture, within its margins.
fn widen(s: &Planes, plane: usize, y: usize, out: &mut [f32]) {
    let (run, out) = (plane * s.width..(plane + 1) * s.width, &mut out[MARGIN..][..s.width]);
    match s.row(y) {
        Row::Float(samples) => {
            prefetch_run(&samples[run.clone()], NEXT * samples.len());
            out.copy_from_slice(&samples[run]);
        }
        Row::Half(samples) => {
            prefetch_run(&samples[run.clone()], NEXT * samples.len());
            crate::light::widen(&samples[run], out);
        }
    }
}

/// The light of the first coarser level, where the picture's own is not kept.
fn reduce_picture(s: &Planes, picture: &Level, coarser: &mut Level) {
    let (fine, coarse) = (&picture.shape, coarser.shape);
    let zeros = vec![0.0; fine.plane];
    let runs = coarser.light.par_chunks_mut(RUN * coarse.stride).enumerate();
    runs.for_each_init(
        || (vec![0.0; 8 * fine.plane], vec![0.0; reducing(fine.plane, coarse.plane)]),
        |(last, room), (run, out)| {
            for plane in 0..coarse.count {
                for (j, out) in out.chunks_exact_mut(coarse.stride).enumerate() {
                    // Row y of the coarser level lies on row 2 y of the picture, both without margins.
                    let above = |k: usize| {
                        let row = (2 * (run * RUN + j) + k).checked_sub(2 * MARGIN + 3);
                        row.filter(|row| *row < fine.height)
                    };
                    let new = if j == 0 { 0 } else { 5 };
                    for row in (new..7).filter_map(above) {
                        widen(s, plane, row, &mut last[row % 8 * fine.plane..][..fine.plane]);
                    }
                    let rows = [0, 1, 2, 3, 4, 5, 6].map(|k| {
                        above(k)
                            .map_or(&zeros[..], |row| &last[row % 8 * fine.plane..][..fine.plane])
                    });
                    let out = &mut out[plane * coarse.plane..][..coarse.plane];
                    vectorised(Reduce { rows, room, out });
                }
            }
        },
    );
}

/// The light of a coarser level.
fn reduce(finer: &Level, coarser: &mut Level) {
    let (fine, coarse) = (&finer.shape, coarser.shape);
    let zeros = vec![0.0; fine.plane];
    let rows = coarser.light.par_chunks_exact_mut(coarse.stride);
    let rows = rows.with_min_len(WORTHWHILE.div_ceil(4 * coarse.stride)).enumerate();
    rows.for_each_init(
        || vec![0.0; reducing(fine.plane, coarse.plane)],
        |room, (y, out)| {
            for (i, out) in
                out[..coarse.count * coarse.plane].chunks_exact_mut(coarse.plane).enumerate()
            {
                // Row y of the coarser level lies on row 2 y of the finer one, both without their margins.
                let rows = [0, 1, 2, 3, 4, 5, 6].map(|k: usize| {
                    let row = (2 * y + k).checked_sub(MARGIN + 3).filter(|row| *row < fine.rows());
                    row.map_or(&zeros[..], |row| {
                        &finer.light[row * fine.stride + i * fine.plane..][..fine.plane]
                    })
                });
                vectorised(Reduce { rows, room, out });
            }
        },
    );
}
