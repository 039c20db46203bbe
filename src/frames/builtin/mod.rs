//! The built-in scene: a low sun over the sea, as spectral radiance.
//!
//! The sun's disc is exact within the model of `sun`; sky and sea are painted with light
//! scattered out of the same sun. The picture is 8 degrees across, the sun in its middle.

mod ground;
mod light;
mod sky;
mod sun;

use crate::error::Error;
use crate::light::{Frame, Planes, Samples, Tally};
use crate::spectrum::Bands;
use crate::vision::Projection;
use ground::Waves;
use light::{LIGHTS, Mixture};

use super::{Footage, Header, Kind};

/// Width of the scene, degrees.
pub(crate) const FIELD_DEG: f64 = 8.0;

/// Luminance of the sun half a degree up under a turbidity of 2.5, for which the sky is painted,
/// cd/m2.
const USUAL_SUN: f64 = 6.2e5;

pub(crate) use sun::radiance as sun_radiance;

/// Samples of the disc's edge along each side of a pixel.
const SIDE: usize = 8;

/// A sun at `elevation_deg` in the middle of a picture that is 8 degrees across.
#[derive(Clone, Debug)]
pub(crate) struct Sunset {
    elevation_deg: f64,
    header: Header,
    waves: Waves,
    /// Mean luminance of the disc, cd/m2.
    sun: f64,
    /// Spectra of one cd/m2 of each light.
    spectra: [Vec<f64>; LIGHTS],
}

impl Sunset {
    /// The scene at a width in pixels; the height is nine sixteenths of it.
    pub(crate) fn new(width: usize, elevation_deg: f64, turbidity: f64) -> Self {
        let bands = bands();
        let disc: Vec<f64> = bands
            .as_slice()
            .iter()
            .map(|band| sun::radiance(band.centre, elevation_deg, turbidity))
            .collect();
        let (sun, spectra) =
            (sun::luminance(&bands, &disc), light::spectra(&bands, elevation_deg, turbidity));
        let header = Header::new(width, (width * 9 / 16).max(1), Kind::Spectral(bands));
        Sunset { elevation_deg, header, waves: Waves::new(), sun, spectra }
    }

    fn degrees_per_pixel(&self) -> f64 {
        FIELD_DEG / self.header.width as f64
    }

    /// Elevation of a row, degrees; negative below the horizon.
    fn above(&self, y: f64) -> f64 {
        self.elevation_deg
            - (y - (self.header.height as f64 - 1.0) / 2.0) * self.degrees_per_pixel()
    }

    /// Horizontal distance of a column from the sun, degrees.
    fn aside(&self, x: usize) -> f64 {
        (x as f64 - (self.header.width as f64 - 1.0) / 2.0) * self.degrees_per_pixel()
    }

    /// The light at a place: sky and ground by their shares of the pixel, and the sun.
    fn light(&self, aside: f64, above: f64) -> Mixture {
        let pixel = self.degrees_per_pixel();
        let open = (above / pixel + 0.5).clamp(0.0, 1.0);
        let sky_light = (self.sun / USUAL_SUN).sqrt();
        let mut light = Mixture { sun: self.disc(aside, above), ..Mixture::DARK };
        if open > 0.0 {
            let sky = sky::sky(aside.hypot(above - self.elevation_deg), above);
            light = light.plus(sky.times(open * sky_light));
        }
        if open < 1.0 {
            let depth = (-above).max(0.0);
            let ground = ground::sea(&self.waves, aside, depth, self.elevation_deg, pixel);
            light = light.plus(ground.times((1.0 - open) * sky_light));
        }
        light
    }

    /// Luminance of the disc in a pixel, the mean over its area of what stands over the horizon,
    /// cd/m2.
    fn disc(&self, aside: f64, above: f64) -> f64 {
        let pixel = self.degrees_per_pixel();
        if aside.hypot(above - self.elevation_deg) > sun::RADIUS_DEG + pixel {
            return 0.0;
        }
        let offset = |i: usize| ((i as f64 + 0.5) / SIDE as f64 - 0.5) * pixel;
        let sample = |i: usize| {
            let (aside, above) = (aside + offset(i % SIDE), above + offset(i / SIDE));
            let open = above >= 0.0;
            if open {
                sun::limb(aside.hypot(above - self.elevation_deg) / sun::RADIUS_DEG)
            } else {
                0.0
            }
        };
        self.sun * (0..SIDE * SIDE).map(sample).sum::<f64>() / (SIDE * SIDE) as f64
    }

