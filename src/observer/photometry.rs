//! Photometry: what an observer's luminance and colours are in the units that everybody reads.
//!
//! ```text
//! luminance = K integral L V                 V = the Y row of the observer's LMS -> XYZ
//! K = 683.002 Y_1931(D65) / Y_own(D65)       cd/m2 as a photometer reads them, exact for D65
//! ```
//!
//! cd/m2 is defined with V(lambda) of 1924; an observer's own V has another area, so 683 lm/W would
//! make the same white 5.7 % (2 degrees) or 11.9 % (10 degrees) brighter than other programs say.
//! The rows X and Z of the observer's LMS -> XYZ are scaled so that D65 falls on x, y = .3127,
//! .3290: XYZ, linear sRGB and every file are then one space, joined by the standard sRGB matrix.

use super::Fundamentals;
use crate::colour::{Matrix, Primaries, apply};
use crate::spectrum::{CIE1931, Curve, D65};
use crate::units::LUMENS_PER_WATT;

/// Luminous efficacy and colour space of one observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Photometry {
    /// K, lm/W: radiance weighted by the observer's own V -> cd/m2.
    pub(crate) lumens_per_watt: f64,
    /// LMS -> XYZ, on which D65 has its own chromaticity.
    pub(crate) lms_to_xyz: Matrix,
}

impl Photometry {
    /// The photometry of fundamentals whose published LMS -> XYZ is this.
    pub(crate) fn new(fundamentals: &Fundamentals, published: &Matrix) -> Self {
        let d65 = d65();
        let y_1931: f64 =
            Curve::wavelengths().zip(&d65.0).map(|(nm, e)| CIE1931.interpolated("y", nm) * e).sum();
        let lms = [0, 1, 2].map(|k| d65.times(fundamentals.unbleached(k)).integral());
        let [x, y, z] = apply(published, lms);
        let [white_x, white_y] = Primaries::REC709.white;
        let scales = [white_x / white_y * y / x, 1.0, (1.0 - white_x - white_y) / white_y * y / z];
        Photometry {
            lumens_per_watt: LUMENS_PER_WATT * y_1931 / y,
            lms_to_xyz: [0, 1, 2].map(|i| published[i].map(|v| scales[i] * v)),
        }
    }
}

/// CIE standard illuminant D65 at every nanometre, to the end of its table at 780 nm.
pub(crate) fn d65() -> Curve {
    Curve::sampled(|nm| if nm <= 780.0 { D65.interpolated("d65", nm) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::{Field, Set};

    #[test]
    fn cd_per_m2_are_those_of_1931_for_d65_and_d65_is_white() {
        let observers = [(Field::TwoDegrees, 646.0832), (Field::TenDegrees, 610.6047)];
        for (field, k) in observers {
            let set = Set::Cie2006;
            let fundamentals = Fundamentals::new(set, field, set.optical_density(field));
            let photometry = Photometry::new(&fundamentals, &set.lms_to_xyz(field));
            assert!((photometry.lumens_per_watt - k).abs() < 1e-3);
            let lms = [0, 1, 2].map(|i| d65().times(fundamentals.unbleached(i)).integral());
            let [x, y] = crate::colour::chromaticity(apply(&photometry.lms_to_xyz, lms));
            assert!((x - 0.3127).abs() < 1e-12 && (y - 0.3290).abs() < 1e-12);
        }
    }

    #[test]
    fn x_and_z_are_the_published_rows_but_for_their_scale() {
        let set = Set::Cie2006;
        let rows = [
            (Field::TwoDegrees, [1.95333217, -1.41879294, 0.36588292], 1.95940858),
            (Field::TenDegrees, [1.94653126, -1.35127167, 0.43192870], 2.18226897),
        ];
        for (field, x, z) in rows {
            let fundamentals = Fundamentals::new(set, field, set.optical_density(field));
            let ours = Photometry::new(&fundamentals, &set.lms_to_xyz(field)).lms_to_xyz;
            assert!(ours[0].iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-7), "{ours:?}");
            assert!((ours[2][2] - z).abs() < 1e-7, "{ours:?}");
        }
    }
}
