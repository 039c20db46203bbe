//! Where praised methods fail on the bleaching of an eye. Standard constants: 2e4 td, 120 s; 24
//! frames a second.

use std::f64::consts::{FRAC_1_SQRT_2, LN_10};
use sungaze::kinetics::{Kinetics, Law};
use sungaze::step::{
    Drive, Implicit, Method, Rosenbrock, collocate, dormand_prince, linearly_implicit, relax,
};
use sungaze::units::{Seconds, Trolands};

const FRAME: Seconds = Seconds(1.0 / 24.0);
const SUN: f64 = 1e10;
const DARK: Drive = Drive::Held(Trolands(0.0));

fn eye() -> Kinetics {
    Kinetics::first_order(Trolands(2e4), Seconds(120.0))
}

fn other(law: Law) -> Kinetics {
    Kinetics { law, ..eye() }
}

fn step(name: &str, p: f64, drive: Drive, dt: Seconds) -> f64 {
    (Method::named(name).expect("a row of the table").step)(&eye(), p, drive, dt)
}

fn held(light: f64) -> Drive {
    Drive::Held(Trolands(light))
}

fn ramp(from: f64, to: f64) -> Drive {
    Drive::Ramp { from: Trolands(from), to: Trolands(to) }
}

/// Within half of the last digit that was published.
fn assert_close(found: f64, expected: f64, digits: i32) {
    let tolerance = 0.5 * 10f64.powi(expected.abs().log10().floor() as i32 + 1 - digits);
    assert!((found - expected).abs() <= tolerance * 1.0001, "found {found}, expected {expected}");
}

/// Times that p grows by over the step: its answer to one more unit of pigment at the start.
fn amplification(step: impl Fn(f64) -> f64) -> f64 {
    step(1.0) - step(0.0)
}

const SDIRK2: Implicit<2> = Implicit {
    a: [[1.0 - FRAC_1_SQRT_2, 0.0], [FRAC_1_SQRT_2, 1.0 - FRAC_1_SQRT_2]],
    b: [FRAC_1_SQRT_2, 1.0 - FRAC_1_SQRT_2],
    c: [1.0 - FRAC_1_SQRT_2, 1.0],
};

const LINEARLY_IMPLICIT_EULER: Rosenbrock<1> =
    Rosenbrock { gamma: 1.0, a: [[0.0]], c: [[0.0]], alpha: [0.0], gammas: [1.0], m: [1.0] };

/// Lang & Verwer 2001.
fn ros3p() -> Rosenbrock<3> {
    let gamma = 0.5 + 3f64.sqrt() / 6.0;
    let inverse = 1.0 / gamma;
    let middle = -inverse * (2.0 - 0.5 * inverse);
    let last = inverse * (2.0 / 3.0 - inverse / 6.0);
    Rosenbrock {
        gamma,
        a: [[0.0; 3], [inverse, 0.0, 0.0], [inverse, 0.0, 0.0]],
        c: [[0.0; 3], [-inverse * inverse, 0.0, 0.0], [-inverse * (1.0 - middle), middle, 0.0]],
        alpha: [0.0, 1.0, 1.0],
        gammas: [gamma, gamma - 1.0, 0.5 - 2.0 * gamma],
        m: [inverse * (1.0 + last), last, inverse / 3.0],
    }
}

/// Sandu et al. 1997.
const RODAS3: Rosenbrock<4> = Rosenbrock {
    gamma: 0.5,
    a: [[0.0; 4], [0.0; 4], [2.0, 0.0, 0.0, 0.0], [2.0, 0.0, 1.0, 0.0]],
    c: [[0.0; 4], [4.0, 0.0, 0.0, 0.0], [1.0, -1.0, 0.0, 0.0], [1.0, -1.0, -8.0 / 3.0, 0.0]],
    alpha: [0.0, 0.0, 1.0, 1.0],
    gammas: [0.5, 1.5, 0.0, 0.0],
    m: [2.0, 0.0, 1.0, 1.0],
};

#[test]
fn a_glance_at_the_sun_blows_up_forward_euler() {
    assert_close(step("forward-euler", 1.0, held(SUN), FRAME), -172.611, 6);
    assert_close(step("exact", 1.0, held(SUN), FRAME), 2.000e-6, 4);
}

#[test]
fn a_glance_at_the_sun_blows_up_heun_and_runge_kutta_without_any_ringing() {
    assert_close(step("heun", 1.0, held(SUN), FRAME), 14897.8, 6);
    assert_close(step("rk4", 1.0, held(SUN), FRAME), 3.69959e7, 6);
}

#[test]
fn a_glance_at_the_sun_leaves_backward_euler_stable_and_2865_times_wrong() {
    let (found, exact) =
        (step("backward-euler", 1.0, held(SUN), FRAME), step("exact", 1.0, held(SUN), FRAME));
    assert_close(found, 5.72899e-3, 6);
    assert_close(found / exact, 2865.0, 4);
    assert_close(step("ros2", 1.0, held(SUN), FRAME), 4.75299e-3, 6);
}

