//! What one observer makes of one kind of light: planes of a frame -> cone illuminance -> percept.
//!
//! A catch through a pigment at p is, within [`level_bound`], a sum over three fixed spectra, one
//! for each of its `LEVELS`:
//!
//! ```text
//! R_k(p) = p sum_j w_j(p) M_kj,   M_kj = K integral L H_k(.; p_j),   H = s_k(.; p)/p,   p_j = 0, 1/2, 1
//! ```
//!
//! Cone illuminance takes one more inner product per level of the Stiles-Crawford weight. So the
//! light is projected once ([`Vision::projection`]), whatever pupil and pigment do: the *moments*.
//! p = 1 is a level, hence an unbleached eye is exact.

mod form;
mod levels;
mod primaries;
mod projection;

use crate::colour::Primaries;
use crate::colour::{self, Matrix};
use crate::light::Planes;
use crate::observer::Observer;
use crate::observer::directional::MOST_LEVELS;
use crate::spectrum::{Bands, Curve};
use crate::units::{Millimetres, Nits};

pub use levels::level_bound;
pub(crate) use levels::{LEVELS, Levels};
use levels::{peaks, weighting_curves};
use primaries::{basis_of_rgb, inner, lms_to_srgb, srgb_lights};
pub use projection::Projection;
pub(crate) use projection::SampledSpectra;

/// How planes become moments.
#[derive(Clone, Debug)]
enum Reception {
    /// Three planes of RGB; each moment is a row of three weights.
    Rgb(Vec<[f64; 3]>),
    /// The planes are the moments; `Projection` made them of bands.
    Bands(Projection),
    /// The planes are the bands themselves; the projection is made where it is needed.
    Held(Projection),
}

/// One observer and one kind of light.
#[derive(Clone, Debug)]
pub struct Vision {
    pub observer: Observer,
    reception: Reception,
    levels: Levels,
    /// LMS (in units whose Y is cd/m2) -> the picture's own RGB and scale.
    pub(crate) lms_to_seen: Matrix,
    /// The picture's RGB and scale -> linear sRGB in cd/m2, for the display.
    pub(crate) seen_to_srgb: Matrix,
    /// Planes -> luminance in cd/m2, for the pupil and the display.
    pub luminance: Vec<f64>,
    /// Spectral radiance, W m^-2 sr^-1 nm^-1, of each stored plane at the value 1: RGB, or the
    /// bands.
    basis: Vec<Curve>,
    /// `narrowed` reading: H_k at the levels, for each wavelength at which the fundamental peaks at
    /// some p.
    peaks: Option<[Vec<[f64; 3]>; 3]>,
}

impl Vision {
    /// Sight of RGB light in these primaries, (1, 1, 1) of linear sRGB being `white`.
    /// `None` if the primaries span no gamut.
    pub fn of_rgb(observer: Observer, primaries: &Primaries, white: Nits) -> Option<Self> {
        let to_srgb = colour::to_rec709(primaries)?;
        let y = colour::rgb_to_xyz(primaries)?[1];
        let srgb = srgb_lights(&observer);
        let rows = weighting_curves(&observer);
        let row = |curve: &Curve| {
            let in_srgb = [0, 1, 2].map(|j| white.0 * inner(curve, &srgb[j]));
            [0, 1, 2].map(|j| (0..3).map(|i| in_srgb[i] * to_srgb[i][j]).sum())
        };
        Some(Vision {
            lms_to_seen: colour::scaled(
                &colour::product(&colour::inverse(&to_srgb), &lms_to_srgb(&observer)),
                1.0 / white.0,
            ),
            seen_to_srgb: colour::scaled(&to_srgb, white.0),
            luminance: y.iter().map(|v| v * white.0).collect(),
            reception: Reception::Rgb(rows.iter().map(row).collect()),
            basis: basis_of_rgb(&observer, &srgb, &to_srgb, white),
            peaks: peaks(&observer),
            levels: Levels::of(densest(&observer)),
            observer,
        })
    }

