//! Cone fundamentals, whole and bleached.
//!
//! ```text
//! q_k(lambda; p) = [1 - 10^(-D_k p a_k)] 10^(-(lens + macula)) lambda
//! s_k(lambda; p) = q_k(lambda; p) / max q_k(.; 1)
//! ```
//!
//! a: absorbance with unit peak; D: peak axial optical density; p: unbleached fraction; energy
//! units. Sources: CIE 170-1:2006 after Stockman & Sharpe 2000 (Vision Research 40, 1711-1737);
//! Stockman, MacLeod & Johnson 1993 (JOSA A 10, 2491-2521), which the paper of 2005 uses.

use serde::{Deserialize, Serialize};

use crate::spectrum::{CIE1964, CONE_PIECES, Curve};

/// L, M, S: the order of every triple.
pub(crate) const CONES: [&str; 3] = ["L", "M", "S"];

/// A published set of fundamentals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Set {
    /// CIE 170-1:2006, rebuilt from its parts.
    Cie2006,
    /// Stockman, MacLeod & Johnson 1993, 10 degrees, from the CIE 1964 functions.
    Smj1993,
}

/// Size of the field the fundamentals hold for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    TenDegrees,
    TwoDegrees,
}

/// Peak of the tabulated macular density, 2 degrees, and the peak at 10 degrees (CIE 170-1:2006).
const MACULA_PEAK: (f64, f64) = (0.35, 0.095);

/// L, M, S as linear forms of the CIE 1964 functions (Stockman, MacLeod & Johnson 1993, unit
/// peaks).
const SMJ_FROM_XYZ10: [[f64; 3]; 3] = [
    [0.236157, 0.826427, -0.045710],
    [-0.431117, 1.206922, 0.090020],
    [0.040557, -0.019683, 0.486195],
];

/// Beyond this wavelength, nm, the S cone of the 1993 set follows log10 S = a / lambda - b.
const SMJ_S_TAIL: (f64, f64, f64) = (520.0, 10402.1, 21.7185);

impl Set {
    /// Peak axial densities of L, M, S: CIE 170-1:2006; 0.30 for the 1993 set, whose narrowing
    /// takes that value.
    pub fn optical_density(self, field: Field) -> [f64; 3] {
        match (self, field) {
            (Set::Cie2006, Field::TenDegrees) => [0.38, 0.38, 0.30],
            (Set::Cie2006, Field::TwoDegrees) => [0.50, 0.50, 0.40],
            (Set::Smj1993, _) => [0.30, 0.30, 0.30],
        }
    }

    /// LMS -> XYZ (CIE 170-2:2015); for the 1993 set the inverse of its matrix, not exact in Z
    /// beyond 520 nm.
    pub(crate) fn lms_to_xyz(self, field: Field) -> [[f64; 3]; 3] {
        match (self, field) {
            (Set::Cie2006, Field::TenDegrees) => [
                [1.93986443, -1.34664359, 0.43044935],
                [0.69283932, 0.34967567, 0.0],
                [0.0, 0.0, 2.14687945],
            ],
            (Set::Cie2006, Field::TwoDegrees) => [
                [1.94735469, -1.41445123, 0.36476327],
                [0.68990272, 0.34832189, 0.0],
                [0.0, 0.0, 1.93485343],
            ],
            (Set::Smj1993, _) => [
                [1.85618309, -1.26433791, 0.40860525],
                [0.67255343, 0.36795030, -0.00489612],
                [-0.12761001, 0.12036347, 2.02250502],
            ],
        }
    }
}

/// The three fundamentals of one observer and how they narrow.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fundamentals {
    unbleached: [Curve; 3],
    absorbance: [Curve; 3],
    density: [f64; 3],
}

impl Fundamentals {
    /// The set at a field size and peak densities.
    pub(crate) fn new(set: Set, field: Field, density: [f64; 3]) -> Self {
        let absorbance = ["l", "m", "s"]
            .map(|cone| piece(&format!("log10_absorbance_{cone}"), |log| 10f64.powf(log)));
        let unbleached = match set {
            Set::Cie2006 => [0, 1, 2].map(|k| from_parts(&absorbance[k], density[k], field)),
            Set::Smj1993 => smj(),
        };
        Fundamentals { unbleached, absorbance, density }
    }