#[test]
fn a_glance_at_the_sun_makes_negative_pigment_of_methods_called_stable() {
    assert_close(step("trapezoid", 1.0, held(SUN), FRAME), -0.977218, 6);
    assert_close(step("tr-bdf2", 1.0, held(SUN), FRAME), -0.0263752, 6);
    assert_close(step("trapezoid", 1.0, held(1e9), FRAME), -0.793368, 6);
    assert_close(step("tr-bdf2", 1.0, held(1e9), FRAME), -0.167185, 6);
    assert_close(step("exact", 1.0, held(1e9), FRAME), 2.00284e-5, 6);
}

#[test]
fn heun_freezes_when_the_step_is_two_time_constants() {
    let p = (0..100).fold(0.0, |p, _| step("heun", p, DARK, Seconds(240.0)));
    assert_eq!(p, 0.0, "R(-2) = 1: no pigment ever comes back");
    let euler = [0, 1, 2].iter().scan(0.0, |p, _| {
        *p = step("forward-euler", *p, DARK, Seconds(240.0));
        Some(*p)
    });
    assert_eq!(euler.collect::<Vec<_>>(), [2.0, 0.0, 2.0]);
    assert_close(step("rk4", 0.0, DARK, Seconds(240.0)), 0.667, 3);
}

#[test]
fn a_dark_time_lapse_drives_pigment_below_none_and_above_all() {
    let heun = step("heun", 0.0, DARK, Seconds(300.0));
    assert_close(heun, -0.625, 3);
    assert_close(step("heun", heun, DARK, Seconds(300.0)), -1.64, 3);
    assert_close(step("rk4", 0.0, DARK, Seconds(335.0)), -0.0097, 2);
    assert_close(step("dopri5", 0.0, DARK, Seconds(400.0)), -0.050, 2);
    assert_close(step("trapezoid", 0.0, DARK, Seconds(300.0)), 1.11, 3);
    assert_close(step("tr-bdf2", 0.0, DARK, Seconds(300.0)), 1.01, 3);
}

#[test]
fn the_trapezoid_blows_up_under_flicker_with_uneven_frames() {
    let cycle = |p: f64, rising: f64, falling: f64| {
        let lit = step("trapezoid", p, ramp(0.0, SUN), Seconds(rising));
        step("trapezoid", lit, ramp(SUN, 0.0), Seconds(falling))
    };
    assert_close(amplification(|p| cycle(p, 1.0 / 24.0, 1.0 / 24.0)), -0.977, 3);
    assert_close(amplification(|p| cycle(p, 1.0 / 48.0, 1.0 / 24.0)), -1.93, 3);
    let p = (0..12).fold(1.0, |p, _| cycle(p, 1.0 / 48.0, 1.0 / 24.0));
    assert_close(p.abs(), 2700.0, 2);
    assert_close(amplification(|p| step("trapezoid", p, ramp(SUN, 0.0), FRAME)), -86.0, 2);
}

#[test]
fn rosenbrock_methods_explode_when_light_comes_up_inside_the_step() {
    assert_close(step("ros2", 1.0, ramp(0.0, 1e9), FRAME), 249.0, 3);
    assert_close(linearly_implicit(&ros3p(), &eye(), 1.0, ramp(0.0, 1e9), FRAME), 71.5, 3);
    assert_close(step("rodas4", 1.0, ramp(0.0, 1e9), FRAME), 642.0, 3);
    assert_close(step("ros2", 1.0, ramp(0.0, SUN), FRAME), 2.6e4, 2);
    assert_close(step("rodas4", 1.0, ramp(0.0, SUN), FRAME), -6.5e6, 2);
}

#[test]
fn rosenbrock_methods_amplify_as_a_power_of_the_light_they_did_not_see() {
    let bright = ramp(0.0, 2e4 * 1000.0 * 120.0 * 24.0);
    let ours = |name| amplification(|p| step(name, p, bright, FRAME)).abs();
    assert_close(ours("ros2"), 8.5e5, 2);
    assert_close(
        amplification(|p| linearly_implicit(&ros3p(), &eye(), p, bright, FRAME)).abs(),
        2.6e5,
        2,
    );
    assert_close(
        amplification(|p| linearly_implicit(&RODAS3, &eye(), p, bright, FRAME)).abs(),
        1.2e8,
        2,
    );
    assert_close(ours("rodas4"), 7.8e11, 2);
}

