//! Laws of the laws, over all lights, steps and starts.

use proptest::prelude::*;
use sungaze::kinetics::{Kinetics, Law};
use sungaze::step::{advance, enclosed, enclosed_within, substeps_for};
use sungaze::units::{Seconds, Trolands};

fn kinetics() -> impl Strategy<Value = Kinetics> {
    let names = prop::sample::select(&Law::NAMES[..]);
    let law = (names, 0.05..1.0, 0.2..1.0)
        .prop_map(|((_, law), density, km): ((&str, Law), f64, f64)| law.with(density, km));
    (law, 3.5..5.3, 60.0..400.0).prop_map(|(law, log_half_bleach, tau): (Law, f64, f64)| Kinetics {
        law,
        half_bleach: Trolands(10f64.powf(log_half_bleach)),
        tau: Seconds(tau),
    })
}

/// Darkness, or 1e-2 to 1e12 td.
fn light() -> impl Strategy<Value = Trolands> {
    prop_oneof![1 => Just(Trolands(0.0)), 9 => (-2.0..12.0).prop_map(|log: f64| Trolands(10f64.powf(log)))]
}

/// 1e-4 to 1e5 s.
fn duration() -> impl Strategy<Value = Seconds> {
    (-4.0..5.0).prop_map(|log: f64| Seconds(10f64.powf(log)))
}

fn fraction() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => Just(1.0), 8 => 0.0..1.0, 2 => (-12.0..0.0).prop_map(|log: f64| 10f64.powf(log))]
}

/// Rounding of numbers up to 1.
const ROUNDING: f64 = 4e-16;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn pigment_is_never_less_than_none_nor_more_than_all(
        k in kinetics(), light in light(), dt in duration(), p in fraction(), substeps in 1u32..5
    ) {
        let next = advance(&k, p, light, dt, substeps);
        prop_assert!((0.0..=1.0).contains(&next), "{next:e}");
    }

    #[test]
    fn pigment_moves_toward_its_steady_state_and_never_past_it(
        k in kinetics(), light in light(), dt in duration(), p in fraction()
    ) {
        let (next, rest) = (advance(&k, p, light, dt, 1), k.steady(light));
        prop_assert!(next >= p.min(rest) - ROUNDING && next <= p.max(rest) + ROUNDING, "{p} to {next}, rest {rest}");
    }

    #[test]
    fn more_light_never_leaves_more_pigment(
        k in kinetics(), light in light(), more in 0.0..3.0f64, dt in duration(), p in fraction()
    ) {
        let brighter = Trolands(light.0 * 10f64.powf(more));
        prop_assert!(k.steady(brighter) <= k.steady(light));
        prop_assert!(advance(&k, p, brighter, dt, 1) <= advance(&k, p, light, dt, 1) + ROUNDING);
    }

    #[test]
    fn two_histories_never_change_places_and_never_part(
        k in kinetics(), light in light(), dt in duration(), p in fraction(), q in fraction()
    ) {
        let ahead = advance(&k, p.max(q), light, dt, 1) - advance(&k, p.min(q), light, dt, 1);
        prop_assert!(ahead >= -ROUNDING, "the order is kept: {ahead:e}");
        prop_assert!(ahead <= (p - q).abs() + ROUNDING, "{ahead:e} from {:e}", (p - q).abs());
    }

    #[test]
    fn the_truth_lies_within_the_enclosure(
        k in kinetics(), light in light(), dt in duration(), p in fraction(), substeps in 1u32..9
    ) {
        let found = enclosed(&k, p, light, dt, substeps);
        let finer = enclosed(&k, p, light, dt, 256 * substeps);
        prop_assert_eq!(found.p, advance(&k, p, light, dt, substeps));
        let rounded = ROUNDING * f64::from(257 * substeps);
        prop_assert!((found.p - finer.p).abs() <= found.error + finer.error + rounded);
        prop_assert!(found.error <= 1.0);
    }

    #[test]
    fn enough_sub_steps_keep_a_budget(k in kinetics(), light in light(), dt in duration(), p in fraction()) {
        let found = enclosed_within(&k, p, light, dt, 1e-3);
        prop_assert!(found.error <= 1e-3, "{found:?}");
        prop_assert_eq!(found.substeps, substeps_for(&k, p, light, dt, 1e-3));
    }
}
