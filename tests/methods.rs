//! Every row of the method table against its own theory: a new method is tested by being there.

use sungaze::kinetics::Kinetics;
use sungaze::step::{Drive, METHODS, Method};
use sungaze::units::{Seconds, Trolands};

const TAU: f64 = 120.0;
const HALF_BLEACH: f64 = 2e4;

fn eye() -> Kinetics {
    Kinetics::first_order(Trolands(HALF_BLEACH), Seconds(TAU))
}

/// One step of h lambda = x under light s I0, from p.
fn held(method: &Method, x: f64, s: f64, p: f64) -> f64 {
    let dt = Seconds(x * TAU / (1.0 + s));
    (method.step)(&eye(), p, Drive::Held(Trolands(s * HALF_BLEACH)), dt)
}

#[test]
fn a_step_under_held_light_leaves_r_of_the_distance_from_rest() {
    for method in METHODS {
        for x in [1e-6, 0.01, 0.3, 1.0, 1.9, 2.4, 3.1, 10.0, 173.6] {
            for s in [0.0, 0.5, 1e3, 5e5] {
                for p in [0.0, 0.3, 1.0] {
                    let rest = 1.0 / (1.0 + s);
                    let expected = rest + (method.damping)(x) * (p - rest);
                    let found = held(method, x, s, p);
                    let scale = x.powi(6).max(1.0) * 1e-15 + 10.0 * method.tolerance;
                    assert!(
                        (found - expected).abs() <= 8.0 * scale,
                        "{} x={x} s={s} p={p}: {found}",
                        method.name
                    );
                }
            }
        }
    }
}

/// Light with lambda(t) = 1 + sin(2 t)/2 over 2 s, in `steps` steps.
fn smooth(step: impl Fn(&Kinetics, f64, Drive, Seconds) -> f64, steps: u32) -> f64 {
    let light = |lambda: f64| HALF_BLEACH * (TAU * lambda - 1.0);
    let h = 2.0 / f64::from(steps);
    let drive = |n: u32| Drive::Sine {
        mean: Trolands(light(1.0)),
        amplitude: Trolands(light(1.5) - light(1.0)),
        phase: 2.0 * h * f64::from(n),
        turn: 2.0 * h,
    };
    (0..steps).fold(1.0, |p, n| step(&eye(), p, drive(n), Seconds(h)))
}

fn truth() -> f64 {
    smooth(Method::named("radau-iia-5").expect("a row of the table").step, 3000)
}

#[test]
fn the_measured_order_is_the_stated_one() {
    let truth = truth();
    for method in METHODS.iter().filter(|method| method.tolerance == 0.0) {
        let coarse = if method.order > 3 { 48 } else { 96 };
        let error = |steps| (smooth(method.step, steps) - truth).abs();
        let order = (error(coarse) / error(2 * coarse)).log2();
        assert!((order - f64::from(method.order)).abs() < 0.1, "{}: {order}", method.name);
    }
}

#[test]
fn an_adaptive_method_errs_no_more_than_its_tolerance_times_its_steps() {
    for method in METHODS.iter().filter(|method| method.tolerance > 0.0) {
        let error = (smooth(method.step, 24) - truth()).abs();
        assert!(error < 24.0 * method.tolerance, "{}: {error:e}", method.name);
    }
}

#[test]
fn a_method_survives_just_below_its_limit_and_dies_just_beyond() {
    for method in METHODS {
        let distance_after_2000_steps = |x: f64| {
            let (s, dt) = (9.0, Seconds(x * TAU / 10.0));
            let light = Drive::Held(Trolands(s * HALF_BLEACH));
            ((0..2000).fold(1.0, |p, _| (method.step)(&eye(), p, light, dt)) - 0.1).abs()
        };
        if method.stable_to.is_finite() {
            assert!(
                distance_after_2000_steps(0.99 * method.stable_to) < 1e-6,
                "{} dies too early",
                method.name
            );
            let beyond = distance_after_2000_steps(1.1 * method.stable_to);
            assert!(beyond > 1e6 || beyond.is_nan(), "{} lives too long: {beyond}", method.name);
        } else {
            for x in [0.1, 1.0, 30.0, 1e3] {
                let damped =
                    (0..2000).fold(0.9_f64, |distance, _| distance * (method.damping)(x)).abs();
                let found = distance_after_2000_steps(x);
                assert!(
                    found <= 1.001 * damped + 1e-9 + 10.0 * method.tolerance,
                    "{} at {x}: {found}",
                    method.name
                );
            }
        }
    }
}

#[test]
fn pigment_stays_within_bounds_up_to_the_stated_limit_and_leaves_them_beyond() {
    let leaves = |method: &Method, x: f64| {
        let slack = 10.0 * method.tolerance + 1e-15;
        let outside = |p: f64| !(-slack..=1.0 + slack).contains(&p);
        [0.0, 1.0, 1e7]
            .iter()
            .any(|&s| [0.0, 0.5, 1.0].iter().any(|&p| outside(held(method, x, s, p))))
    };
    for method in METHODS {
        for part in [1e-3, 0.1, 0.5, 0.9, 0.999] {
            let x = if method.bounded_to.is_finite() {
                part * method.bounded_to
            } else {
                1e3 * part * part
            };
            assert!(!leaves(method, x), "{} leaves 0..1 at {x}", method.name);
        }
        if method.bounded_to.is_finite() {
            assert!(
                leaves(method, 1.01 * method.bounded_to),
                "{} is better than its row says",
                method.name
            );
        }
    }
}

#[test]
fn no_method_makes_nonsense_while_it_claims_to_be_stable() {
    for method in METHODS {
        for x in
            [1e-9, 0.5, 1.5, 2.0, 3.0, 50.0, 1e4].into_iter().filter(|&x| x <= method.stable_to)
        {
            for s in [0.0, 1.0, 1e6] {
                assert!(held(method, x, s, 1.0).is_finite(), "{} at x = {x}", method.name);
            }
        }
    }
}

#[test]
fn a_step_past_its_limit_is_reported_with_both_numbers() {
    let (frame, euler) =
        (Seconds(1.0 / 24.0), Method::named("forward-euler").expect("a row of the table"));
    let limit = Trolands(HALF_BLEACH * (24.0 * TAU - 1.0));
    assert_eq!(euler.past_limit(&eye(), Trolands(0.999 * limit.0), frame, 1), None);
    let past = euler.past_limit(&eye(), Trolands(1e10), frame, 1).expect("the sun is past it");
    assert_eq!(past.to_string(), "h lambda = 173.6115 is past the limit 1.0000");
    assert_eq!(euler.past_limit(&eye(), Trolands(1e10), frame, 200), None);
    assert_eq!(
        Method::named("exact").and_then(|exact| exact.past_limit(&eye(), Trolands(1e12), frame, 1)),
        None
    );
}

#[test]
fn names_are_unique_and_every_row_cites_its_source() {
    for method in METHODS {
        assert_eq!(
            METHODS.iter().filter(|other| other.name == method.name).count(),
            1,
            "{}",
            method.name
        );
        assert!(!method.source.is_empty(), "{}", method.name);
    }
}
