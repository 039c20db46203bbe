//! The observer by number: cone trolands, narrowing, pupil, Stiles-Crawford, colour, Rayleigh
//! matches.

use crate::colour::Primaries;
use crate::error::Result;
use crate::frames::builtin::sun_radiance;
use crate::light::{Planes, Samples};
use crate::observer::{Adapting, CONES, Observer};
use crate::spectrum::{CIE1931, CONE_PIECES, Curve};
use crate::units::{LUMENS_PER_WATT, Millimetres, Nits};
use crate::vision::Vision;

use super::limit::worst;
use super::{Check, PAPER, STANDARD, Subject};

const TEN_DEGREES: &str = "observer.field_deg = 10";

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let standard = subject.observer(STANDARD)?;
    let wide = subject.observer(TEN_DEGREES)?;
    let mut checks = cone_trolands(&standard, "CIE 2006, 2 deg", [0.97468, 1.19216, 1.93485]);
    checks.extend(cone_trolands(&wide, "CIE 2006, 10 deg", [0.99085, 1.16263, 2.14696]));
    checks.extend(cone_trolands(
        &subject.observer(PAPER)?,
        "SMJ 1993, 10 deg",
        [0.98353, 1.15500, 2.05021],
    ));
    checks.push(rebuilt(&wide));
    checks.extend(photometry(&standard, "2 deg", 646.083, [1.0007, 0.9957, 1.013]));
    checks.extend(photometry(&wide, "10 deg", 610.605, [0.9917, 0.9533, 0.917]));
    checks.extend(narrowing(&wide));
    checks.extend(rayleigh(&standard, "2 deg", &[(0.8, 0.0715), (0.5, 0.183), (0.1, 0.339)]));
    checks.extend(rayleigh(&wide, "10 deg", &[(0.5, 0.1425)]));
    checks.extend(stiles_crawford(subject)?);
    checks.push(watson_yellott(&standard));
    checks.extend(white(subject)?);
    Ok(checks)
}

/// c_k = integral V / integral s_k.
fn cone_trolands(eye: &Observer, set: &str, expected: [f64; 3]) -> Vec<Check> {
    let check = |k: usize| {
        let name = format!("td in {} of one equal-energy td, {set}", CONES[k]);
        // The published digits were made from a table that agrees with its parts to 5.2e-5.
        Check::new(
            name,
            "integral V / integral s",
            eye.cone_troland()[k],
            expected[k],
            6e-5 * expected[k],
        )
    };
    (0..3).map(check).collect()
}

/// The fundamentals, rebuilt from absorbance, lens and macula, beside the published table.
fn rebuilt(eye: &Observer) -> Check {
    let of_cone = |k: usize| {
        let table = CONE_PIECES.column(["l10", "m10", "s10"][k]).iter();
        eye.fundamentals
            .unbleached(k)
            .0
            .iter()
            .zip(table)
            .filter(|(_, t)| t.is_finite())
            .map(|(ours, t)| (ours - t).abs())
    };
    let error = worst((0..3).flat_map(of_cone), 0.0);
    Check::new(
        "fundamentals rebuilt from their parts, worst error",
        "CIE 170-1:2006 table",
        error,
        0.0,
        8e-5,
    )
}

/// K, and what this observer reads of 1 cd/m2 of CIE 1931: equal energy, a 2900 K lamp,
/// the sun half a degree above the horizon.
fn photometry(eye: &Observer, field: &str, k: f64, expected: [f64; 3]) -> Vec<Check> {
    let planck = |nm: f64| 1.0 / (nm.powi(5) * ((1.438_776_9e7 / (nm * 2900.0)).exp() - 1.0));
    let read = |light: Curve| {
        let own = eye.lumens_per_watt * light.times(&eye.luminous_efficiency()).integral();
        let y = Curve::sampled(|nm| CIE1931.interpolated("y", nm));
        own / (LUMENS_PER_WATT * light.times(&y).integral())
    };
    let low_sun = |nm: f64| sun_radiance(nm, 0.5, 2.5);
    let lights = [
        ("equal energy", Curve::sampled(|_| 1.0)),
        ("a 2900 K lamp", Curve::sampled(planck)),
        ("the low sun", Curve::sampled(low_sun)),
    ];
    let mut checks = vec![Check::new(
        format!("K, lm/W, {field}"),
        "683.002 Y_1931(D65)/Y_own(D65)",
        eye.lumens_per_watt,
        k,
        2e-3,
    )];
    for ((name, light), expected) in lights.into_iter().zip(expected) {
        let name = format!("1 cd/m2 of {name} reads, {field}");
        checks.push(Check::new(name, "CIE 170-2:2015 by CIE 1931", read(light), expected, 1e-3));
    }
    checks
}

