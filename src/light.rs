//! The light of one frame, as rows of planes.
//!
//! A frame is `count` planes of `width` x `height` samples, stored row by row and, inside a row, plane by
//! plane: the order of a scanline OpenEXR file, and one in which a row is the unit of work everywhere.
//!
//! * RGB light keeps the file's own numbers: three planes, half or float.
//! * Spectral light is never held whole. Each block of rows is projected as it is decoded by a [`Projection`]
//!   onto the few inner products that the retina and the percept need; those are the planes.

use half::f16;

use crate::kernel;

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
pub enum Row<'a> {
    Half(&'a [f16]),
    Float(&'a [f32]),
}

impl Planes {
    /// Float planes of zeros.
    pub fn float(width: usize, height: usize, count: usize) -> Self {
        Planes { width, height, count, samples: Samples::Float(vec![0.0; width * height * count]) }
    }

    /// Half planes of zeros.
    pub fn half(width: usize, height: usize, count: usize) -> Self {
        Planes { width, height, count, samples: Samples::Half(vec![f16::ZERO; width * height * count]) }
    }

    /// Row `y`, all planes.
    pub fn row(&self, y: usize) -> Row<'_> {
        let n = self.count * self.width;
        match &self.samples {
            Samples::Half(v) => Row::Half(&v[y * n..][..n]),
            Samples::Float(v) => Row::Float(&v[y * n..][..n]),
        }
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
    pub fn as_f32<'a>(&'a self, scratch: &'a mut [f32]) -> &'a [f32] {
        match self {
            Row::Float(row) => row,
            Row::Half(row) => {
                let scratch = &mut scratch[..row.len()];
                kernel::widen(row, scratch);
                scratch
            }
        }
    }
}

/// A sample of a picture that can be written.
pub trait Sample: Copy + Send + Sync {
    /// Stores a row of floats, limited to what the type can hold; returns how many were limited.
    fn store(from: &[f32], to: &mut [Self]) -> u64;
}

impl Sample for f32 {
    fn store(from: &[f32], to: &mut [f32]) -> u64 {
        to.copy_from_slice(from);
        0
    }
}

impl Sample for f16 {
    fn store(from: &[f32], to: &mut [f16]) -> u64 {
        if !kernel::narrow(from, to) {
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

/// A linear map from the bands of a spectral frame to the planes that are kept of it.
///
/// `weights[row * bands + band]`: the integral over the band of the row's weighting function, so that a row's
/// value is the sum over bands of weight times spectral radiance in W m^-2 sr^-1 nm^-1.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    pub bands: usize,
    pub rows: usize,
    pub weights: Vec<f32>,
}

impl Projection {
    /// Every band kept as it is.
    pub fn identity(bands: usize) -> Projection {
        let weights = (0..bands * bands).map(|i| if i % (bands + 1) == 0 { 1.0 } else { 0.0 }).collect();
        Projection { bands, rows: bands, weights }
    }

    /// The same map for bands that are stored in another order and scale: stored band `i` is band `order[i]` of
    /// this map and is multiplied by `scale[i]` on the way.
    pub fn reordered(&self, order: &[usize], scale: &[f64]) -> Projection {
        let weights = (0..self.rows)
            .flat_map(|row| {
                let of_row = &self.weights[row * self.bands..][..self.bands];
                order.iter().zip(scale).map(move |(&band, s)| (f64::from(of_row[band]) * s) as f32)
            })
            .collect();
        Projection { bands: order.len(), rows: self.rows, weights }
    }

    /// Projects one row: `bands` runs of `width` samples in, `rows` runs of `width` sums out, added in band order.
    pub fn project(&self, bands: &[f32], out: &mut [f32]) {
        let width = bands.len() / self.bands;
        for (row, sums) in out.chunks_exact_mut(width).enumerate() {
            sums.fill(0.0);
            let weights = &self.weights[row * self.bands..][..self.bands];
            for (weight, samples) in weights.iter().zip(bands.chunks_exact(width)) {
                for (sum, sample) in sums.iter_mut().zip(samples) {
                    *sum += weight * sample;
                }
            }
        }
    }
}

/// What a frame's samples had wrong with them, counted before any policy mended it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    pub nan: u64,
    pub infinite: u64,
    pub negative: u64,
    /// Integer samples at the top of their range: a display-referred picture whose light was cut off.
    pub clipped: u64,
}

impl Tally {
    /// The sum of two counts.
    pub fn plus(self, other: Tally) -> Tally {
        Tally {
            nan: self.nan + other.nan,
            infinite: self.infinite + other.infinite,
            negative: self.negative + other.negative,
            clipped: self.clipped + other.clipped,
        }
    }

    /// NaN and infinite samples.
    pub fn non_finite(self) -> u64 {
        self.nan + self.infinite
    }
}

/// Red, green, blue and white chromaticities, CIE 1931 x, y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    pub red: [f64; 2],
    pub green: [f64; 2],
    pub blue: [f64; 2],
    pub white: [f64; 2],
}

impl Primaries {
    /// ITU-R BT.709 / sRGB with D65: what an OpenEXR file without `chromaticities` means.
    pub const REC709: Primaries =
        Primaries { red: [0.64, 0.33], green: [0.30, 0.60], blue: [0.15, 0.06], white: [0.3127, 0.3290] };
}

/// The planes of one frame and what was wrong with its samples.
#[derive(Clone, Debug)]
pub struct Frame {
    pub planes: Planes,
    pub tally: Tally,
}
