//! The built-in scene: a low sun over the sea, or over land, as spectral radiance.
//!
//!     sun    L(lambda) = E(lambda)/6.807e-5 sr * T(lambda, h) * mu^alpha (2 + alpha)/2
//!     air    T = exp(-m (0.008735 l^-4.08 + beta l^-1.3 + 0.35 k_o)),  beta = 0.0461 turbidity - 0.0459, l in um
//!     mass   m = 1/(sin h + .50572 (h + 6.07995)^-1.6364)              (Kasten & Young 1989), h in degrees
//!     limb   alpha = -0.023 + 0.292/l                                  (Hestroffer & Magnan 1998, A&A 333, 338)
//!
//! The sun's disc is exact within this model. Sky, sea and land are painted: spectra scattered once out of the same
//! sunlight, with luminances in the range measured near a low sun (1e3..1e4 cd/m2 beside it, 25..100 elsewhere).

use std::sync::LazyLock;

use crate::error::Error;
use crate::light::{Frame, Planes, Projection, Samples, Tally};
use crate::spectrum::{Bands, CIE1931, SOLAR};
use crate::units::LUMENS_PER_WATT;

use super::{Footage, Header, Kind};

/// Width of the scene, degrees.
pub const FIELD_DEG: f64 = 8.0;
/// Radius of the sun's disc, degrees.
const SUN_RADIUS_DEG: f64 = 0.533 / 2.0;
/// Solid angle of the disc, sr.
const SUN_SOLID_ANGLE: f64 = 6.807e-5;
/// Ozone absorption (nm, cm^-1) for 0.35 cm.
const OZONE: [(f64, f64); 11] = [
    (430.0, 0.0),
    (450.0, 0.003),
    (500.0, 0.021),
    (550.0, 0.063),
    (575.0, 0.115),
    (600.0, 0.125),
    (625.0, 0.085),
    (650.0, 0.062),
    (680.0, 0.036),
    (700.0, 0.021),
    (750.0, 0.0),
];

static BANDS: LazyLock<Bands> = LazyLock::new(|| {
    let centres: Vec<f64> = (0..68).map(|i| 392.5 + 5.0 * f64::from(i)).collect();
    Bands::from_centres(&centres).unwrap_or_else(|| unreachable!("these centres rise"))
});

/// What lies under the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    Sea,
    Land,
}

/// A sun at `elevation_deg` in the middle of a picture that is 8 degrees across.
#[derive(Clone, Debug)]
pub struct Sunset {
    elevation_deg: f64,
    turbidity: f64,
    ground: Ground,
    header: Header,
}

impl Sunset {
    /// The scene at a width in pixels; the height is nine sixteenths of it.
    pub fn new(width: usize, elevation_deg: f64, turbidity: f64, ground: Ground) -> Self {
        let header = Header {
            width,
            height: (width * 9 / 16).max(1),
            kind: Kind::Spectral(BANDS.clone()),
            white: None,
            frames_per_second: None,
            notes: Vec::new(),
        };
        Sunset { elevation_deg, turbidity, ground, header }
    }

    /// Spectral radiance of the sun's disc at a distance from its centre (0..1 of its radius) and an elevation, in
    /// W m^-2 sr^-1 nm^-1.
    pub fn sun_radiance(&self, nm: f64, from_centre: f64, elevation_deg: f64) -> f64 {
        let mu = (1.0 - from_centre * from_centre).max(0.0).sqrt();
        let alpha = -0.023 + 0.292 / (nm / 1000.0);
        let limb = mu.powf(alpha) * (2.0 + alpha) / 2.0;
        SOLAR.interpolated("irradiance", nm) / SUN_SOLID_ANGLE
            * transmittance(nm, air_mass(elevation_deg), self.turbidity)
            * limb
    }

    fn degrees_per_pixel(&self) -> f64 {
        FIELD_DEG / self.header.width as f64
    }

    /// Elevation of a row, degrees; negative below the horizon.
    fn elevation(&self, y: f64) -> f64 {
        self.elevation_deg - (y - (self.header.height as f64 - 1.0) / 2.0) * self.degrees_per_pixel()
    }

    fn paint_row(&self, y: usize, out: &mut [f32]) {
        let above = self.elevation(y as f64);
        if above >= 0.0 {
            self.paint_sky(y, above, out);
            self.paint_sun(y, out);
        } else {
            match self.ground {
                Ground::Sea => self.paint_sea(y, above, out),
                Ground::Land => self.paint_land(above, out),
            }
        }
    }

    /// Horizontal distance of a column from the sun, degrees.
    fn aside(&self, x: usize) -> f64 {
        (x as f64 - (self.header.width as f64 - 1.0) / 2.0) * self.degrees_per_pixel()
    }

