//! The spectra that RGB stands for: D65 times the shares of the sRGB primaries (Mallett & Yuksel
//! 2019), on their grid of 5 nm.

use crate::colour::Matrix;
use crate::observer::Observer;
use crate::spectrum::{Curve, D65, SRGB_BASIS};
use crate::units::{LUMENS_PER_WATT, Nits};

/// Spectra of the sRGB primaries on the 5 nm grid of their basis: (nm, radiance), scaled so that
/// their sum has 1 cd/m2 of the observer's luminance (Mallett & Yuksel 2019, under D65).
pub(super) fn srgb_lights(observer: &Observer) -> [Vec<(usize, f64)>; 3] {
    let raw = ["rho_r", "rho_g", "rho_b"].map(|primary| -> Vec<(usize, f64)> {
        let shares = SRGB_BASIS.wavelengths.iter().zip(SRGB_BASIS.column(primary));
        shares.map(|(&nm, rho)| (nm as usize, rho * D65.interpolated("d65", nm))).collect()
    });
    let v = observer.luminous_efficiency();
    let white: f64 = raw.iter().map(|light| inner(&v, light)).sum();
    raw.map(|light| light.into_iter().map(|(nm, e)| (nm, e / white)).collect())
}

/// Radiance of R, G and B in a picture's own primaries.
pub(super) fn basis_of_rgb(
    srgb: &[Vec<(usize, f64)>; 3],
    to_srgb: &Matrix,
    white: Nits,
) -> Vec<Curve> {
    let of_primary = |j: usize| {
        let mut light = Curve::sampled(|_| 0.0);
        for (i, lines) in srgb.iter().enumerate() {
            for (nm, e) in lines.iter().filter(|(nm, _)| (Curve::FROM..=Curve::TO).contains(nm)) {
                light.0[nm - Curve::FROM] += white.0 * to_srgb[i][j] * e / LUMENS_PER_WATT;
            }
        }
        light
    };
    (0..3).map(of_primary).collect()
}

/// Inner product of a curve with a light on the basis' grid.
pub(super) fn inner(curve: &Curve, light: &[(usize, f64)]) -> f64 {
    light.iter().map(|&(nm, e)| curve.at(nm) * e).sum()
}

/// C(1): linear sRGB -> LMS of the unbleached observer.
pub(super) fn srgb_catches(observer: &Observer, srgb: &[Vec<(usize, f64)>; 3]) -> Matrix {
    [0, 1, 2].map(|k| [0, 1, 2].map(|j| inner(observer.fundamentals.unbleached(k), &srgb[j])))
}
