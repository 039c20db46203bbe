//! The light of one frame, as rows of planes.
//!
//! A frame is `count` planes of `width` x `height` samples, stored row by row and, inside a row,
//! plane by plane: the order of a scanline OpenEXR file, and one in which a row is the unit of work
//! everywhere.
//!
//! * RGB light keeps the file's own numbers: three planes, half or float.
//! * Spectral light is never held whole. Each block of rows is projected as it is decoded by a
//!   projection onto the few inner products that the retina and the percept need; those are the
//!   planes.

mod halves;
mod survey;
mod tile;
mod window;

use std::ops::Range;

use half::f16;
use ndarray::{ArrayView3, Axis};
use serde::{Deserialize, Serialize};

pub(crate) use halves::narrow;
pub use halves::widen;
pub(crate) use survey::{Cells, Survey, SurveyRow};
pub(crate) use tile::PlaneTile;
pub use window::Window;

/// Samples of all planes, in the width of the file they came from.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    Half(Vec<f16>),
    Float(Vec<f32>),
}

/// Planes of one frame. Row `y` of plane `i` is `samples[(y * count + i) * width..][..width]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    pub width: usize,
    pub height: usize,
    pub count: usize,
    pub samples: Samples,
}

/// One row of all planes: `count` runs of `width` samples.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Row<'a> {
    Half(&'a [f16]),
    Float(&'a [f32]),
}

impl Planes {
    /// Float planes of zeros.
    pub fn float(width: usize, height: usize, count: usize) -> Self {
        Planes { width, height, count, samples: Samples::Float(vec![0.0; width * height * count]) }
    }

    /// The samples as floats of this size, old or new, to be written over.
    pub(crate) fn floats(&mut self, width: usize, height: usize, count: usize) -> &mut [f32] {
        let fits =
            matches!(&self.samples, Samples::Float(old) if old.len() == width * height * count);
        if !fits {
            *self = Planes::float(width, height, count);
        }
        (self.width, self.height, self.count) = (width, height, count);
        match &mut self.samples {
            Samples::Float(samples) => samples,
            Samples::Half(_) => &mut [],
        }
    }

    /// Half planes of zeros.
    pub fn half(width: usize, height: usize, count: usize) -> Self {
        Planes {
            width,
            height,
            count,
            samples: Samples::Half(vec![f16::ZERO; width * height * count]),
        }
    }

    /// The planes of a frame in memory, shape (height, width, planes), in any strides. `old`: planes
    /// to be written over.
    pub fn of_frame<T: Sample>(frame: ArrayView3<'_, T>, old: Option<Planes>) -> Self {
        let (height, width, count) = frame.dim();
        let old = old.and_then(|old| T::taken(old.samples));
        let mut samples = old.unwrap_or_default();
        samples.clear();
        samples.reserve(width * height * count);
        for row in frame.outer_iter() {
            for plane in row.axis_iter(Axis(1)) {
                samples.extend(plane.iter().copied());
            }
        }
        Planes { width, height, count, samples: T::samples(samples) }
    }

    /// Column, row and plane of the first sample that is NaN or infinite.
    pub(crate) fn first_not_finite(&self) -> Option<[usize; 3]> {
        let at = match &self.samples {
            Samples::Half(samples) => samples.iter().position(|v| !v.is_finite()),
            Samples::Float(samples) => samples.iter().position(|v| !v.is_finite()),
        }?;
        let in_row = at % (self.width * self.count);
        Some([in_row % self.width, at / (self.width * self.count), in_row / self.width])
    }

    /// Row `y`, all planes.
    pub(crate) fn row(&self, y: usize) -> Row<'_> {
        let n = self.count * self.width;
        match &self.samples {
            Samples::Half(v) => Row::Half(&v[y * n..][..n]),
            Samples::Float(v) => Row::Float(&v[y * n..][..n]),
        }
    }

    /// A run of plane `i` in row `y` as single floats, converted into `room` where it is stored as
    /// half.
    pub(crate) fn run<'a>(
        &'a self,
        i: usize,
        y: usize,
        run: Range<usize>,
        room: &'a mut [f32],
    ) -> &'a [f32] {
        let plane = i * self.width;
        let run = plane + run.start..plane + run.end;
        match self.row(y) {
            Row::Float(row) => &row[run],
            Row::Half(row) => {
                let room = &mut room[..run.len()];
                widen(&row[run], room);
                room
            }
        }
    }

    /// Every sample times a number, as single floats.
    pub(crate) fn scaled(self, factor: f32) -> Planes {
        let mut floats = match self.samples {
            Samples::Float(floats) => floats,
            Samples::Half(halves) => {
                let mut floats = vec![0.0; halves.len()];
                widen(&halves, &mut floats);
                floats
            }
        };
        floats.iter_mut().for_each(|value| *value *= factor);
        Planes { samples: Samples::Float(floats), ..self }
    }

    /// The sample of plane `i` at column `x` of row `y`.
    pub fn at(&self, x: usize, y: usize, i: usize) -> f64 {
        let at = (y * self.count + i) * self.width + x;
        match &self.samples {
            Samples::Half(v) => v[at].to_f64(),
            Samples::Float(v) => f64::from(v[at]),
        }
    }
}

