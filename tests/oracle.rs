//! Every row of `data/kinetics_oracle.csv`: the truth to 30 digits, from 60-digit arithmetic.

use sungaze::kinetics::{Kinetics, Law, Rates};
use sungaze::step::{Drive, Method, advance, enclosed, frozen_midpoint};
use sungaze::units::{Seconds, Trolands};

struct Row {
    case: String,
    kinetics: Kinetics,
    p0: f64,
    schedule: Vec<(Drive, Seconds)>,
    p: f64,
}

fn rows(model: &str) -> Vec<Row> {
    let table =
        std::fs::read_to_string("data/kinetics_oracle.csv").expect("the oracle lies in data/");
    let rows: Vec<Row> = table
        .lines()
        .skip(1)
        .filter(|line| line.split(',').nth(1) == Some(model))
        .map(row)
        .collect();
    assert!(!rows.is_empty(), "no rows of {model}");
    rows
}

fn row(line: &str) -> Row {
    let field: Vec<&str> = line.split(',').collect();
    let number = |i: usize| field[i].parse::<f64>().unwrap_or(f64::NAN);
    let law = match field[1] {
        "linear" => Law::FirstOrder,
        "enzyme" => Law::RateLimited { km: number(5) },
        _ => Law::SelfScreened { density: number(4), norm: 1.0 },
    };
    let kinetics = Kinetics { law, half_bleach: Trolands(number(3)), tau: Seconds(number(2)) };
    Row {
        case: line.to_owned(),
        kinetics,
        p0: number(6),
        schedule: schedule(field[7]),
        p: number(9),
    }
}

/// `hold:<td>:<s>` and `ramp:<td>:<td>:<s>`, separated by spaces, or `<n>*(...)`.
fn schedule(text: &str) -> Vec<(Drive, Seconds)> {
    if let Some((count, inner)) = text.split_once("*(") {
        let once = schedule(inner.trim_end_matches(')'));
        return once.repeat(count.parse().expect("a count"));
    }
    let part = |text: &str| {
        let numbers: Vec<f64> =
            text.split(':').skip(1).map(|n| n.parse().expect("a number")).collect();
        match numbers[..] {
            [light, dt] => (Drive::Held(Trolands(light)), Seconds(dt)),
            [from, to, dt] => (Drive::Ramp { from: Trolands(from), to: Trolands(to) }, Seconds(dt)),
            _ => panic!("an unknown part of a schedule: {text}"),
        }
    };
    text.split(' ').map(part).collect()
}

fn run(row: &Row, method: &str) -> f64 {
    let step = Method::named(method).expect("a row of the table").step;
    row.schedule.iter().fold(row.p0, |p, &(drive, dt)| step(&row.kinetics, p, drive, dt))
}

fn is_held(row: &Row) -> bool {
    row.schedule.iter().all(|(drive, _)| matches!(drive, Drive::Held(_)))
}

#[test]
fn the_exact_step_is_exact_to_1e_14_on_every_held_first_order_row() {
    let rows = rows("linear");
    let held: Vec<&Row> = rows.iter().filter(|row| is_held(row)).collect();
    assert_eq!(held.len(), 142);
    for row in held {
        let error = (run(row, "exact") - row.p).abs();
        assert!(error <= 1e-14, "{error:e} in {}", row.case);
    }
}

#[test]
fn the_ramp_step_is_exact_to_2e_15_on_every_ramp() {
    for row in rows("linear").iter().filter(|row| !is_held(row)) {
        let error = (run(row, "ramp") - row.p).abs();
        assert!(error <= 2e-15, "{error:e} in {}", row.case);
    }
}

#[test]
fn holding_the_mean_of_a_ramp_errs_by_at_most_0_197_h_over_tau() {
    for row in rows("linear").iter().filter(|row| !is_held(row) && row.schedule.len() == 1) {
        let (error, dt) = ((run(row, "exact") - row.p).abs(), row.schedule[0].1);
        assert!(error <= 0.197 * dt.0 / 120.0, "{error:e} in {}", row.case);
    }
}

#[test]
fn every_method_that_is_exact_for_held_light_agrees_with_the_oracle() {
    for name in ["exponential-euler", "magnus-4", "exponential-rosenbrock", "ramp"] {
        for row in rows("linear").iter().filter(|row| is_held(row)) {
            let error = (run(row, name) - row.p).abs();
            assert!(error <= 2e-14, "{name}: {error:e} in {}", row.case);
        }
    }
}

#[test]
fn the_adaptive_pair_agrees_with_the_oracle_within_its_tolerance() {
    for row in rows("linear").iter().filter(|row| row.schedule.len() < 60) {
        let error = (run(row, "dopri5-adaptive") - row.p).abs();
        assert!(error <= 2e-5, "{error:e} in {}", row.case);
    }
}

#[test]
fn the_enclosure_of_the_other_laws_holds_the_truth() {
    for row in rows("screened").iter().chain(&rows("enzyme")) {
        let (drive, dt) = row.schedule[0];
        assert_eq!(row.schedule.len(), 1);
        for substeps in [1, 2, 8, 64, 1024] {
            let found = enclosed(&row.kinetics, row.p0, drive.mean(), dt, substeps);
            let error = (found.p - row.p).abs();
            assert!(
                error <= found.error + 1e-14,
                "{error:e}, bound {:e}, {substeps} in {}",
                found.error,
                row.case
            );
        }
    }
}

#[test]
fn sub_steps_bring_the_other_laws_to_the_truth() {
    for row in rows("screened").iter().chain(&rows("enzyme")) {
        let (drive, dt) = row.schedule[0];
        let error = (advance(&row.kinetics, row.p0, drive.mean(), dt, 20_000) - row.p).abs();
        assert!(error <= 2e-8, "{error:e} in {}", row.case);
    }
}

#[test]
fn implicit_methods_solve_the_other_laws_as_well() {
    for row in rows("screened").iter().chain(&rows("enzyme")) {
        let (drive, dt) = row.schedule[0];
        let radau = Method::named("radau-iia-5").expect("a row of the table");
        let error = (radau.hold(&row.kinetics, row.p0, drive.mean(), dt, 4000) - row.p).abs();
        assert!(error <= 1e-12, "{error:e} in {}", row.case);
    }
}

#[test]
fn a_flash_without_regeneration_follows_the_closed_form_of_self_screening() {
    for row in rows("screened-noregen") {
        let (drive, dt) = row.schedule[0];
        let rates = |p| Rates { regenerate: 0.0, ..row.kinetics.rates(p, drive.mean()) };
        let part = Seconds(dt.0 / 20_000.0);
        let p = (0..20_000).fold(row.p0, |p, _| frozen_midpoint(p, part, rates));
        assert!((p - row.p).abs() <= 1e-7, "{:e} in {}", p - row.p, row.case);
    }
}