    /// The fundamentals behind a filter, with unit peaks again, and what each peak is of what it
    /// was.
    pub(crate) fn behind(mut self, filter: &Curve) -> (Self, [f64; 3]) {
        let passed = [0, 1, 2].map(|k| {
            let (whole, behind) = (&self.unbleached[k], self.unbleached[k].times(filter));
            let passed = behind.peak() / whole.peak();
            self.unbleached[k] = behind.scaled(1.0 / passed);
            passed
        });
        (self, passed)
    }

    /// Peak axial optical density of each class.
    pub(crate) fn density(&self) -> [f64; 3] {
        self.density
    }

    /// s_k(.; 1): energy units, unit peak (of the 1993 set to 2e-4, as its printed coefficients
    /// have it).
    pub(crate) fn unbleached(&self, cone: usize) -> &Curve {
        &self.unbleached[cone]
    }

    /// s_k(.; p): the bleached fundamental, divided by the peak of the unbleached one.
    pub(crate) fn depleted(&self, cone: usize, p: f64) -> Curve {
        if p == 1.0 { self.unbleached[cone].clone() } else { self.per_pigment(cone, p).scaled(p) }
    }

    /// s_k(.; p) / p, which has a limit in an eye without pigment: H of [`crate::vision`].
    pub(crate) fn per_pigment(&self, cone: usize, p: f64) -> Curve {
        if p == 1.0 {
            return self.unbleached[cone].clone();
        }
        let d = self.density[cone];
        let ratio =
            |a: f64| absorptance_per_pigment(d * a, p) / absorptance_per_pigment(d * a, 1.0);
        Curve(
            self.unbleached[cone]
                .0
                .iter()
                .zip(&self.absorbance[cone].0)
                .map(|(s, &a)| s * ratio(a))
                .collect(),
        )
    }

    /// Largest value of s_k(.; p) / p, relative to that at p = 1: divides a catch in the `narrowed`
    /// reading.
    pub(crate) fn peak_per_pigment(&self, cone: usize, p: f64) -> f64 {
        self.per_pigment(cone, p).peak() / self.unbleached[cone].peak()
    }
}

/// (1 - 10^(-d p)) / p, with its limit d ln 10 at p = 0.
fn absorptance_per_pigment(d: f64, p: f64) -> f64 {
    let x = d * std::f64::consts::LN_10;
    if p * x == 0.0 { x } else { -(-x * p).exp_m1() / p }
}

/// A column of the CIE parts as a curve.
fn piece(column: &str, f: impl Fn(f64) -> f64) -> Curve {
    Curve(CONE_PIECES.column(column).iter().map(|&v| f(v)).collect())
}

/// Density of the lens of a 32-year-old (CIE 170-1:2006).
pub(crate) fn lens_density() -> Curve {
    piece("lens_density", |d| d)
}

fn from_parts(absorbance: &Curve, density: f64, field: Field) -> Curve {
    let macula = match field {
        Field::TenDegrees => MACULA_PEAK.1 / MACULA_PEAK.0,
        Field::TwoDegrees => 1.0,
    };
    let filter: Vec<f64> = lens_density()
        .0
        .iter()
        .zip(CONE_PIECES.column("macular_density"))
        .map(|(lens, mac)| 10f64.powf(-(lens + macula * mac)))
        .collect();
    let quanta = absorbance
        .0
        .iter()
        .zip(filter)
        .map(|(&a, t)| absorptance_per_pigment(density * a, 1.0) * t);
    let energy = Curve(quanta.zip(Curve::wavelengths()).map(|(q, nm)| q * nm).collect());
    energy.scaled(1.0 / energy.peak())
}

fn smj() -> [Curve; 3] {
    let tristimulus = |nm: f64| ["x10", "y10", "z10"].map(|c| CIE1964.interpolated(c, nm));
    [0, 1, 2].map(|cone| {
        Curve::sampled(|nm| {
            let (from, slope, offset) = SMJ_S_TAIL;
            if cone == 2 && nm > from {
                return 10f64.powf(slope / nm - offset);
            }
            let row = SMJ_FROM_XYZ10[cone];
            tristimulus(nm).iter().zip(row).map(|(t, m)| t * m).sum::<f64>().max(0.0)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standard() -> Fundamentals {
        Fundamentals::new(Set::Cie2006, Field::TenDegrees, [0.38, 0.38, 0.30])
    }

    #[test]
    fn a_cone_without_pigment_has_a_limit_sensitivity_per_pigment() {
        let eye = standard();
        for cone in 0..3 {
            let near = eye.per_pigment(cone, 1e-9);
            for (limit, v) in eye.per_pigment(cone, 0.0).0.iter().zip(&near.0) {
                assert!((limit - v).abs() < 1e-8);
            }
        }
    }
}
