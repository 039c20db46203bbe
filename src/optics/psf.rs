//! Point spread functions of the eye, as published: light per steradian at an angle from a point,
//! for one unit of its light.
//!
//! Each is a sum of terms in the angle theta, and each term a mixture of Gaussians with positive
//! weights (with lambda = 1/(2 sigma^2)):
//!
//! ```text
//! b (1 + (theta/c)^2)^(-n/2)   int dln(sigma)  2 b (lambda c^2)^(n/2) e^(-lambda c^2) / Gamma(n/2)      e^(-lambda theta^2)
//! k (theta + s)^(-n)           int dln(sigma)  2^(n+1) k lambda^(n/2) I_n(s sqrt lambda) / (sqrt pi Gamma(n))      "
//!                              I_n(z) = int_0^inf y^n e^(-y^2 - 2 z y) dy
//! ```
//!
//! The first is the Gamma integral. The second follows from the Laplace transform of e^(-x sqrt u)
//! in u = theta^2.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

use crate::step::special::erfcx;

/// A point spread function by name: the angles where its source holds it valid, and the source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Psf {
    /// No scatter.
    #[default]
    None,
    /// 0 to 100 degrees: the total glare equation of CIE 135/1-1999, eq. 8 (Vos & van den Berg),
    /// divided by its norm.
    Cie,
    /// 0.1 to 100 degrees: the general disability glare equation of CIE 146:2002.
    CieGeneral,
    /// 1 to 30 degrees: the age-adjusted Stiles-Holladay equation of CIE 146:2002; at age 0
    /// Holladay's 10/theta^2.
    StilesHolladay,
    /// 0 to 90 degrees: Spencer, Shirley, Zimmerman & Greenberg 1995, photopic. It knows no age.
    Spencer,
    /// 0 to 30 degrees here: IJspeert, van den Berg & Spekreijse 1993 for a pupil of
    /// `IJSPEERT_PUPIL_MM`, with sines of angles as angles.
    Ijspeert,
}

/// Every function by its name in a configuration.
pub(crate) const PSFS: [(&str, Psf); 6] = [
    ("none", Psf::None),
    ("cie", Psf::Cie),
    ("cie-general", Psf::CieGeneral),
    ("stiles-holladay", Psf::StilesHolladay),
    ("spencer", Psf::Spencer),
    ("ijspeert", Psf::Ijspeert),
];

/// The pupil of IJspeert's function, mm: daylight's. From 2 to 6 mm only 4 % of the light crosses
/// 0.1 degrees.
pub(crate) const IJSPEERT_PUPIL_MM: f64 = 3.0;

/// One term; theta in degrees, values in sr^-1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Term {
    /// `height` (1 + (theta/scale)^2)^(-n/2)
    Bell { height: f64, scale: f64, n: i32 },
    /// `factor` (theta + offset)^(-n)
    Power { factor: f64, offset: f64, n: i32 },
    /// `height` e^(-(theta/sigma)^2/2): a Gaussian itself, part of no mixture.
    Gaussian { height: f64, sigma: f64 },
}

/// Terms, and what is left besides: `constant` + `quadratic` theta^2.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Formula {
    pub(crate) terms: Vec<Term>,
    pub(crate) constant: f64,
    pub(crate) quadratic: f64,
}

/// Gamma(n/2) for n = 1, 2, 3.
fn gamma_half(n: i32) -> f64 {
    match n {
        1 => PI.sqrt(),
        2 => 1.0,
        _ => 0.5 * PI.sqrt(),
    }
}

/// I_n(z) of the head of this file, by parts: 2 I_n + 2 z I_(n-1) = (n-1) I_(n-2).
fn tail_integral(n: i32, z: f64) -> f64 {
    let zeroth = 0.5 * PI.sqrt() * erfcx(z);
    let first = 0.5 - z * zeroth;
    match n {
        1 => first,
        2 => 0.5 * zeroth - z * first,
        _ => first - z * (0.5 * zeroth - z * first),
    }
}

impl Term {
    /// The term at an angle.
    fn at(&self, theta: f64) -> f64 {
        match *self {
            Term::Bell { height, scale, n } => {
                height * (1.0 + (theta / scale).powi(2)).powf(-0.5 * f64::from(n))
            }
            Term::Power { factor, offset, n } => factor * (theta + offset).powi(-n),
            Term::Gaussian { height, sigma } => height * (-0.5 * (theta / sigma).powi(2)).exp(),
        }
    }

    /// Height of the mixture's Gaussians of this sigma, degrees, per unit of ln sigma.
    fn mixture(&self, sigma: f64) -> f64 {
        let lambda = 0.5 / (sigma * sigma);
        match *self {
            Term::Bell { height, scale, n } => {
                let tau = lambda * scale * scale;
                2.0 * height * tau.powf(0.5 * f64::from(n)) * (-tau).exp() / gamma_half(n)
            }
            Term::Power { factor, offset, n } => {
                // Gamma(n) is (n - 1)! and n at most 3.
                let norm = 2f64.powi(n + 1) / (PI.sqrt() * f64::from((n - 1).max(1)));
                norm * factor
                    * lambda.powf(0.5 * f64::from(n))
                    * tail_integral(n, offset * lambda.sqrt())
            }
            Term::Gaussian { .. } => 0.0,
        }
    }
}