    fn paint_sky(&self, _y: usize, above: f64, out: &mut [f32]) {
        let glow = self.scattered(self.elevation_deg + 1.5, 0.0);
        let air = self.scattered(above + 4.0, 0.35);
        self.paint(out, |x| {
            let from_sun = self.aside(x).hypot(above - self.elevation_deg);
            vec![(aureole(from_sun), &glow), (veil(from_sun, above), &air)]
        });
    }

    fn paint_sun(&self, y: usize, out: &mut [f32]) {
        const SIDE: usize = 4;
        let step = self.degrees_per_pixel();
        let width = self.header.width;
        for (band, out) in BANDS.as_slice().iter().zip(out.chunks_exact_mut(width)) {
            for i in 0..SIDE {
                let above = self.elevation(y as f64 + (i as f64 + 0.5) / SIDE as f64 - 0.5);
                let row = self.sun_radiance(band.centre, 0.0, above.max(0.0));
                let alpha = -0.023 + 0.292 / (band.centre / 1000.0);
                for (x, out) in out.iter_mut().enumerate() {
                    for j in 0..SIDE {
                        let aside = self.aside(x) + ((j as f64 + 0.5) / SIDE as f64 - 0.5) * step;
                        let r = aside.hypot(above - self.elevation_deg) / SUN_RADIUS_DEG;
                        if r < 1.0 && above >= 0.0 {
                            *out += (row * (1.0 - r * r).sqrt().powf(alpha) / (SIDE * SIDE) as f64) as f32;
                        }
                    }
                }
            }
        }
    }

    fn paint_sea(&self, y: usize, above: f64, out: &mut [f32]) {
        let glow = self.scattered(self.elevation_deg + 1.5, 0.0);
        let air = self.scattered(4.0 - above, 0.35);
        let depth = -above;
        let shine = 0.25 + 0.45 * (-depth / 0.6).exp();
        self.paint(out, |x| {
            let aside = self.aside(x);
            let from_sun = aside.hypot(depth - self.elevation_deg);
            let waves = ripple(aside, depth, y);
            let path = (-(aside / (0.22 + 0.22 * depth)).powi(2)).exp();
            let glitter = 2.2e4 * path * waves.powi(4) * (-depth / 1.6).exp();
            let mirrored = shine * (0.75 + 0.5 * waves);
            vec![(mirrored * aureole(from_sun) * 0.6 + glitter, &glow), (mirrored * veil(from_sun, depth), &air)]
        });
    }

    fn paint_land(&self, above: f64, out: &mut [f32]) {
        let light = self.scattered(self.elevation_deg + 2.0, 0.1);
        self.paint(out, |x| {
            let fields =
                0.5 + 0.5 * (self.aside(x) * 3.1 + above * 11.0).sin() * (self.aside(x) * 1.3 - above * 7.0).cos();
            vec![(12.0 + 14.0 * fields, &light)]
        });
    }

    /// Adds spectra of unit luminance times a luminance in cd/m2 at every column.
    fn paint<'a>(&self, out: &mut [f32], of_column: impl Fn(usize) -> Vec<(f64, &'a Vec<f64>)>) {
        let width = self.header.width;
        for x in 0..width {
            for (nits, spectrum) in of_column(x) {
                for (i, value) in spectrum.iter().enumerate() {
                    out[i * width + x] += (nits * value) as f32;
                }
            }
        }
    }

    /// Sunlight that came through the air at an elevation and was scattered once: spectrum of one cd/m2. `blue`: the
    /// share of scattering by air; haze does the rest.
    fn scattered(&self, elevation_deg: f64, blue: f64) -> Vec<f64> {
        let mass = air_mass(elevation_deg);
        let at = |nm: f64| {
            let l = nm / 1000.0;
            let by = blue * (l / 0.55).powf(-4.08) + (1.0 - blue) * (l / 0.55).powf(-0.6);
            SOLAR.interpolated("irradiance", nm) * transmittance(nm, mass, self.turbidity) * by
        };
        let spectrum: Vec<f64> = BANDS.as_slice().iter().map(|b| at(b.centre)).collect();
        let luminance: f64 = BANDS
            .as_slice()
            .iter()
            .zip(&spectrum)
            .map(|(b, v)| LUMENS_PER_WATT * b.width() * v * CIE1931.interpolated("y", b.centre))
            .sum();
        spectrum.into_iter().map(|v| v / luminance).collect()
    }
}

/// Light scattered forward by haze around the sun, cd/m2.
fn aureole(from_sun_deg: f64) -> f64 {
    2600.0 * (-from_sun_deg / 0.55).exp() + 900.0 * (-from_sun_deg / 2.2).exp()
}

/// Light of the sky at large, cd/m2: brighter toward sun and horizon.
fn veil(from_sun_deg: f64, above_deg: f64) -> f64 {
    60.0 + 240.0 * (-from_sun_deg / 4.0).exp() * (-above_deg / 5.0).exp()
}

