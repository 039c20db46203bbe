//! The few lights that the scene is mixed of. Since a frame is projected linearly, each light is
//! projected once, and a pixel is a sum of as many products.

use super::sun;
use crate::spectrum::Bands;
use crate::vision::Projection;

/// Number of lights.
pub(super) const LIGHTS: usize = 4;

/// Luminances of the lights in one place, cd/m2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mixture {
    /// Straight from the disc.
    pub(crate) sun: f64,
    /// Scattered by haze low over the horizon: orange.
    pub(crate) ember: f64,
    /// Scattered forward by haze: pale gold.
    pub(crate) gold: f64,
    /// Scattered by air: blue-grey.
    pub(crate) air: f64,
}

impl Mixture {
    pub(super) const DARK: Mixture = Mixture { sun: 0.0, ember: 0.0, gold: 0.0, air: 0.0 };

    pub(super) fn as_array(self) -> [f64; LIGHTS] {
        [self.sun, self.ember, self.gold, self.air]
    }

    fn of_array([sun, ember, gold, air]: [f64; LIGHTS]) -> Mixture {
        Mixture { sun, ember, gold, air }
    }

    pub(super) fn plus(self, other: Mixture) -> Mixture {
        let (a, b) = (self.as_array(), other.as_array());
        Mixture::of_array(std::array::from_fn(|i| a[i] + b[i]))
    }

    pub(super) fn times(self, factor: f64) -> Mixture {
        Mixture::of_array(self.as_array().map(|nits| nits * factor))
    }

    /// Luminance, cd/m2.
    #[cfg(test)]
    pub(crate) fn nits(self) -> f64 {
        self.as_array().iter().sum()
    }
}

/// Spectra of one cd/m2 of each light, in the order of [`Mixture::as_array`], for a sun at an
/// elevation.
pub(super) fn spectra(bands: &Bands, elevation_deg: f64, turbidity: f64) -> [Vec<f64>; LIGHTS] {
    let disc: Vec<f64> = bands
        .as_slice()
        .iter()
        .map(|band| sun::radiance(band.centre, elevation_deg, turbidity))
        .collect();
    let nits = sun::luminance(bands, &disc);
    let scattered = |higher: f64, blue: f64| {
        sun::scattered(bands, (elevation_deg + higher).min(90.0), turbidity, blue)
    };
    [
        disc.into_iter().map(|v| v / nits).collect(),
        scattered(3.5, 0.2),
        scattered(9.0, 0.25),
        scattered(22.0, 0.8),
    ]
}

/// What a projection keeps of spectra, one run of planes for each.
pub(super) fn projected(
    spectra: &[Vec<f64>; LIGHTS],
    projection: &Projection,
) -> [Vec<f32>; LIGHTS] {
    std::array::from_fn(|i| {
        let bands: Vec<f32> = spectra[i].iter().map(|&v| v as f32).collect();
        let mut planes = vec![0.0; projection.rows];
        projection.project(&bands, &mut planes);
        planes
    })
}