impl Formula {
    /// The function at an angle, degrees: sr^-1.
    pub(super) fn at(&self, theta: f64) -> f64 {
        self.terms.iter().map(|term| term.at(theta)).sum::<f64>()
            + self.constant
            + self.quadratic * theta * theta
    }

    /// Height of the mixture's Gaussians of this sigma, degrees, per unit of ln sigma: sr^-1.
    pub(super) fn mixture(&self, sigma: f64) -> f64 {
        self.terms.iter().map(|term| term.mixture(sigma)).sum()
    }
}

impl Psf {
    /// The function of a person: age in years, pigmentation of the eye from 0, very dark, to 1.2,
    /// light blue.
    pub(super) fn formula(self, age: f64, pigmentation: f64) -> Formula {
        match self {
            Psf::None => Formula::default(),
            Psf::Cie => cie(age, pigmentation),
            Psf::CieGeneral => cie_general(age, pigmentation),
            Psf::StilesHolladay => {
                let factor = 10.0 * (1.0 + (age / 70.0).powi(4));
                Formula {
                    terms: vec![Term::Power { factor, offset: 0.0, n: 2 }],
                    ..Formula::default()
                }
            }
            Psf::Spencer => spencer(),
            Psf::Ijspeert => ijspeert(age, pigmentation),
        }
    }
}

fn cie(age: f64, pigmentation: f64) -> Formula {
    let (a, p) = ((age / 70.0).powi(4), pigmentation);
    let norm = 1.0 + p * (0.0417 + 0.055 * a);
    let (core, scatter) = ((1.0 - 0.08 * a) / norm, (1.0 + 1.6 * a) / norm);
    let bell = |height, scale, n| Term::Bell { height, scale, n };
    Formula {
        terms: vec![
            bell(9.2e6 * core, 0.0046, 3),
            bell(1.5e5 * core, 0.045, 3),
            bell(400.0 * scatter, 0.1, 2),
            bell(1300.0 * p * scatter, 0.1, 3),
            bell(0.8 * p * scatter, 0.1, 1),
        ],
        constant: 2.5e-3 * p / norm,
        quadratic: 3e-8 * scatter,
    }
}

fn cie_general(age: f64, pigmentation: f64) -> Formula {
    let older = 1.0 + (age / 62.5).powi(4);
    let power = |factor, n| Term::Power { factor, offset: 0.0, n };
    let terms = vec![power(10.0, 3), power(5.0 * older, 2), power(0.1 * pigmentation * older, 1)];
    Formula { terms, constant: 0.0025 * pigmentation, quadratic: 0.0 }
}

/// f0, f1 and f2 with their photopic weights; f3, the lenticular halo, has weight 0 by day.
fn spencer() -> Formula {
    let terms = vec![
        Term::Gaussian { height: 0.384 * 2.61e6, sigma: 0.02 / 2f64.sqrt() },
        Term::Power { factor: 0.478 * 20.91, offset: 0.02, n: 3 },
        Term::Power { factor: 0.138 * 72.37, offset: 0.02, n: 2 },
    ];
    Formula { terms, ..Formula::default() }
}

/// IJspeert's four terms: weights, and angles in radians.
pub(super) fn ijspeert_terms(age: f64, pigmentation: f64, pupil_mm: f64) -> [(f64, f64); 4] {
    let (older, m) = (1.0 + (age / 70.0).powi(4), 0.056 + 0.1 * pigmentation);
    let small = 1.0 / (1.0 + older / (1.0 / m - 1.0));
    let large = 1.0 - small;
    let (b, e) = (9000.0 - 936.0 * older.sqrt(), older.sqrt() / 2000.0);
    let (narrow, wide) = (1.0 + (pupil_mm / 3.2).powi(2), 1.0 + (3.2 / pupil_mm).powi(2));
    let third = large / ((1.0 + 25.0 * m) * (1.0 + 1.0 / older));
    [
        (small / narrow, narrow / (b * pupil_mm)),
        (small / wide, wide * (e - 1.0 / (b * pupil_mm))),
        (third, 1.0 / (10.0 + 60.0 * m - 5.0 / older)),
        (large - third, 1.0),
    ]
}

/// c beta/(2 pi (sin^2 + beta^2 cos^2)^1.5) with the sine as the angle; the last, of beta = 1, is
/// constant.
fn ijspeert(age: f64, pigmentation: f64) -> Formula {
    let [bells @ .., (flat, _)] = ijspeert_terms(age, pigmentation, IJSPEERT_PUPIL_MM);
    let bell = |(weight, beta): (f64, f64)| Term::Bell {
        height: weight / (2.0 * PI * beta * beta),
        scale: (beta / (1.0 - beta * beta).sqrt()).to_degrees(),
        n: 3,
    };
    Formula { terms: bells.map(bell).into(), constant: flat / (2.0 * PI), quadratic: 0.0 }
}