    /// Sight of spectral light in these bands. The percept is linear sRGB in cd/m2.
    pub fn of_bands(observer: Observer, bands: &Bands) -> Self {
        let rows = weighting_curves(&observer);
        let weights = rows
            .iter()
            .flat_map(|row| row.over(bands))
            .map(|w| (observer.lumens_per_watt * w) as f32)
            .collect();
        let mut luminance = vec![0.0; rows.len()];
        for (k, y) in observer.lms_to_xyz[1].into_iter().enumerate() {
            luminance[LEVELS.len() * k + LEVELS.len() - 1] = y;
        }
        Vision {
            lms_to_seen: lms_to_srgb(&observer),
            seen_to_srgb: colour::IDENTITY,
            luminance,
            reception: Reception::Bands(Projection::new(bands.len(), rows.len(), weights)),
            basis: bands.as_slice().iter().map(|band| Curve::within(band.low, band.high)).collect(),
            peaks: peaks(&observer),
            levels: Levels::of(densest(&observer)),
            observer,
        }
    }

    /// Sight of spectral light whose frames hold the bands themselves: for footage that is in
    /// memory already, and for whoever wants to keep it.
    pub fn of_held_bands(observer: Observer, bands: &Bands) -> Self {
        let mut vision = Vision::of_bands(observer, bands);
        if let Reception::Bands(projection) = vision.reception {
            let row = |plane: usize| {
                let weights = vision.luminance.iter().enumerate();
                weights.map(|(i, w)| w * f64::from(projection.weight(i, plane))).sum()
            };
            vision.luminance = (0..projection.bands).map(row).collect();
            vision.reception = Reception::Held(projection);
        }
        vision
    }

    /// The light of each stored plane, RGB or bands, at the value 1: what the definition of a catch
    /// takes.
    pub fn basis(&self) -> &[Curve] {
        &self.basis
    }

    /// Whether the percept of an unbleached eye is the frame itself: so for RGB.
    pub(crate) fn returns_its_light(&self) -> bool {
        matches!(self.reception, Reception::Rgb(_))
    }

    /// Whether frames hold bands, of which the moments are still to be made.
    pub(crate) fn holds_bands(&self) -> bool {
        matches!(self.reception, Reception::Held(_))
    }

    /// What spectral frames are projected onto while they are decoded; `None` for RGB.
    pub fn projection(&self) -> Option<&Projection> {
        match &self.reception {
            Reception::Rgb(_) | Reception::Held(_) => None,
            Reception::Bands(projection) => Some(projection),
        }
    }

    /// Largest error of a catch from the levels, relative to what the light's parts catch, each
    /// taken as light: of light without negative parts that is the catch itself. The spectra that
    /// RGB stands for have negative parts, small ones in sRGB, large ones in wide primaries: what is
    /// left of the S cone's catch of a BT.2020 red is a rounding error of parts that cancel, and no
    /// measure of anything. The `narrowed` reading divides by a peak, which errs as a catch does.
    pub(crate) fn levels_bound(&self) -> f64 {
        let of_sum = level_bound(densest(&self.observer));
        if self.peaks.is_some() { 2.0 * of_sum } else { of_sum }
    }

    /// How many moments a place has: three per level of p, cone by cone, then three per level of
    /// the Stiles-Crawford weight.
    pub fn moment_count(&self) -> usize {
        self.first_illuminance() + 3 * self.observer.directional.levels().len()
    }

    /// The first moment that belongs to cone illuminance.
    pub(crate) fn first_illuminance(&self) -> usize {
        3 * LEVELS.len()
    }

    /// How many planes a frame has.
    pub fn plane_count(&self) -> usize {
        self.luminance.len()
    }

    /// The weight of a plane in moment `row`.
    pub(crate) fn moment_weight(&self, row: usize, plane: usize) -> f64 {
        match &self.reception {
            Reception::Rgb(rows) => rows[row][plane],
            Reception::Bands(_) => f64::from(u8::from(row == plane)),
            Reception::Held(projection) => projection.weight(row, plane).into(),
        }
    }

