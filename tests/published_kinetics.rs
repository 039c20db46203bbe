//! The kinetics against numbers that others published.

use sungaze::kinetics::Kinetics;
use sungaze::step::{Method, advance};
use sungaze::units::{Seconds, Trolands};

/// 10^4.3 td and 120 s: Boynton & Kaiser, as in Psychtoolbox.
fn eye() -> Kinetics {
    Kinetics::first_order(Trolands(10f64.powf(4.3)), Seconds(120.0))
}

fn look(p: f64, light: f64, seconds: f64) -> f64 {
    advance(&eye(), p, Trolands(light), Seconds(seconds), 1)
}

#[test]
fn psychtoolbox_onset_is_met_by_the_exact_step() {
    for (seconds, bleached) in [(1.0, 0.0407367), (10.0, 0.3285206), (60.0, 0.7924025)] {
        assert!((1.0 - look(1.0, 1e5, seconds) - bleached).abs() < 5e-8);
    }
}

#[test]
fn psychtoolbox_one_second_euler_is_met_by_forward_euler_and_diverges_at_1e8_td() {
    let euler = |light, seconds| {
        let method = Method::named("forward-euler").expect("a row of the table");
        1.0 - (0..seconds)
            .fold(1.0, |p, _| method.hold(&eye(), p, Trolands(light), Seconds(1.0), 1))
    };
    for (seconds, bleached) in [(1, 0.0417656), (10, 0.3350376), (60, 0.7954951)] {
        assert!((euler(1e5, seconds) - bleached).abs() < 1e-7);
    }
    assert!(euler(1e8, 10).abs() > 1e9);
}

#[test]
fn a_sequence_of_looks_ends_where_it_was_computed_to_end() {
    let looks = [
        (5.0, 1e6, 0.1360810643),
        (60.0, 0.0, 0.4760066780),
        (2.0, 1e5, 0.4464823240),
        (30.0, 0.0, 0.5689200005),
        (0.5, 1e8, 0.0001994869),
        (300.0, 0.0, 0.9179313763),
        (1000.0, 2e4, 0.4994071108),
    ];
    looks.iter().fold(1.0, |p, &(seconds, light, expected)| {
        let p = look(p, light, seconds);
        assert!((p - expected).abs() < 1e-9, "{seconds} s at {light} td: {p}");
        p
    });
}

#[test]
fn the_flash_train_of_cooper_2020_bleaches_as_published() {
    let published = [
        (1, 0.336527066),
        (2, 0.528324619),
        (3, 0.637636188),
        (5, 0.735443211),
        (10, 0.779667866),
        (13, 0.781973571),
    ];
    let mut p = 1.0;
    for trial in 1..=13 {
        p = look(look(p, 0.0, 4.0), 988015.9686, 0.999);
        if let Some((_, bleached)) = published.iter().find(|(n, _)| *n == trial) {
            assert!((1.0 - p - bleached).abs() < 1e-9, "trial {trial}: {}", 1.0 - p);
        }
        p = look(p, 0.0, 18.0 - 4.999);
    }
}

#[test]
fn cone_pigment_is_back_after_eight_minutes() {
    assert!((look(0.0, 0.0, 480.0) - 0.98).abs() < 0.002);
}

#[test]
fn half_of_the_pigment_goes_at_10_to_the_4_3_td() {
    assert!((eye().steady(Trolands(10f64.powf(4.3))) - 0.5).abs() < 1e-15);
}

/// W(x) of Lambert: w e^w = x.
fn lambert(x: f64) -> f64 {
    (0..100).fold(x.ln_1p(), |w, _| w - (w - x * (-w).exp()) / (1.0 + w))
}

#[test]
fn rate_limited_recovery_follows_its_closed_form() {
    for km in [0.2, 1.0] {
        let limited = Kinetics { law: sungaze::kinetics::Law::RateLimited { km }, ..eye() };
        for seconds in [1.0, 30.0, 200.0] {
            let decayed = (1.0 / km) * ((1.0 - (1.0 + km) / 120.0 * seconds) / km).exp();
            let p = advance(&limited, 0.0, Trolands(0.0), Seconds(seconds), 10_000);
            assert!((1.0 - p - km * lambert(decayed)).abs() < 1e-8, "Km {km}, {seconds} s");
        }
    }
}