impl Row<'_> {
    /// The row as single floats, converted into `scratch` where it is stored as half.
    pub(crate) fn as_f32<'a>(&'a self, scratch: &'a mut [f32]) -> &'a [f32] {
        match self {
            Row::Float(row) => row,
            Row::Half(row) => {
                let scratch = &mut scratch[..row.len()];
                widen(row, scratch);
                scratch
            }
        }
    }
}

/// A sample of a picture: a float or a half.
pub trait Sample: Copy + Default + Send + Sync {
    /// Samples of this type.
    fn samples(of: Vec<Self>) -> Samples;

    /// The memory of samples of this type.
    fn taken(from: Samples) -> Option<Vec<Self>>;

    /// Whether it is neither NaN nor infinite.
    fn is_finite(self) -> bool;

    /// Whether it is below zero, minus zero apart; a NaN may seem so.
    fn is_negative(self) -> bool;

    fn value(self) -> f32;

    fn from_value(value: f32) -> Self;

    /// Stores a row of floats, limited to what the type can hold; returns how many were limited.
    fn store(from: &[f32], to: &mut [Self]) -> u64;
}

impl Sample for f32 {
    fn samples(of: Vec<f32>) -> Samples {
        Samples::Float(of)
    }

    fn taken(from: Samples) -> Option<Vec<f32>> {
        match from {
            Samples::Float(samples) => Some(samples),
            _ => None,
        }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    #[inline(always)]
    fn is_negative(self) -> bool {
        self < 0.0
    }

    #[inline(always)]
    fn value(self) -> f32 {
        self
    }

    fn from_value(value: f32) -> f32 {
        value
    }

    fn store(from: &[f32], to: &mut [f32]) -> u64 {
        to.copy_from_slice(from);
        0
    }
}

impl Sample for f16 {
    fn samples(of: Vec<f16>) -> Samples {
        Samples::Half(of)
    }

    fn taken(from: Samples) -> Option<Vec<f16>> {
        match from {
            Samples::Half(samples) => Some(samples),
            _ => None,
        }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f16::is_finite(self)
    }

    #[inline(always)]
    fn is_negative(self) -> bool {
        self.to_bits() > 0x8000
    }

    #[inline(always)]
    fn value(self) -> f32 {
        self.to_f32()
    }

    fn from_value(value: f32) -> f16 {
        f16::from_f32(value)
    }

    fn store(from: &[f32], to: &mut [f16]) -> u64 {
        if !narrow(from, to) {
            return 0;
        }
        let mut limited = 0;
        for (half, &value) in to.iter_mut().zip(from) {
            if half.is_infinite() {
                *half = if value > 0.0 { f16::MAX } else { f16::MIN };
                limited += 1;
            }
        }
        limited
    }
}

/// What a frame's samples had wrong with them, counted before any policy mended it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    pub nan: u64,
    pub infinite: u64,
    pub negative: u64,
    /// Integer samples at the top of their range: a display-referred picture whose light was cut
    /// off.
    pub clipped: u64,
}

impl Tally {
    /// The sum of two counts.
    pub(crate) fn plus(self, other: Tally) -> Tally {
        Tally {
            nan: self.nan + other.nan,
            infinite: self.infinite + other.infinite,
            negative: self.negative + other.negative,
            clipped: self.clipped + other.clipped,
        }
    }

    /// NaN and infinite samples.
    pub(crate) fn non_finite(self) -> u64 {
        self.nan + self.infinite
    }
}

/// The planes of one frame and what was wrong with its samples.
#[derive(Clone, Debug)]
pub struct Frame {
    pub planes: Planes,
    pub tally: Tally,
}
