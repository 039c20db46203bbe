//! The standard observer over time, against the anchors of the model: Psychtoolbox-like segment
//! sequences, the chromaticity track of the half-degree sun, and the steady-state limit.

use sungaze::colour::{apply, chromaticity};
use sungaze::constants;
use sungaze::kinetics::Kinetics;
use sungaze::observer::{Directional, Observer, Reading, Steepness};
use sungaze::spectrum::{Curve, SOLAR};
use sungaze::step::advance;
use sungaze::units::{Millimetres, Seconds, Trolands};

const OZONE: [(f64, f64); 9] = [
    (450.0, 0.003),
    (500.0, 0.021),
    (550.0, 0.063),
    (575.0, 0.115),
    (600.0, 0.125),
    (625.0, 0.085),
    (650.0, 0.062),
    (680.0, 0.036),
    (700.0, 0.021),
];

/// Mean radiance of the sun's disc half a degree up, turbidity 2.5, written out anew from its
/// published formula.
fn half_degree_sun() -> Curve {
    let h: f64 = 0.5;
    let mass = 1.0 / (h.to_radians().sin() + 0.50572 * (h + 6.07995).powf(-1.6364));
    let ozone = |nm: f64| {
        let pair = OZONE.windows(2).find(|p| p[0].0 <= nm && nm <= p[1].0);
        pair.map_or(0.0, |p| p[0].1 + (p[1].1 - p[0].1) * (nm - p[0].0) / (p[1].0 - p[0].0))
    };
    Curve::sampled(|nm| {
        let l = nm / 1000.0;
        let depth =
            0.008735 * l.powf(-4.08) + (0.0461 * 2.5 - 0.0459) * l.powf(-1.3) + 0.35 * ozone(nm);
        SOLAR.interpolated("irradiance", nm) / 6.807e-5 * (-mass * depth).exp()
    })
}

fn standard_pigments() -> [Kinetics; 3] {
    let set = constants::named("standard").unwrap();
    [0, 1, 2].map(|k| {
        Kinetics::first_order(
            Trolands(10f64.powf(set.half_bleach_log_td[k])),
            Seconds(set.tau_s[k]),
        )
    })
}

fn observer_without_directional_effect() -> Observer {
    let mut eye = Observer::standard();
    eye.directional = Directional::new(Reading::Off, Steepness::Measured);
    eye
}

#[test]
fn the_low_sun_turns_from_red_through_yellow_to_green_and_pales() {
    let (eye, sun, pigments) =
        (observer_without_directional_effect(), half_degree_sun(), standard_pigments());
    let td = eye.illuminance(&sun, Millimetres(2.0), Millimetres(0.0));
    let seen_after = |t: f64| {
        let p = [0, 1, 2].map(|k| advance(&pigments[k], 1.0, td[k], Seconds(t), 1));
        (p, apply(&eye.lms_to_xyz, eye.catch(&sun, p)))
    };
    let published = [
        (0.0, 0.621, 0.373),
        (0.3, 0.599, 0.392),
        (1.0, 0.521, 0.462),
        (2.0, 0.271, 0.672),
        (30.0, 0.308, 0.291),
    ];
    for (t, x, y) in published {
        let [ours_x, ours_y] = chromaticity(seen_after(t).1);
        assert!(
            (ours_x - x).abs() < 0.005 && (ours_y - y).abs() < 0.005,
            "{t} s: {ours_x} {ours_y}"
        );
    }
    for t in [3.0, 5.0, 8.0] {
        let [x, y] = chromaticity(seen_after(t).1);
        assert!(
            x < 0.0 || y > 0.8 || x + y > 1.0 || outside_the_spectrum_locus(x, y),
            "{t} s: {x} {y}"
        );
    }
    let (p, _) = seen_after(1.0);
    assert!((p[0] - 0.357).abs() < 0.002 && (p[1] - 0.610).abs() < 0.002, "{p:?}");
}

/// Left of the straight line from 500 nm to 480 nm of the CIE diagram: bluer-green than any light.
fn outside_the_spectrum_locus(x: f64, y: f64) -> bool {
    x < 0.0082 + (0.5384 - y).max(0.0) * 0.2 && y > 0.13
}

#[test]
fn held_light_ends_in_the_steady_state_of_the_paper_from_any_start() {
    for pigment in standard_pigments() {
        for td in [0.0, 1.0, 1e3, 2e4, 1e6, 1e10] {
            let s = td / pigment.half_bleach.0;
            let settled = 30.0 * pigment.tau.0 / (1.0 + s);
            for start in [0.0, 0.3, 1.0] {
                let p = advance(&pigment, start, Trolands(td), Seconds(settled), 1);
                assert!((p - 1.0 / (1.0 + s)).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_tracked_percept_ends_in_the_steady_one() {
    let (eye, sun, pigments) = (Observer::standard(), half_degree_sun(), standard_pigments());
    let td = eye.illuminance(&sun, Millimetres(2.5), Millimetres(0.0));
    let steady = [0, 1, 2].map(|k| pigments[k].steady(td[k]));
    let tracked = [0, 1, 2].map(|k| {
        // Thirty time constants of the slowest cone, in uneven frames.
        [1000.0, 0.04, 3000.0]
            .iter()
            .fold(1.0, |p, &h| advance(&pigments[k], p, td[k], Seconds(h), 1))
    });
    let unbleached = eye.catch(&sun, [1.0; 3]);
    let (a, b) = (eye.catch(&sun, steady), eye.catch(&sun, tracked));
    for k in 0..3 {
        assert!((a[k] - b[k]).abs() < 1e-12 * unbleached[k]);
    }
}

#[test]
fn cone_pigment_is_back_after_eight_minutes() {
    let pigment = standard_pigments()[0];
    let p = advance(&pigment, 0.0, Trolands(0.0), Seconds(480.0), 1);
    assert!((0.98..0.985).contains(&p));
}