/// How much a wave's face is turned toward the viewer, 0..1: three trains of waves that shrink toward the horizon.
fn ripple(aside: f64, depth: f64, y: usize) -> f64 {
    let far = 1.0 / (depth + 0.04);
    let row = y as f64;
    let a = (aside * 9.0 + 5.0 * far + row * 0.9).sin();
    let b = (aside * 17.0 * (0.4 + far.min(6.0) / 6.0) - 3.0 * far + row * 2.3).sin();
    let c = (aside * 31.0 + 8.0 * far - row * 1.7).sin();
    0.5 + (a + 0.8 * b + 0.6 * c) / 4.8
}

fn air_mass(elevation_deg: f64) -> f64 {
    let h = elevation_deg.max(0.0);
    1.0 / (h.to_radians().sin() + 0.50572 * (h + 6.07995).powf(-1.6364))
}

fn transmittance(nm: f64, air_mass: f64, turbidity: f64) -> f64 {
    let l = nm / 1000.0;
    let beta = (0.0461 * turbidity - 0.0459).max(0.0);
    (-air_mass * (0.008735 * l.powf(-4.08) + beta * l.powf(-1.3) + 0.35 * ozone(nm))).exp()
}

fn ozone(nm: f64) -> f64 {
    let inside = OZONE.windows(2).find(|pair| (pair[0].0..pair[1].0).contains(&nm));
    inside.map_or(0.0, |pair| pair[0].1 + (pair[1].1 - pair[0].1) * (nm - pair[0].0) / (pair[1].0 - pair[0].0))
}

impl Footage for Sunset {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        1
    }

    fn read(&self, _: usize, projection: Option<&Projection>, recycled: Option<Planes>) -> Result<Frame, Error> {
        use rayon::prelude::*;
        let Some(projection) = projection else {
            return Err(Error::file("the built-in sunset", "is spectral; it cannot be read as RGB"));
        };
        let (width, height) = (self.header.width, self.header.height);
        let mut planes = match recycled {
            Some(planes) if (planes.width, planes.height, planes.count) == (width, height, projection.rows) => planes,
            _ => Planes::float(width, height, projection.rows),
        };
        if let Samples::Float(samples) = &mut planes.samples {
            samples.par_chunks_exact_mut(projection.rows * width).enumerate().for_each_init(
                || vec![0.0f32; BANDS.len() * width],
                |bands, (y, moments)| {
                    bands.fill(0.0);
                    self.paint_row(y, bands);
                    projection.remember(y, 0, bands);
                    projection.project(bands, moments);
                },
            );
        }
        Ok(Frame { planes, tally: Tally::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::chromaticity;
    use crate::eye::Observer;
    use crate::spectrum::Curve;

    fn disc_luminance(elevation: f64) -> f64 {
        let scene = Sunset::new(480, elevation, 2.5, Ground::Sea);
        let y = |nm: f64| CIE1931.interpolated("y", nm) * scene.sun_radiance(nm, 0.0, elevation);
        // The mean over the disc is the centre's value over the limb's centre-to-mean ratio, near 1.2 at 590 nm.
        LUMENS_PER_WATT * (360..830).map(|nm| y(f64::from(nm))).sum::<f64>() / 1.236
    }

    #[test]
    fn the_low_sun_is_as_bright_as_published() {
        // model.md 9, T = 2.5, +-15 %.
        for (elevation, nits) in [(0.5, 6.7e5), (1.0, 2.2e6), (2.0, 1.2e7), (5.0, 1.3e8), (10.0, 4.6e8)] {
            let ours = disc_luminance(elevation);
            assert!((ours / nits - 1.0).abs() < 0.15, "{elevation}: {ours:e} against {nits:e}");
        }
    }

    #[test]
    fn the_sun_half_a_degree_up_is_orange_red() {
        let scene = Sunset::new(480, 0.5, 2.5, Ground::Sea);
        let eye = Observer::standard();
        let catch = eye.catch(&Curve::sampled(|nm| scene.sun_radiance(nm, 0.0, 0.5)), [1.0; 3]);
        let [x, y] = chromaticity(crate::colour::apply(&eye.lms_to_xyz, catch));
        assert!((x - 0.621).abs() < 0.005 && (y - 0.373).abs() < 0.005, "{x} {y}");
    }

    #[test]
    fn the_limb_law_keeps_the_discs_mean() {
        let scene = Sunset::new(480, 0.5, 2.5, Ground::Sea);
        for nm in [450.0, 550.0, 650.0] {
            let rings = 2000;
            let mean: f64 = (0..rings)
                .map(|i| (f64::from(i) + 0.5) / f64::from(rings))
                .map(|r| 2.0 * r / f64::from(rings) * scene.sun_radiance(nm, r, 5.0))
                .sum();
            let flat = SOLAR.interpolated("irradiance", nm) / SUN_SOLID_ANGLE * transmittance(nm, air_mass(5.0), 2.5);
            assert!((mean / flat - 1.0).abs() < 1e-3);
        }
    }
}