    /// Paints row `y`: runs of as many samples as columns, one for each plane that `lights` has.
    fn paint_row(&self, y: usize, lights: &[Vec<f32>; LIGHTS], planes: &mut [f32]) {
        let (width, above) = (self.header.width, self.above(y as f64));
        for x in 0..width {
            let nits = self.light(self.aside(x), above).as_array().map(|v| v as f32);
            for (i, plane) in planes.chunks_exact_mut(width).enumerate() {
                plane[x] = (0..LIGHTS).map(|k| nits[k] * lights[k][i]).sum();
            }
        }
    }

    /// Spectral radiance of a pixel, band by band.
    fn spectrum(&self, x: usize, y: usize) -> Vec<f32> {
        let nits = self.light(self.aside(x), self.above(y as f64)).as_array();
        let band = |i: usize| (0..LIGHTS).map(|k| nits[k] * self.spectra[k][i]).sum::<f64>() as f32;
        (0..self.spectra[0].len()).map(band).collect()
    }
}

/// Bands of 5 nm from 390 to 730 nm.
fn bands() -> Bands {
    Bands::uniform(390.0, 730.0, 68).unwrap_or_else(|| unreachable!("these bands rise"))
}

impl Footage for Sunset {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        1
    }

    fn read(
        &self,
        _: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame, Error> {
        use rayon::prelude::*;
        let Some(projection) = projection else {
            return Err(Error::file(
                "the built-in sunset",
                "is spectral; it cannot be read as RGB",
            ));
        };
        let (width, height) = (self.header.width, self.header.height);
        let mut planes = match recycled {
            Some(planes)
                if (planes.width, planes.height, planes.count)
                    == (width, height, projection.rows) =>
            {
                planes
            }
            _ => Planes::float(width, height, projection.rows),
        };
        let lights = light::projected(&self.spectra, projection);
        if let Samples::Float(samples) = &mut planes.samples {
            let rows = samples.par_chunks_exact_mut(projection.rows * width).enumerate();
            rows.for_each(|(y, row)| {
                self.paint_row(y, &lights, row);
                projection
                    .kept_columns(y)
                    .for_each(|x| projection.remember(y, x, &self.spectrum(x, y)));
            });
        }
        Ok(Frame { planes, tally: Tally::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(scene: &Sunset) -> Planes {
        scene.read(0, Some(&Projection::identity(68)), None).unwrap().planes
    }

    #[test]
    fn every_pixel_of_the_disc_has_the_spectrum_of_its_centre() {
        let scene = Sunset::new(480, 0.5, 2.5);
        let planes = frame(&scene);
        let ratio = |x, y| planes.at(x, y, 56) / planes.at(x, y, 40);
        for (x, y) in [(240, 122), (240, 148), (228, 135), (252, 135)] {
            assert!((ratio(x, y) / ratio(240, 135) - 1.0).abs() < 0.01, "{x} {y}");
        }
    }

    #[test]
    fn the_discs_light_is_that_of_the_sun_at_any_width() {
        for width in [64, 480, 1000] {
            let scene = Sunset::new(width, 2.0, 2.5);
            let (height, pixel) = (scene.header.height, scene.degrees_per_pixel());
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let sum: f64 =
                places.map(|(x, y)| scene.disc(scene.aside(x), scene.above(y as f64))).sum();
            let flux = sum * pixel * pixel / (std::f64::consts::PI * sun::RADIUS_DEG.powi(2));
            assert!((flux / scene.sun - 1.0).abs() < 0.02, "{width}: {flux} of {}", scene.sun);
        }
    }

    #[test]
    fn every_elevation_gives_finite_light() {
        for elevation in [0.0, 0.2, 3.0, 45.0, 90.0] {
            let planes = frame(&Sunset::new(16, elevation, 2.5));
            let Samples::Float(samples) = planes.samples else { unreachable!() };
            assert!(samples.iter().all(|v| v.is_finite() && *v >= 0.0), "{elevation}");
            assert!(samples.iter().any(|v| *v > 0.0));
        }
    }
}