#[test]
fn light_that_falls_inside_the_step_turns_l_stable_methods_negative() {
    let deepest = |step: &dyn Fn(f64, Drive) -> f64| {
        let light = (60..110).map(|i| 10f64.powf(0.1 * f64::from(i)));
        light
            .map(|light| amplification(|p| step(p, ramp(light, 0.0))))
            .fold(f64::INFINITY, f64::min)
    };
    assert_close(deepest(&|p, drive| step("tr-bdf2", p, drive, FRAME)), -3.1, 2);
    assert_close(deepest(&|p, drive| collocate(&SDIRK2, &eye(), p, drive, FRAME)), -1.4, 2);
    for name in ["backward-euler", "lobatto-iiic-2", "exponential-euler", "exact", "ramp"] {
        assert!(deepest(&|p, drive| step(name, p, drive, FRAME)) >= -1e-15, "{name}");
    }
    let bright = (0..130).map(|i| 10f64.powf(6.0 + 0.05 * f64::from(i)));
    let rising = |light: f64| amplification(|p| step("radau-iia-5", p, ramp(0.0, light), FRAME));
    assert_close(bright.map(rising).fold(f64::INFINITY, f64::min), -0.022, 2);
}

#[test]
fn backward_euler_misses_a_glint_that_ends_within_the_frame() {
    assert!(step("backward-euler", 1.0, ramp(SUN, 0.0), FRAME) > 0.9995);
    assert_close(step("ramp", 1.0, ramp(SUN, 0.0), FRAME), 3.3e-5, 2);
    assert!(step("exact", 1.0, ramp(SUN, 0.0), FRAME) < 1e-5, "the mean keeps the dose");
}

#[test]
fn magnus_turns_negative_when_light_rises_by_more_than_twelve_over_h() {
    let risen = |d: f64| ramp(0.0, 2e4 * 120.0 * 24.0 * 2.0 * d);
    let regenerated = |d: f64| step("magnus-4", 0.0, risen(d), FRAME);
    assert!(regenerated(5.9) > 0.0 && regenerated(6.1) < 0.0);
    assert_close(step("magnus-4", 1.0, ramp(0.0, SUN), FRAME), -5.4e-5, 2);
    assert_close(step("ramp", 1.0, ramp(0.0, SUN), FRAME), 2.0e-6, 2);
}

#[test]
fn exponential_rosenbrock_overshoots_a_screened_pigment_into_the_negative() {
    let screened = other(Law::SelfScreened { density: 0.5, norm: 1.0 });
    let method = Method::named("exponential-rosenbrock").expect("a row of the table");
    let p = (method.step)(&screened, 1.0, held(1e9), FRAME);
    assert_close(p, -0.87, 2);
    let x = 0.5 * LN_10;
    let limit = 1.0 - (x.exp() - 1.0) / x;
    assert_close((method.step)(&screened, 1.0, held(1e12), FRAME), limit, 5);
    assert_close(
        linearly_implicit(&LINEARLY_IMPLICIT_EULER, &screened, 1.0, held(1e9), FRAME),
        -0.59,
        2,
    );
}

#[test]
fn heun_swings_about_a_false_rest_when_regeneration_is_limited() {
    let limited = other(Law::RateLimited { km: 0.2 });
    let heun = Method::named("heun").expect("a row of the table");
    let next = |p: &f64| Some((heun.step)(&limited, *p, DARK, Seconds(60.0)));
    let bleached: Vec<f64> =
        std::iter::successors(Some(0.0), next).take(2000).map(|p| 1.0 - p).collect();
    for (n, expected) in [(3, 0.33), (4, 0.23), (5, 0.32), (6, 0.23)] {
        assert_close(bleached[n], expected, 2);
    }
    assert_close(bleached[300], 0.27, 1);
    assert!(bleached[1999] > 0.27, "a day and a half in the dark, and a quarter never comes back");
    assert_eq!(limited.steady(Trolands(0.0)), 1.0);
}

#[test]
fn strang_splitting_rests_at_87_times_the_pigment_there_is() {
    let (rates, half) = (eye().rates(1.0, Trolands(SUN)), Seconds(0.5 * FRAME.0));
    let (bleach, regenerate) =
        (sungaze::kinetics::Rates { regenerate: 0.0, ..rates }, eye().rates(1.0, Trolands(0.0)));
    let p = (0..100).fold(1.0, |p, _| {
        relax(relax(relax(p, regenerate, half), bleach, FRAME), regenerate, half)
    });
    assert_close(p * SUN / 2e4, 86.8, 3);
    let exact = (0..100).fold(1.0, |p, _| step("exact", p, held(SUN), FRAME));
    assert!(exact * SUN / 2e4 <= 1.0, "catch s p never passes 1 at rest");
}

#[test]
fn an_adaptive_explicit_method_pays_a_hundred_evaluations_for_one_exponential() {
    let spent = [1e-3, 1e-6, 1e-9].map(|tolerance| {
        let found = dormand_prince(&eye(), 1.0, held(SUN), FRAME, tolerance);
        assert!((found.p - 2e-6).abs() < 10.0 * tolerance);
        found.evaluations
    });
    assert!(
        spent[0] > 250 && spent.is_sorted(),
        "{spent:?}; scipy's RK45 spends 398, 656 and 1544"
    );
}
