//! The projection of spectral frames onto the few sums that are kept of them, done block by block
//! while a file is decoded.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use crate::kernel::BandSums;
use crate::light::{PlaneTile, Planes, Samples};

/// A linear map from the bands of a spectral frame to the planes that are kept of it.
///
/// The weight of a row in a band is the integral over the band of the row's weighting function, so
/// that a row's value is the sum over bands of weight times spectral radiance in W m^-2 sr^-1
/// nm^-1.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    pub(crate) bands: usize,
    pub(crate) rows: usize,
    sums: BandSums,
    /// For each stored band its number among the bands, and the factor to radiance.
    stored: Vec<(usize, f64)>,
    /// Places whose whole spectra are to be remembered on the way.
    kept: Option<Arc<SampledSpectra>>,
}

impl Projection {
    /// A map with these weights, row by row.
    pub fn new(bands: usize, rows: usize, weights: Vec<f32>) -> Projection {
        let mut sums = BandSums::new(rows);
        weights
            .chunks_exact(bands)
            .enumerate()
            .for_each(|(row, weights)| sums.set(row, weights.iter().copied()));
        Projection::of_sums(bands, sums)
    }

    /// Every band kept as it is.
    pub(crate) fn identity(bands: usize) -> Projection {
        Projection::choice(bands, 0..bands)
    }

    /// Some of the bands as they are.
    pub(crate) fn choice(bands: usize, chosen: Range<usize>) -> Projection {
        let mut sums = BandSums::new(chosen.len());
        for (row, band) in chosen.enumerate() {
            sums.put(row, band, 1.0);
        }
        Projection::of_sums(bands, sums)
    }

    fn of_sums(bands: usize, sums: BandSums) -> Projection {
        let stored = (0..bands).map(|i| (i, 1.0)).collect();
        Projection { bands, rows: sums.rows(), sums, stored, kept: None }
    }

    /// The weight of a row in a band.
    pub fn weight(&self, row: usize, band: usize) -> f32 {
        self.sums.weight(row, band)
    }

    /// The same map, which remembers the spectra of some places.
    pub(crate) fn keeping(&self, kept: Arc<SampledSpectra>) -> Projection {
        Projection { kept: Some(kept), ..self.clone() }
    }

    /// The same map for bands that are stored in another order and scale: stored band `i` is band
    /// `order[i]` of this map and is multiplied by `scale[i]` on the way.
    pub(crate) fn reordered(&self, order: &[usize], scale: &[f64]) -> Projection {
        let mut sums = BandSums::new(self.rows);
        for (stored, (&band, scale)) in order.iter().zip(scale).enumerate() {
            for (row, weight) in self.sums.of_band(band) {
                sums.put(row, stored, (f64::from(weight) * scale) as f32);
            }
        }
        let stored = order.iter().copied().zip(scale.iter().copied()).collect();
        Projection { bands: order.len(), rows: self.rows, sums, stored, kept: self.kept.clone() }
    }

    /// Projects one row: `bands` runs of `width` samples in, `rows` runs of `width` sums out, added
    /// in band order.
    pub(crate) fn project(&self, bands: &[f32], out: &mut [f32]) {
        let width = bands.len() / self.bands;
        self.sums.project(PlaneTile::whole(bands, width), out);
    }

    /// Projects a frame of bands in memory, with the bits of one that is decoded. `old`: planes to be
    /// written over.
    pub(crate) fn of_frame(&self, frame: &Planes, old: Option<Planes>) -> Planes {
        let (width, height) = (frame.width, frame.height);
        let fits = |old: &Planes| {
            (old.width, old.height, old.count) == (width, height, self.rows)
                && matches!(old.samples, Samples::Float(_))
        };
        let mut planes =
            old.filter(fits).unwrap_or_else(|| Planes::float(width, height, self.rows));
        if let Samples::Float(samples) = &mut planes.samples {
            let rows = samples.par_chunks_exact_mut(self.rows * width).enumerate();
            let room = || vec![0.0; self.bands * width];
            rows.for_each_init(room, |room, (y, out)| {
                self.project(frame.row(y).as_f32(room), out);
            });
        }
        planes
    }

    /// The places whose spectra are to be remembered, and room for them.
    pub(crate) fn kept(&self) -> Option<&Arc<SampledSpectra>> {
        self.kept.as_ref()
    }

    /// Columns of the places in row `y` whose spectra are to be remembered.
    pub(crate) fn kept_columns(&self, y: usize) -> impl Iterator<Item = usize> + '_ {
        let places = self.kept.iter().flat_map(|kept| kept.places.iter());
        places.filter(move |[_, row]| *row == y).map(|[x, _]| *x)
    }

    /// Remembers the spectra of the places that lie in row `y`; `bands` begins at column `left` of
    /// the frame.
    pub(crate) fn remember(&self, y: usize, left: usize, bands: &[f32]) {
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
            hold(spectrum, values);
        }
    }
}

/// The spectra of a few places of one frame, as they were before any projection.
#[derive(Debug)]
pub struct SampledSpectra {
    places: Vec<[usize; 2]>,
    spectra: Vec<Mutex<Vec<f64>>>,
}

/// Rooms for the same places are alike, whatever they hold.
impl PartialEq for SampledSpectra {
    fn eq(&self, other: &SampledSpectra) -> bool {
        self.places == other.places
    }
}

impl SampledSpectra {
    /// Room for these places: column and row of each.
    pub(crate) fn new(places: &[[usize; 2]]) -> Self {
        SampledSpectra {
            places: places.to_vec(),
            spectra: places.iter().map(|_| Mutex::new(Vec::new())).collect(),
        }
    }

    /// Column and row of each place.
    pub(crate) fn places(&self) -> &[[usize; 2]] {
        &self.places
    }

    /// Fills in the radiance of place `i`, band by band.
    pub(crate) fn fill(&self, i: usize, spectrum: Vec<f64>) {
        hold(&self.spectra[i], spectrum);
    }

    /// Radiance of place `i`, band by band; empty where the frame had no data.
    pub(crate) fn spectrum(&self, i: usize) -> Vec<f64> {
        self.spectra[i]
            .lock()
            .map_or_else(|poisoned| poisoned.into_inner().clone(), |spectrum| spectrum.clone())
    }
}

fn hold(place: &Mutex<Vec<f64>>, spectrum: Vec<f64>) {
    *place.lock().unwrap_or_else(PoisonError::into_inner) = spectrum;
}
