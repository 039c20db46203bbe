//! Numbers that others published, or that follow from what they published.

use crate::colour::{apply, chromaticity};
use crate::error::Result;
use crate::frames::builtin::sun_radiance;
use crate::kinetics::Kinetics;
use crate::observer::{CONES, pupil};
use crate::spectrum::Curve;
use crate::step::{METHODS, advance};
use crate::units::{Millimetres, Seconds, Trolands};

use super::{Check, STANDARD, Subject};

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let eye = subject.pigments(STANDARD)?[0];
    let mut checks = psychtoolbox(&eye);
    checks.extend(looks(&eye));
    checks.extend(flash_train(&eye));
    checks.push(Check::new(
        "cone pigment back after 8 minutes",
        "Rushton & Henry 1968",
        look(&eye, 0.0, 0.0, 480.0),
        0.98,
        2e-3,
    ));
    checks.extend(half_degree_sun(subject)?);
    checks.extend(spread(subject)?);
    Ok(checks)
}

fn look(eye: &Kinetics, p: f64, light: f64, seconds: f64) -> f64 {
    advance(eye, p, Trolands(light), Seconds(seconds), 1)
}

/// 1e5 td from rest: the solution, and the 1-second Euler steps of ComputePhotopigmentBleaching.
fn psychtoolbox(eye: &Kinetics) -> Vec<Check> {
    let source = "Psychtoolbox, Boynton";
    let exact =
        [(1.0, 0.0407367), (10.0, 0.3285206), (60.0, 0.7924025)].map(|(seconds, bleached)| {
            let name = format!("bleached after {seconds} s of 1e5 td");
            Check::new(name, source, 1.0 - look(eye, 1.0, 1e5, seconds), bleached, 1e-7)
        });
    let euler = METHODS.iter().find(|method| method.name == "forward-euler").unwrap_or(&METHODS[0]);
    let stepped = [(1, 0.0417656), (10, 0.3350376), (60, 0.7954951)].map(|(seconds, bleached)| {
        let p = (0..seconds).fold(1.0, |p, _| euler.hold(eye, p, Trolands(1e5), Seconds(1.0), 1));
        Check::new(
            format!("the same by {seconds} Euler steps of 1 s"),
            source,
            1.0 - p,
            bleached,
            1e-7,
        )
    });
    [exact, stepped].concat()
}

/// One look after another, from rest.
fn looks(eye: &Kinetics) -> Vec<Check> {
    let looks = [
        (5.0, 1e6, 0.1360810643),
        (60.0, 0.0, 0.4760066780),
        (2.0, 1e5, 0.4464823240),
        (30.0, 0.0, 0.5689200005),
        (0.5, 1e8, 0.0001994869),
        (300.0, 0.0, 0.9179313763),
        (1000.0, 2e4, 0.4994071108),
    ];
    let mut p = 1.0;
    let check = |(seconds, light, expected): (f64, f64, f64)| {
        p = look(eye, p, light, seconds);
        Check::new(
            format!("a sequence of looks: p after {seconds} s at {light:e} td"),
            "closed form",
            p,
            expected,
            1e-9,
        )
    };
    looks.map(check).into()
}

/// 13 trials of 18 s, light from 4 s for 0.999 s: bleached at the end of flashes.
fn flash_train(eye: &Kinetics) -> Vec<Check> {
    let published = [
        (1, 0.336527066),
        (2, 0.528324619),
        (3, 0.637636188),
        (5, 0.735443211),
        (10, 0.779667866),
        (13, 0.781973571),
    ];
    let mut checks = Vec::new();
    let mut p = 1.0;
    for trial in 1..=13 {
        p = look(eye, look(eye, p, 0.0, 4.0), 988_015.968_6, 0.999);
        if let Some((_, bleached)) = published.iter().find(|(n, _)| *n == trial) {
            let name = format!("flash train: bleached after flash {trial}");
            checks.push(Check::new(name, "Cooper et al. 2020", 1.0 - p, *bleached, 1e-9));
        }
        p = look(eye, p, 0.0, 18.0 - 4.999);
    }
    checks
}

/// The sun half a degree up, stared at through a 2 mm pupil without Stiles-Crawford: the
/// chromaticity of the percept.
fn half_degree_sun(subject: &Subject) -> Result<Vec<Check>> {
    let config = subject.config("observer.stiles_crawford = \"off\"")?;
    let (eye, pigments) = (config.observer(), config.pigments());
    let radiance = Curve::sampled(|nm| sun_radiance(nm, 0.5, 2.5));
    let td = eye.illuminance(&radiance, Millimetres(pupil::SMALLEST.0), Millimetres(0.0));
    let unbleached =
        |t: f64| [0, 1, 2].map(|k: usize| advance(&pigments[k], 1.0, td[k], Seconds(t), 64));
    // t, p of L, M, S, x and y, Y: CIE 2006, 2 degrees.
    let seen = [
        (0.0, [1.0, 1.0, 1.0], [0.6207, 0.3726], 657_935.0),
        (0.3, [0.7382, 0.8608, 0.9991], [0.6005, 0.3908], 527_620.0),
        (1.0, [0.3653, 0.6080, 0.9970], [0.5268, 0.4558], 307_530.0),
        (2.0, [0.1367, 0.3722, 0.9940], [0.2966, 0.6498], 141_660.0),
        (10.0, [0.0082, 0.0225, 0.9712], [0.1964, 0.3547], 9_053.0),
        (30.0, [0.0082, 0.0164, 0.9227], [0.3074, 0.2957], 8_139.0),
    ];
    let source = "T = 2.5, 2 mm pupil, 2 deg";
    let mut checks = Vec::new();
    for (t, expected_p, [x, y], luminance) in seen {
        let p = unbleached(t);
        let xyz = apply(&eye.lms_to_xyz, eye.catch(&radiance, p));
        let [ours_x, ours_y] = chromaticity(xyz);
        let mut row = |what: String, ours, expected, tolerance| {
            let name = format!("half-degree sun, {what} after {t} s");
            checks.push(Check::new(name, source, ours, expected, tolerance));
        };
        (0..3).for_each(|k| row(format!("p of {}", CONES[k]), p[k], expected_p[k], 1e-4));
        row("x".into(), ours_x, x, 2e-3);
        row("y".into(), ours_y, y, 2e-3);
        row("Y".into(), xyz[1], luminance, 2e-3 * luminance);
    }
    Ok(checks)
}

/// How far published half-bleach lights move the steady state: (sqrt r - 1)/(sqrt r + 1) for a
/// ratio r.
fn spread(subject: &Subject) -> Result<[Check; 2]> {
    let pigment = |set: &str| Ok(subject.pigments(&format!("observer.constants = {set:?}"))?[0]);
    let (paper, standard, widest) =
        (pigment("paper")?, pigment("standard")?, pigment("wyszecki-stiles")?);
    let moved = |a: &Kinetics, b: &Kinetics| {
        let lights = (0..=600).map(|i| Trolands(10f64.powf(f64::from(i) / 60.0)));
        lights.map(|light| (a.steady(light) - b.steady(light)).abs()).fold(0.0, f64::max)
    };
    let source = "spread of published I0";
    Ok([
        Check::new(
            "steady p, most that 10^3.89 and 10^4.3 td differ",
            source,
            moved(&paper, &standard),
            0.232,
            1e-3,
        ),
        Check::new(
            "steady p, most that 10^3.89 and 38 462 td differ",
            source,
            moved(&paper, &widest),
            0.380,
            1e-3,
        ),
    ])
}
