//! Sunlight through the air.
//!
//! ```text
//! sun    L(lambda) = E(lambda)/6.807e-5 sr T(lambda, h)
//! air    T = exp(-m (0.008735 l^-4.08 + beta l^-1.3 + 0.35 k_o)),  beta = 0.0461 turbidity - 0.0459, l in um
//! mass   m = 1/(sin h + .50572 (h + 6.07995)^-1.6364)              (Kasten & Young 1989), h in degrees
//! limb   mu^alpha (2 + alpha)/2, alpha = -0.023 + 0.292/l          (Hestroffer & Magnan 1998, A&A 333, 338)
//! ```
//!
//! The disc has one spectrum, that of the elevation of its centre: an eye that stares at it
//! bleaches evenly. Its limb darkens alike at all wavelengths, by the law at 600 nm, where the low
//! sun shines.

use crate::spectrum::{Bands, CIE1931, SOLAR};
use crate::units::LUMENS_PER_WATT;

/// Radius of the sun's disc, degrees.
pub(super) const RADIUS_DEG: f64 = 0.533 / 2.0;
/// Solid angle of the disc, sr.
const SOLID_ANGLE: f64 = 6.807e-5;
/// Exponent of the limb's darkening at 600 nm.
const LIMB: f64 = -0.023 + 0.292 / 0.6;
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

/// Mean spectral radiance of the sun's disc at an elevation, W m^-2 sr^-1 nm^-1.
pub(crate) fn radiance(nm: f64, elevation_deg: f64, turbidity: f64) -> f64 {
    SOLAR.interpolated("irradiance", nm) / SOLID_ANGLE * transmittance(nm, elevation_deg, turbidity)
}

/// Brightness at a distance from the disc's centre (in its radii) over the disc's mean; none
/// outside.
pub(super) fn limb(from_centre: f64) -> f64 {
    let mu_squared = 1.0 - from_centre * from_centre;
    if mu_squared > 0.0 { mu_squared.powf(LIMB / 2.0) * (2.0 + LIMB) / 2.0 } else { 0.0 }
}

/// Sunlight that came through the air at an elevation and was scattered once: a spectrum of one
/// cd/m2. `blue`: the share of scattering by air; haze does the rest.
pub(super) fn scattered(bands: &Bands, elevation_deg: f64, turbidity: f64, blue: f64) -> Vec<f64> {
    let spectrum = bands.as_slice().iter().map(|band| {
        let l = band.centre / 550.0;
        let by = blue * l.powf(-4.08) + (1.0 - blue) * l.powf(-0.6);
        by * radiance(band.centre, elevation_deg, turbidity)
    });
    let spectrum: Vec<f64> = spectrum.collect();
    let nits = luminance(bands, &spectrum);
    spectrum.into_iter().map(|v| v / nits).collect()
}

/// Luminance of a spectrum, cd/m2.
pub(super) fn luminance(bands: &Bands, spectrum: &[f64]) -> f64 {
    let of_band = |(band, v): (&crate::spectrum::Band, &f64)| {
        LUMENS_PER_WATT * band.width() * v * CIE1931.interpolated("y", band.centre)
    };
    bands.as_slice().iter().zip(spectrum).map(of_band).sum()
}

fn air_mass(elevation_deg: f64) -> f64 {
    1.0 / (elevation_deg.to_radians().sin() + 0.50572 * (elevation_deg + 6.07995).powf(-1.6364))
}

fn transmittance(nm: f64, elevation_deg: f64, turbidity: f64) -> f64 {
    let l = nm / 1000.0;
    let beta = (0.0461 * turbidity - 0.0459).max(0.0);
    (-air_mass(elevation_deg) * (0.008735 * l.powf(-4.08) + beta * l.powf(-1.3) + 0.35 * ozone(nm)))
        .exp()
}

fn ozone(nm: f64) -> f64 {
    let inside = OZONE.windows(2).find(|pair| (pair[0].0..pair[1].0).contains(&nm));
    inside.map_or(0.0, |pair| {
        pair[0].1 + (pair[1].1 - pair[0].1) * (nm - pair[0].0) / (pair[1].0 - pair[0].0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{apply, chromaticity};
    use crate::observer::Observer;
    use crate::spectrum::Curve;

    #[test]
    fn the_low_sun_is_as_bright_as_published() {
        // model.md 9, T = 2.5, +-15 %.
        for (elevation, nits) in
            [(0.5, 6.7e5), (1.0, 2.2e6), (2.0, 1.2e7), (5.0, 1.3e8), (10.0, 4.6e8)]
        {
            let y = |nm: f64| CIE1931.interpolated("y", nm) * radiance(nm, elevation, 2.5);
            let ours = LUMENS_PER_WATT * (360..830).map(|nm| y(f64::from(nm))).sum::<f64>();
            assert!((ours / nits - 1.0).abs() < 0.15, "{elevation}: {ours:e} against {nits:e}");
        }
    }

    #[test]
    fn the_sun_half_a_degree_up_is_orange_red() {
        let eye = Observer::standard();
        let catch = eye.catch(&Curve::sampled(|nm| radiance(nm, 0.5, 2.5)), [1.0; 3]);
        let [x, y] = chromaticity(apply(&eye.lms_to_xyz, catch));
        assert!((x - 0.621).abs() < 0.005 && (y - 0.373).abs() < 0.005, "{x} {y}");
    }

    #[test]
    fn the_limb_darkens_and_keeps_the_discs_mean() {
        let radii = (0..2000).map(|i| (f64::from(i) + 0.5) / 2000.0);
        let mean: f64 = radii.map(|r| 2.0 * r / 2000.0 * limb(r)).sum();
        assert!((mean - 1.0).abs() < 1e-3, "{mean}");
        assert!(
            limb(0.0) > limb(0.6) && limb(0.6) > limb(0.95) && limb(0.95) > 0.5 && limb(1.0) == 0.0
        );
    }

    #[test]
    fn scattered_light_is_of_one_candela_and_bluer_the_more_air_scatters() {
        let bands = Bands::uniform(390.0, 730.0, 68).unwrap();
        let (haze, air) = (scattered(&bands, 10.0, 2.5, 0.0), scattered(&bands, 10.0, 2.5, 1.0));
        assert!(
            (luminance(&bands, &haze) - 1.0).abs() < 1e-12
                && (luminance(&bands, &air) - 1.0).abs() < 1e-12
        );
        assert!(air[10] > 1.5 * haze[10] && air[60] < haze[60]);
    }
}
