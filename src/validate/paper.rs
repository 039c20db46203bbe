//! The paper's Eq. 1 to 7 and its Table 1, each by number. Every expected value is worked out
//! beside its check from the printed formula; the constants it takes stand in the comment.

use crate::error::Result;
use crate::observer::{Adapting, Observer, Rule, pupil};
use crate::spectrum::Curve;
use crate::units::{Millimetres, Nits, Trolands};

use super::{Check, PAPER, STANDARD, Subject};

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let mut checks = table_1(subject)?;
    checks.extend(equations_1_to_4(subject)?);
    checks.extend(equations_5_to_7(subject)?);
    Ok(checks)
}

/// B = 1/2 at the published half-bleach lights.
fn table_1(subject: &Subject) -> Result<Vec<Check>> {
    let half = |name: &str, pigment: &crate::kinetics::Kinetics, log_td: f64| {
        let bleached = 1.0 - pigment.steady(Trolands(10f64.powf(log_td)));
        Check::new(format!("bleached at 10^{log_td} td: {name}"), "Table 1", bleached, 0.5, 1e-12)
    };
    let [l, m, _] = subject.pigments(PAPER)?;
    let mixture = subject.pigments("observer.constants = \"mixture\"")?;
    let limited =
        subject.pigments("observer.constants = \"van-hateren-snippe\"")?[0].half_bleach_light().0;
    // Q/tau (1 + Km)/(0.5 + Km) = 829268/150 * 1.2/0.7
    let of_limited = "half-bleach light, td, rate-limited set van-hateren-snippe";
    Ok(vec![
        half("rods, scotopic", &subject.rods, 4.4),
        half("L+M cones, set mixture", &mixture[0], 4.3),
        half("L cones, set paper", &l, 3.89),
        half("M cones, set paper", &m, 3.89),
        half("L cones, set standard", &subject.pigments(STANDARD)?[0], 4.3),
        Check::new(of_limited, "van Hateren & Snippe 2007", limited, 9477.349, 0.1),
    ])
}

fn equations_1_to_4(subject: &Subject) -> Result<Vec<Check>> {
    let [l, _, _] = subject.pigments(PAPER)?;
    let bleached = 1.0 - l.steady(Trolands(1e4));
    // 10^4/(10^4 + 10^3.89) = 10000/17762.471166
    let name = "Eq. 1: B at 1e4 td, I0 = 10^3.89";
    let mut checks = vec![Check::new(name, "paper Eq. 1", bleached, 0.562984728104, 1e-12)];
    // pi 4^2/4 * 100
    let (name, td) = ("Eq. 2: td of 100 cd/m2, 4 mm", 100.0 * pupil::area(Millimetres(4.0)));
    checks.push(Check::new(name, "paper Eq. 2", td, 1256.63706143592, 1e-9));
    checks.extend(equations_3_and_4(subject.observer(PAPER)?.pupil));
    Ok(checks)
}

/// Pupils at 100 cd/m2. `printed`: the rule of the paper's observer.
fn equations_3_and_4(printed: Rule) -> impl Iterator<Item = Check> {
    let light =
        Adapting { fovea: Nits(100.0), picture: Nits(100.0), area_deg2: 36.0, surround: Nits(0.0) };
    let pupils = [
        // 4.9 - 3 tanh(0.4 (2 + 1)) = 4.9 - 3 * 0.833654607
        ("Eq. 3: mm, as printed", "paper Eq. 3", printed, 2.39903617896),
        // 4.9 - 3 tanh(0.4 * 2) = 4.9 - 3 * 0.664036770
        ("Moon & Spencer for cd/m2: mm", "Moon & Spencer 1944", Rule::MoonSpencer, 2.90788968920),
        // log10 d = 0.8558 - 4.01e-4 * 10.6^3 = 0.378202584
        ("Eq. 4: mm, as printed", "paper Eq. 4", Rule::DeGrootGebhardAsPrinted, 2.38892537766),
        // log10 d = 0.8558 - 4.01e-4 * 9.6^3 = 0.501020864
        (
            "de Groot & Gebhard for cd/m2: mm",
            "de Groot & Gebhard 1952",
            Rule::DeGrootGebhard,
            3.16971973632,
        ),
    ];
    pupils.into_iter().map(move |(name, source, rule, mm)| {
        let name = format!("{name} at 100 cd/m2");
        Check::new(name, source, rule.diameter(light).0, mm, 1e-11)
    })
}

fn equations_5_to_7(subject: &Subject) -> Result<Vec<Check>> {
    let eye = subject.observer(PAPER)?;
    let reading = crate::observer::Reading::Paper { mm_per_degree: 0.29 };
    let eta = crate::observer::directional::eta(reading, 0.05, 8.0, 2.0);
    let at = |r: f64| eye.illuminance(&line(500), Millimetres(8.0), Millimetres(r))[0].0;
    let ten_degrees = 10.0 * eye.directional.mm_per_degree().unwrap_or(f64::NAN);
    let mut checks: Vec<Check> = [
        // 10^(-0.05 * 2^2) = 10^-0.2
        ("Eq. 5: eta at p = 0.05, r = 2 mm", "paper Eq. 5", eta, 0.630957344480, 1e-12),
        // p = 0.0506 + 0.037 * lens density 0.1537 = 0.0562869; 10^(-4 p)
        (
            "Eq. 6: I'/I of 500 nm at r = 2 mm, lens-corrected",
            "paper Eq. 6",
            at(2.0) / at(0.0),
            0.595459735261,
            1e-11,
        ),
        // Ten degrees from the gaze are 2.9 mm in the pupil's plane.
        (
            "mm in the pupil for ten degrees from the gaze",
            "model: 0.29 mm/degree",
            ten_degrees,
            2.9,
            1e-12,
        ),
    ]
    .map(|(name, source, found, expected, within)| {
        Check::new(name, source, found, expected, within)
    })
    .into();
    checks.extend(equation_7(&eye));
    Ok(checks)
}

/// Light of one wavelength, 1 W m^-2 sr^-1.
fn line(nm: usize) -> Curve {
    let mut light = Curve::sampled(|_| 0.0);
    light.0[nm - Curve::FROM] = 1.0;
    light
}

/// 1 W m^-2 sr^-1 at 550 nm through 4 mm: 621.0421 c A s, A = 4 pi mm2, x10 y10 z10 = .529826
/// .991761 .003988.
fn equation_7(eye: &Observer) -> Vec<Check> {
    let trolands = eye.illuminance(&line(550), Millimetres(4.0), Millimetres(0.0));
    // c s = .98353 * .944557895, 1.15500 * .968920174, 2.05021 * .001564621 (S by its exponential
    // beyond 520 nm).
    let expected = [7250.1519, 8733.7528, 25.034467];
    let of_cone = |k: usize| {
        let name =
            format!("Eq. 7: {} td of 1 W m^-2 sr^-1 at 550 nm, 4 mm", crate::observer::CONES[k]);
        // c_k of the model has five digits.
        let within = 6e-5 * expected[k];
        Check::new(name, "paper Eq. 7, SMJ 1993", trolands[k].0, expected[k], within)
    };
    (0..3).map(of_cone).collect()
}