    /// The moments of one place.
    pub fn moments(&self, planes: &Planes, x: usize, y: usize) -> Vec<f64> {
        match &self.reception {
            Reception::Rgb(rows) => {
                let rgb = [0, 1, 2].map(|i| planes.at(x, y, i));
                rows.iter().map(|w| w[0] * rgb[0] + w[1] * rgb[1] + w[2] * rgb[2]).collect()
            }
            Reception::Bands(_) => (0..planes.count).map(|i| planes.at(x, y, i)).collect(),
            Reception::Held(p) => {
                let light: Vec<f64> = (0..p.bands).map(|i| planes.at(x, y, i)).collect();
                let inner = |row: usize| {
                    light
                        .iter()
                        .enumerate()
                        .map(|(band, v)| f64::from(p.weight(row, band)) * v)
                        .sum()
                };
                (0..p.rows).map(inner).collect()
            }
        }
    }

    /// Moments of light that an equal-energy spectrum of one cd/m2 would have: what surrounds the
    /// picture.
    pub(crate) fn equal_energy_moments(&self) -> Vec<f64> {
        self.moments_of(&Curve::sampled(|_| 1.0))
    }

    /// Planes of light that an equal-energy spectrum of one cd/m2 would have; in RGB, of light that
    /// unbleached cones catch alike.
    pub fn equal_energy_planes(&self) -> Vec<f64> {
        let moments = self.equal_energy_moments();
        match &self.reception {
            Reception::Rgb(_) => {
                colour::apply(&self.lms_to_seen, self.catch(&moments, [1.0; 3])).to_vec()
            }
            Reception::Bands(_) => moments,
            Reception::Held(p) => vec![1.0 / self.luminance.iter().sum::<f64>(); p.bands],
        }
    }

    /// Moments of light of any spectrum at one cd/m2.
    pub(crate) fn moments_of(&self, spectrum: &Curve) -> Vec<f64> {
        let luminance = spectrum.times(&self.observer.luminous_efficiency()).integral();
        let rows = weighting_curves(&self.observer);
        rows.iter().map(|row| spectrum.times(row).integral() / luminance).collect()
    }

    /// The cone class that a moment belongs to: 0, 1, 2 for L, M, S.
    pub(crate) fn cone_of_moment(&self, row: usize) -> usize {
        match row.checked_sub(self.first_illuminance()) {
            None => row / LEVELS.len(),
            Some(row) => row / self.observer.directional.levels().len(),
        }
    }

    /// Cone illuminance as a linear form of the moments: `[cone][level]`, to be applied to
    /// moments from `Vision::first_illuminance` on.
    pub fn illuminance_weights(
        &self,
        pupil: Millimetres,
        r: Millimetres,
    ) -> [[f64; MOST_LEVELS]; 3] {
        let (area, etas) =
            (crate::observer::pupil::area(pupil), self.observer.directional.weights(pupil, r));
        self.observer.cone_troland().map(|c| etas.map(|eta| c * area * eta))
    }

    /// Cone illuminance of one place, td; never negative.
    pub fn illuminance(&self, moments: &[f64], weights: &[[f64; MOST_LEVELS]; 3]) -> [f64; 3] {
        let levels = self.observer.directional.levels().len();
        [0, 1, 2].map(|k| {
            let of_cone = &moments[self.first_illuminance() + k * levels..][..levels];
            of_cone.iter().zip(&weights[k]).map(|(m, w)| m * w).sum::<f64>().max(0.0)
        })
    }

    /// Catches of one place through its pigments, in units whose Y row gives cd/m2.
    pub fn catch(&self, moments: &[f64], p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let of_cone = &moments[LEVELS.len() * k..][..LEVELS.len()];
            if p[k] == 1.0 {
                return of_cone[LEVELS.len() - 1];
            }
            let sum = self.levels.mix(p[k], of_cone);
            match &self.peaks {
                None => p[k] * sum,
                Some(peaks) => {
                    sum / peaks[k].iter().map(|h| self.levels.mix(p[k], h)).fold(0.0, f64::max)
                }
            }
        })
    }

    /// The percept's RGB -> linear sRGB in cd/m2, in single precision.
    pub(crate) fn to_srgb(&self) -> [[f32; 3]; 3] {
        self.seen_to_srgb.map(|row| row.map(|v| v as f32))
    }

    /// XYZ of catches, cd/m2.
    pub(crate) fn xyz(&self, catch: [f64; 3]) -> [f64; 3] {
        colour::apply(&self.observer.lms_to_xyz, catch)
    }
}

/// The greatest of the cones' peak densities.
fn densest(observer: &Observer) -> f64 {
    observer.fundamentals.density().into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
