//! What lies under the horizon, painted: a sea that mirrors the sky and the sun in its waves.
//!
//! Waves are a sum of sines in `aside/sqrt depth` and `ln depth`: they shorten and narrow toward
//! the horizon, as a sea does in perspective. A sine fades as it comes near two pixels, exp(-g^2/4)
//! at g radians a pixel, and brightness is exp(s n - s^2 var/2) of the noise n: so distant waves
//! melt into their own mean, at any width.

use super::light::Mixture;
use super::sky::sky;

/// Sines of the waves.
const TRAINS: usize = 28;
/// Degrees under the horizon at which perspective is cut off: the sea's far edge.
const EDGE_DEG: f64 = 0.03;

/// The sea's waves.
#[derive(Clone, Debug)]
pub(super) struct Waves([Train; TRAINS]);

/// One train: radians to the unit of `aside/sqrt depth` and of `ln depth`, phase, amplitude.
#[derive(Clone, Copy, Debug)]
struct Train {
    across: f64,
    along: f64,
    phase: f64,
    height: f64,
}

/// Noise at a place, and the variance that it has there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swell {
    height: f64,
    variance: f64,
}

impl Swell {
    /// A brightness of mean one, the more uneven the larger `contrast`.
    fn glint(self, contrast: f64) -> f64 {
        (contrast * self.height - 0.5 * contrast * contrast * self.variance).exp()
    }
}

impl Waves {
    /// Trains spread evenly over lengths and directions by the golden ratio and its peers.
    pub(super) fn new() -> Self {
        let spread = |i: usize, ratio: f64| (i as f64 * ratio).fract();
        Waves(std::array::from_fn(|i| {
            let along = 9.0 * 16f64.powf((i as f64 + 0.5) / TRAINS as f64);
            Train {
                across: along * (0.5 * spread(i, 0.618_034) - 0.25),
                along,
                phase: std::f64::consts::TAU * spread(i, 0.754_878),
                height: (2.0 / TRAINS as f64).sqrt(),
            }
        }))
    }

    /// The waves `depth` degrees under the horizon, `aside` of the sun, on pixels of `pixel`
    /// degrees.
    pub(super) fn at(&self, aside: f64, depth: f64, pixel: f64) -> Swell {
        let far = 1.0 / (depth + EDGE_DEG);
        let (u, v) = (aside * far.sqrt(), -far.ln());
        let mut swell = Swell { height: 0.0, variance: 0.0 };
        for train in &self.0 {
            let slope = [train.across * far.sqrt(), (train.along - 0.5 * train.across * u) * far]
                .map(|g| g * pixel);
            let height = train.height * (-(slope[0] * slope[0] + slope[1] * slope[1]) / 4.0).exp();
            if height > 1e-4 {
                swell.height += height * (train.across * u + train.along * v + train.phase).sin();
                swell.variance += height * height / 2.0;
            }
        }
        swell
    }
}

/// Luminances of the sea `depth` degrees under the horizon, `aside` of a sun `sun_deg` above it.
pub(super) fn sea(waves: &Waves, aside: f64, depth: f64, sun_deg: f64, pixel: f64) -> Mixture {
    let swell = waves.at(aside, depth, pixel);
    // Waves tilt toward the viewer and mirror a higher sky; steep looks mirror less of it.
    let mirrored = sky(aside.hypot(sun_deg + 0.5 + 0.5 * depth), 1.0 + 2.0 * depth);
    let shine = (0.34 + 0.4 * (-depth / 0.8).exp()) * swell.glint(0.35);
    let spread = 0.16 + 0.2 * depth;
    let path = (-(aside / spread).powi(2)).exp() * (0.3 / (0.3 + depth));
    let deep = Mixture { air: 30.0, ..Mixture::DARK };
    mirrored.times(shine).plus(deep).plus(Mixture {
        sun: 5000.0 * path * swell.glint(1.4),
        gold: 900.0 * path * swell.glint(1.4),
        ..Mixture::DARK
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_melt_into_their_mean_toward_the_horizon() {
        let waves = Waves::new();
        let variance = |depth| waves.at(0.7, depth, 8.0 / 480.0).variance;
        assert!(
            variance(0.02) < 0.1 && variance(2.0) > 0.5,
            "{} {}",
            variance(0.02),
            variance(2.0)
        );
        let places = (0..100).flat_map(|i| {
            (0..400).map(move |j| (0.2 * f64::from(j) - 40.0, 0.3 * 1.023f64.powi(i)))
        });
        let sum: f64 = places.map(|(aside, depth)| waves.at(aside, depth, 1e-3).glint(0.5)).sum();
        assert!((sum / 40_000.0 - 1.0).abs() < 0.05, "{}", sum / 40_000.0);
    }

    #[test]
    fn the_sun_has_a_path_over_the_sea() {
        let waves = Waves::new();
        let at = |aside, depth| sea(&waves, aside, depth, 0.5, 8.0 / 480.0);
        assert!(
            (0..20)
                .all(|i| at(0.0, 0.1 * f64::from(i)).sun > 100.0 * at(3.0, 0.1 * f64::from(i)).sun)
        );
    }
}
