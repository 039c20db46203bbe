//! Every row of `data/kinetics_oracle.csv`, case by case: the largest error of p.

use crate::error::Result;
use crate::kinetics::{Kinetics, Law, Rates};
use crate::step::{Drive, METHODS, advance, frozen_midpoint};
use crate::units::{Seconds, Trolands};

use super::limit::worst;
use super::{Check, Subject};

const TABLE: &str = include_str!("../../data/kinetics_oracle.csv");

/// Sub-steps of the laws that have no closed form; their error falls with the square.
const SUBSTEPS: u32 = 4000;

struct Row {
    law: String,
    kinetics: Kinetics,
    start: f64,
    schedule: Vec<(Drive, Seconds)>,
    p: f64,
}

/// What to call a case, which law it is, and how far the code may be off.
const CASES: [(&str, &str, f64); 10] = [
    ("held", "first order, held light, 93 cases", 1e-14),
    ("dark", "first order, dark recovery, 23 cases", 1e-14),
    ("sun-glance", "first order, sun glance, 25 cases", 1e-14),
    ("flicker-12Hz", "first order, 12 Hz flicker", 1e-14),
    ("ramp", "first order, light ramps within the step, 64 cases", 2e-15),
    ("sun-glance-ramp", "first order, sun glance with its ramps, 5 cases", 2e-15),
    ("screened", "self-screened, 9 cases, 4000 sub-steps", 1e-7),
    ("screened-flash-noregen", "self-screened flash alone, 6 cases, 4000 sub-steps", 1e-7),
    ("dark-enzyme", "rate-limited, dark, 18 cases, 4000 sub-steps", 1e-7),
    ("enzyme-light", "rate-limited, light, 2 cases, 4000 sub-steps", 1e-7),
];

pub(super) fn checks(_: &Subject) -> Result<Vec<Check>> {
    let rows: Vec<(&str, Row)> = TABLE.lines().skip(1).filter_map(row).collect();
    let check = |(case, name, tolerance): (&str, &str, f64)| {
        let errors =
            rows.iter().filter(|(of, _)| *of == case).map(|(_, row)| (computed(row) - row.p).abs());
        Check::new(
            format!("p, worst error: {name}"),
            "kinetics_oracle.csv",
            worst(errors, 0.0),
            0.0,
            tolerance,
        )
    };
    Ok(CASES.map(check).into())
}

/// A line of the table; none of ours is unreadable.
fn row(line: &str) -> Option<(&str, Row)> {
    let field: Vec<&str> = line.split(',').collect();
    let number = |i: usize| field[i].parse::<f64>().ok();
    let law = match field[1] {
        "linear" => Law::FirstOrder,
        "enzyme" => Law::RateLimited { km: number(5)? },
        _ => Law::SelfScreened { density: number(4)?, norm: 1.0 },
    };
    let kinetics = Kinetics { law, half_bleach: Trolands(number(3)?), tau: Seconds(number(2)?) };
    let row = Row {
        law: field[1].to_owned(),
        kinetics,
        start: number(6)?,
        schedule: schedule(field[7])?,
        p: number(9)?,
    };
    Some((field[0], row))
}

/// `hold:<td>:<s>` and `ramp:<td>:<td>:<s>`, separated by spaces, or `<n>*(...)`.
fn schedule(text: &str) -> Option<Vec<(Drive, Seconds)>> {
    if let Some((count, inner)) = text.split_once("*(") {
        return Some(schedule(inner.trim_end_matches(')'))?.repeat(count.parse().ok()?));
    }
    let part = |text: &str| {
        let numbers: Vec<f64> = text.split(':').skip(1).filter_map(|n| n.parse().ok()).collect();
        match numbers[..] {
            [light, dt] => Some((Drive::Held(Trolands(light)), Seconds(dt))),
            [from, to, dt] => {
                Some((Drive::Ramp { from: Trolands(from), to: Trolands(to) }, Seconds(dt)))
            }
            _ => None,
        }
    };
    text.split(' ').map(part).collect()
}

/// p at the end of a row: the ramp's closed form where light moves, the exact step elsewhere.
fn computed(row: &Row) -> f64 {
    let ramp = METHODS.iter().find(|method| method.name == "ramp").unwrap_or(&METHODS[0]);
    let step = |p: f64, (drive, dt): (Drive, Seconds)| match drive {
        Drive::Held(light) if row.law == "screened-noregen" => {
            bleach_alone(&row.kinetics, p, light, dt)
        }
        Drive::Held(light) => advance(&row.kinetics, p, light, dt, SUBSTEPS),
        moving => (ramp.step)(&row.kinetics, p, moving, dt),
    };
    row.schedule.iter().copied().fold(row.start, step)
}

