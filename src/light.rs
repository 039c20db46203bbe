//! The light of one frame, as rows of planes.
//!
//! A frame is `count` planes of `width` x `height` samples, stored row by row and, inside a row,
//! plane by plane: the order of a scanline OpenEXR file, and one in which a row is the unit of work
//! everywhere.
//!
//! * RGB light keeps the file's own numbers: three planes, half or float.
//! * Spectral light is never held whole. Each block of rows is projected as it is decoded by a
//!   [`Projection`] onto the few inner products that the retina and the percept need; those are the
//!   planes.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use half::f16;

use crate::kernel::{self, BandSums, Strip};

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
        Planes {
            width,
            height,
            count,
            samples: Samples::Half(vec![f16::ZERO; width * height * count]),
        }
    }

    /// Row `y`, all planes.
    pub fn row(&self, y: usize) -> Row<'_> {
        let n = self.count * self.width;
        match &self.samples {
            Samples::Half(v) => Row::Half(&v[y * n..][..n]),
            Samples::Float(v) => Row::Float(&v[y * n..][..n]),
        }
    }

    /// A run of plane `i` in row `y` as single floats, converted into `room` where it is stored as
    /// half.
    pub fn run<'a>(
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
                kernel::widen(&row[run], room);
                room
            }
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
/// The weight of a row in a band is the integral over the band of the row's weighting function, so
/// that a row's value is the sum over bands of weight times spectral radiance in W m^-2 sr^-1
/// nm^-1.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    pub bands: usize,
    pub rows: usize,
    sums: BandSums,
    /// For each stored band its number among the bands, and the factor to radiance.
    stored: Vec<(usize, f64)>,
    /// Places whose whole spectra are to be remembered on the way.
    kept: Option<Arc<Kept>>,
}

impl Projection {
    /// A map with these weights, row by row.
    pub fn new(bands: usize, rows: usize, weights: Vec<f32>) -> Projection {
        let mut sums = BandSums::new(rows, bands);
        weights
            .chunks_exact(bands)
            .enumerate()
            .for_each(|(row, weights)| sums.set(row, weights.iter().copied()));
        Projection { bands, rows, sums, stored: (0..bands).map(|i| (i, 1.0)).collect(), kept: None }
    }

    /// Every band kept as it is.
    pub fn identity(bands: usize) -> Projection {
        let weights =
            (0..bands * bands).map(|i| if i % (bands + 1) == 0 { 1.0 } else { 0.0 }).collect();
        Projection::new(bands, bands, weights)
    }

    /// The weight of a row in a band.
    pub fn weight(&self, row: usize, band: usize) -> f32 {
        self.sums.weight(row, band)
    }

    /// The same map, which remembers the spectra of some places.
    pub fn keeping(&self, kept: Arc<Kept>) -> Projection {
        Projection { kept: Some(kept), ..self.clone() }
    }

    /// The same map for bands that are stored in another order and scale: stored band `i` is band
    /// `order[i]` of this map and is multiplied by `scale[i]` on the way.
    pub fn reordered(&self, order: &[usize], scale: &[f64]) -> Projection {
        let mut sums = BandSums::new(self.rows, order.len());
        for row in 0..self.rows {
            let scaled =
                |(&band, s): (&usize, &f64)| (f64::from(self.weight(row, band)) * s) as f32;
            sums.set(row, order.iter().zip(scale).map(scaled));
        }
        let stored = order.iter().copied().zip(scale.iter().copied()).collect();
        Projection { bands: order.len(), rows: self.rows, sums, stored, kept: self.kept.clone() }
    }

    /// Projects one row: `bands` runs of `width` samples in, `rows` runs of `width` sums out, added
    /// in band order.
    pub fn project(&self, bands: &[f32], out: &mut [f32]) {
        let width = bands.len() / self.bands;
        self.sums.project(Strip::whole(bands, width), out);
    }

    /// Columns of the places in row `y` whose spectra are to be remembered.
    pub fn kept_columns(&self, y: usize) -> impl Iterator<Item = usize> + '_ {
        let places = self.kept.iter().flat_map(|kept| kept.places.iter());
        places.filter(move |[_, row]| *row == y).map(|[x, _]| *x)
    }

    /// Remembers the spectra of the places that lie in row `y`; `bands` begins at column `left` of
    /// the frame.
    pub fn remember(&self, y: usize, left: usize, bands: &[f32]) {
        let Some(kept) = &self.kept else { return };
        let width = bands.len() / self.bands;
        for (place, spectrum) in
            kept.places.iter().zip(&kept.spectra).filter(|([_, row], _)| *row == y)
        {
            let Some(x) = place[0].checked_sub(left).filter(|x| *x < width) else { continue };
            let mut values = vec![0.0; self.bands];
            for (i, &(band, scale)) in self.stored.iter().enumerate() {
                values[band] = f64::from(bands[i * width + x]) * scale;
            }
            if let Ok(mut spectrum) = spectrum.lock() {
                *spectrum = values;
            }
        }
    }
}

/// The spectra of a few places of one frame, as they were before any projection.
#[derive(Debug)]
pub struct Kept {
    places: Vec<[usize; 2]>,
    spectra: Vec<Mutex<Vec<f64>>>,
}

/// Rooms for the same places are alike, whatever they hold.
impl PartialEq for Kept {
    fn eq(&self, other: &Kept) -> bool {
        self.places == other.places
    }
}

impl Kept {
    /// Room for these places: column and row of each.
    pub fn new(places: &[[usize; 2]]) -> Self {
        Kept {
            places: places.to_vec(),
            spectra: places.iter().map(|_| Mutex::new(Vec::new())).collect(),
        }
    }

    /// Radiance of place `i`, band by band; empty where the frame had no data.
    pub fn spectrum(&self, i: usize) -> Vec<f64> {
        self.spectra[i]
            .lock()
            .map_or_else(|poisoned| poisoned.into_inner().clone(), |spectrum| spectrum.clone())
    }
}

/// What a frame's samples had wrong with them, counted before any policy mended it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    pub const REC709: Primaries = Primaries {
        red: [0.64, 0.33],
        green: [0.30, 0.60],
        blue: [0.15, 0.06],
        white: [0.3127, 0.3290],
    };
}

/// The planes of one frame and what was wrong with its samples.
#[derive(Clone, Debug)]
pub struct Frame {
    pub planes: Planes,
    pub tally: Tally,
}
