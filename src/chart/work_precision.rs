//! `work-precision`: what methods cost and how far they err, as a table of verdicts and as a sheet of
//! six panels, `work_precision_panels`.

use super::methods::drawn;
use super::scenes::scenes;
use super::verdict::{self, table};
use super::work::{Point, Work, errors, timed};
use super::{Progress, machine, panels, write_csv};
use crate::error::Result;
use crate::kinetics::Kinetics;
use crate::plot::palette::BLACK;
use crate::plot::{Anchor, Sheet, font};
use crate::step::{Drive, dormand_prince};
use crate::units::{Seconds, Trolands};
use std::path::Path;

pub(super) fn write(out_dir: &Path, progress: Progress) -> Result<()> {
    let scenes = scenes();
    let points = timed(errors(&scenes, progress), progress);
    let header =
        "scene,law,method,substeps_or_tolerance,max_abs_error,max_rel_error,ns_per_update,failure";
    write_csv(out_dir, "work_precision", header, points.iter().map(row))?;
    verdicts(&points).write(out_dir, "work_precision")?;
    panels::drawn(&points).write(out_dir, "work_precision_panels")
}

fn row(point: &Point) -> String {
    let work = match point.work {
        Work::Substeps(count) => count.to_string(),
        Work::Tolerance(tolerance) => format!("{tolerance:e}"),
    };
    let failure = point.failure.map_or("", |failure| failure.name());
    let (scene, law, method) = (point.scene, point.law.name(), point.method.name);
    let (abs, rel, ns) = (point.max_abs_error, point.max_rel_error, point.ns_per_update);
    format!("{scene},{law},{method},{work},{abs:.4e},{rel:.4e},{ns:.3},{failure}")
}

/// The table, under its message.
fn verdicts(points: &[Point]) -> Sheet {
    let methods = drawn();
    let mut sheet = Sheet::new(1000.0, 240.0 + verdict::ROW * methods.len() as f64);
    let title = "Euler wins indoors and dies in the sun; the exact step keeps every scene";
    sheet.bold((500.0, 28.0), title, 20, Anchor::Middle, BLACK);
    let words = "Least nanoseconds per update of a cone that keep p and a catch within 0.001, or how a method fails";
    sheet.text((500.0, 54.0), words, 15, Anchor::Middle, BLACK);
    let below = table(&mut sheet, points, &methods, 74.0) + 28.0;
    let (sun, machine, runs) = (evaluations_in_the_sun(), machine::name(), machine::RUNS);
    let notes = [
        "Dark: the fewest. In “ramp” light moves within a frame: exact holds its mean and errs by 0.197 h/τ = 6.8·10⁻⁵ at most;".to_owned(),
        "there the budget is of p alone.".to_owned(),
        format!("A frame of the sun costs dopri5-adaptive {sun} evaluations of p′ at tolerance 10⁻⁶, exact one exponential."),
        format!("Half-bleach 2·10⁴ td, τ 120 s. {machine}, one thread, warm, median of {runs} runs."),
    ];
    for (i, note) in notes.iter().enumerate() {
        let note = font::fitted(note, 14.0, 960.0);
        sheet.text((20.0, below + 22.0 * i as f64), &note, 14, Anchor::Start, BLACK);
    }
    sheet
}

/// What the adaptive pair evaluates in the first frame of the glance at the sun.
fn evaluations_in_the_sun() -> u64 {
    let light = Drive::Held(Trolands(1e10));
    dormand_prince(
        &Kinetics::first_order(Trolands(2e4), Seconds(120.0)),
        1.0,
        light,
        Seconds(1.0 / 24.0),
        1e-6,
    )
    .evaluations
}
