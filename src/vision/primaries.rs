//! The spectra that RGB stands for: D65 times shares of the sRGB primaries (Mallett & Yuksel
//! 2019), on their grid of 5 nm.

use crate::colour::{self, Matrix, Primaries};
use crate::observer::Observer;
use crate::spectrum::{Curve, D65, SRGB_BASIS};
use crate::units::Nits;

/// Spectra of the sRGB primaries on the 5 nm grid of their basis: (nm, radiance times K), their sum
/// being 1 cd/m2. The three spectra of the basis are mixed anew, so that unbleached they are caught
/// exactly as the standard sRGB matrix says: R = C_MY(1)^-1 T^-1.
pub(super) fn srgb_lights(observer: &Observer) -> [Vec<(usize, f64)>; 3] {
    let raw = ["rho_r", "rho_g", "rho_b"].map(|primary| -> Vec<(usize, f64)> {
        let shares = SRGB_BASIS.wavelengths.iter().zip(SRGB_BASIS.column(primary));
        shares.map(|(&nm, rho)| (nm as usize, rho * D65.interpolated("d65", nm))).collect()
    });
    let remix = colour::product(
        &colour::inverse(&catches(observer, &raw)),
        &colour::inverse(&lms_to_srgb(observer)),
    );
    [0, 1, 2].map(|j| {
        let mixed = |(i, &(nm, _)): (usize, &(usize, f64))| {
            (nm, (0..3).map(|k| remix[k][j] * raw[k][i].1).sum())
        };
        raw[0].iter().enumerate().map(mixed).collect()
    })
}

/// T: catches, in units whose Y is cd/m2 -> linear sRGB in cd/m2. The one matrix from catches to
/// the percept, for light of every kind.
pub(super) fn lms_to_srgb(observer: &Observer) -> Matrix {
    let Some(to_xyz) = colour::rgb_to_xyz(&Primaries::REC709) else {
        unreachable!("Rec. 709 has a gamut")
    };
    colour::product(&colour::inverse(&to_xyz), &observer.lms_to_xyz)
}

/// Radiance of R, G and B in a picture's own primaries.
pub(super) fn basis_of_rgb(
    observer: &Observer,
    srgb: &[Vec<(usize, f64)>; 3],
    to_srgb: &Matrix,
    white: Nits,
) -> Vec<Curve> {
    let of_primary = |j: usize| {
        let mut light = Curve::sampled(|_| 0.0);
        for (i, lines) in srgb.iter().enumerate() {
            for (nm, e) in lines.iter().filter(|(nm, _)| (Curve::FROM..=Curve::TO).contains(nm)) {
                light.0[nm - Curve::FROM] += white.0 * to_srgb[i][j] * e / observer.lumens_per_watt;
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

fn catches(observer: &Observer, lights: &[Vec<(usize, f64)>; 3]) -> Matrix {
    [0, 1, 2].map(|k| [0, 1, 2].map(|j| inner(observer.fundamentals.unbleached(k), &lights[j])))
}