/// A flash so short that nothing is regenerated.
fn bleach_alone(kinetics: &Kinetics, p: f64, light: Trolands, dt: Seconds) -> f64 {
    let part = Seconds(dt.0 / f64::from(SUBSTEPS));
    let rates = |p: f64| Rates { regenerate: 0.0, ..kinetics.rates(p, light) };
    (0..SUBSTEPS).fold(p, |p, _| frozen_midpoint(p, part, rates))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::{Method, enclosed};

    fn of_laws(laws: &[&str]) -> Vec<Row> {
        let all = TABLE.lines().skip(1).filter_map(row).map(|(_, row)| row);
        let rows: Vec<Row> = all.filter(|row| laws.contains(&row.law.as_str())).collect();
        assert!(!rows.is_empty(), "no rows of {laws:?}");
        rows
    }

    /// How far a method of the table is from the truth at the end of a row.
    fn error(row: &Row, method: &str) -> f64 {
        let step = Method::named(method).unwrap().step;
        let end = row
            .schedule
            .iter()
            .fold(row.start, |p, &(drive, dt)| step(&row.kinetics, p, drive, dt));
        (end - row.p).abs()
    }

    fn is_held(row: &Row) -> bool {
        row.schedule.iter().all(|(drive, _)| matches!(drive, Drive::Held(_)))
    }

    #[test]
    fn every_line_of_the_table_is_read_and_belongs_to_a_check_that_says_how_many_it_has() {
        let rows: Vec<(&str, Row)> = TABLE.lines().skip(1).filter_map(row).collect();
        assert_eq!(rows.len(), TABLE.lines().count() - 1);
        let mut judged = 0;
        for (case, name, _) in CASES {
            let count = rows.iter().filter(|(of, _)| *of == case).count();
            let said = name.split(", ").find_map(|part| part.strip_suffix(" cases"));
            assert_eq!(count, said.map_or(1, |said| said.parse().unwrap()), "{name}");
            judged += count;
        }
        assert_eq!(judged, rows.len());
    }

    #[test]
    fn holding_the_mean_of_a_ramp_errs_by_at_most_0_197_h_over_tau() {
        let rows = of_laws(&["linear"]);
        for row in rows.iter().filter(|row| !is_held(row) && row.schedule.len() == 1) {
            let (error, bound) = (error(row, "exact"), 0.197 * row.schedule[0].1.0 / 120.0);
            assert!(error <= bound, "{error:e} of {bound:e}: {:?}", row.schedule);
        }
    }

    #[test]
    fn every_method_that_is_exact_for_held_light_agrees_with_the_oracle() {
        for name in ["exponential-euler", "magnus-4", "exponential-rosenbrock", "ramp"] {
            for row in of_laws(&["linear"]).iter().filter(|row| is_held(row)) {
                assert!(error(row, name) <= 2e-14, "{name}: {:?}", row.schedule);
            }
        }
    }

    #[test]
    fn the_adaptive_pair_agrees_with_the_oracle_within_its_tolerance() {
        for row in of_laws(&["linear"]).iter().filter(|row| row.schedule.len() < 60) {
            assert!(error(row, "dopri5-adaptive") <= 2e-5, "{:?}", row.schedule);
        }
    }

    #[test]
    fn the_enclosure_of_the_other_laws_holds_the_truth_and_implicit_methods_find_it() {
        let radau = Method::named("radau-iia-5").unwrap();
        for row in of_laws(&["screened", "enzyme"]) {
            let &[(drive, dt)] = &row.schedule[..] else { panic!("{:?}", row.schedule) };
            for substeps in [1, 2, 8, 64, 1024] {
                let found = enclosed(&row.kinetics, row.start, drive.mean(), dt, substeps);
                let error = (found.p - row.p).abs();
                assert!(error <= found.error + 1e-14, "{error:e} of {found:?}, {substeps}");
            }
            let error =
                (radau.hold(&row.kinetics, row.start, drive.mean(), dt, 4000) - row.p).abs();
            assert!(error <= 1e-12, "{error:e}: {drive:?}");
        }
    }
}