/// Peaks and widths of bleached fundamentals, both readings.
fn narrowing(eye: &Observer) -> Vec<Check> {
    let expected = [
        (1.0, [1.0, 1.0, 1.0], [113.07, 93.70, 52.71]),
        (0.5, [0.6029, 0.6036, 0.5622], [106.90, 87.78, 51.99]),
        (0.1, [0.1418, 0.1420, 0.1247], [101.88, 83.04, 51.25]),
    ];
    let mut checks = Vec::new();
    for (p, peaks, widths) in expected {
        for k in 0..3 {
            let curve = eye.fundamentals.depleted(k, p);
            let name = |what: &str| format!("{what} of {} at p = {p}", CONES[k]);
            checks.push(Check::new(name("peak"), "1 - 10^(-D p a)", curve.peak(), peaks[k], 6e-5));
            let width = curve.peak_and_width().1;
            checks.push(Check::new(
                name("width at half height, nm,"),
                "1 - 10^(-D p a)",
                width,
                widths[k],
                0.006,
            ));
        }
    }
    checks
}

/// How far a match of 546 + 650 nm to 589.6 nm moves when L and M are bleached to p: the change of
/// log10(R/G).
fn rayleigh(eye: &Observer, field: &str, expected: &[(f64, f64)]) -> Vec<Check> {
    let at = |curve: &Curve, nm: f64| {
        let (below, part) = (nm.floor(), nm.fract());
        curve.at(below as usize) * (1.0 - part) + curve.at(below as usize + 1) * part
    };
    let log_ratio = |p: f64| {
        let [l, m] = [0, 1].map(|k| eye.fundamentals.depleted(k, p));
        let [red, green, yellow] = [650.0, 546.0, 589.6].map(|nm| [at(&l, nm), at(&m, nm)]);
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        (cross(yellow, green) / cross(red, yellow)).log10()
    };
    let unbleached = log_ratio(1.0);
    let check = |&(p, shift): &(f64, f64)| {
        let name = format!("Rayleigh match, log10(R/G) moved at p = {p}, {field}");
        Check::new(name, "546 + 650 nm on 589.6 nm", log_ratio(p) - unbleached, shift, 5e-4)
    };
    expected.iter().map(check).collect()
}

/// The pupil's mean weight for p = 0.05 mm^-2: (1 - 10^(-p R^2))/(p R^2 ln 10).
fn stiles_crawford(subject: &Subject) -> Result<Vec<Check>> {
    let eye = subject
        .observer("observer.stiles_crawford = \"pupil\"\nobserver.stiles_crawford_p = 0.05")?;
    let check = |(d, eta): (f64, f64)| {
        let ours = eye.equal_energy_weight(Millimetres(d), Millimetres(0.0))[0];
        Check::new(
            format!("Stiles-Crawford mean of a {d} mm pupil, p = 0.05"),
            "Stiles & Crawford 1933",
            ours,
            eta,
            5e-5,
        )
    };
    Ok([(2.0, 0.9446), (5.0, 0.7130), (8.0, 0.4568)].map(check).into())
}

/// 10 000 cd/m2 over 36 deg2 in the dark: F/846 = 425.5, f = 11.97; D = 7.75 - 5.75 f/(f + 2) =
/// 2.821; then the age of 32.
fn watson_yellott(eye: &Observer) -> Check {
    let light =
        Adapting { fovea: Nits(1e4), picture: Nits(1e4), area_deg2: 36.0, surround: Nits(0.0) };
    let d = eye.pupil.diameter(light).0;
    Check::new(
        "unified pupil, mm, 1e4 cd/m2 over 36 deg2, age 32",
        "Watson & Yellott 2012",
        d,
        2.80415466226,
        1e-9,
    )
}

/// RGB (1, 1, 1) of 1 cd/m2: its cone trolands per mm2 of pupil.
fn white(subject: &Subject) -> Result<Vec<Check>> {
    let eye = subject.observer("observer.stiles_crawford = \"off\"")?;
    let Some(vision) = Vision::of_rgb(eye, &Primaries::REC709, Nits(1.0)) else {
        return Ok(Vec::new());
    };
    let pixel = Planes { width: 1, height: 1, count: 3, samples: Samples::Float(vec![1.0; 3]) };
    let weights = vision.illuminance_weights(Millimetres(2.0), Millimetres(0.0));
    let td = vision
        .illuminance(&vision.moments(&pixel, 0, 0), &weights)
        .map(|td| td / std::f64::consts::PI);
    let expected = [0.98632, 1.03315, 1.07541];
    let check = |k: usize| {
        let name = format!("{} td of sRGB white, per td", CONES[k]);
        Check::new(name, "Mallett & Yuksel 2019, D65", td[k], expected[k], 6e-5)
    };
    Ok((0..3).map(check).collect())
}
