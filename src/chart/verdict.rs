//! The table above the work-precision panels: what each method costs where it keeps the budget, or
//! how it fails.

use super::methods::of_method;
use super::work::{Failure, Point};
use crate::plot::palette::{BLACK, GREEN, GREY, PALE_GREEN, PALE_GREY, PALE_RED, VERMILION, WHITE};
use crate::plot::{Anchor, Ink, Sheet};

/// What a method is worth on a scene.
enum Verdict {
    /// Nanoseconds of the least work that keeps the budget.
    Keeps(f64),
    /// How it fails, whatever the work shown.
    Fails(Failure),
    /// Sound, but never within the budget.
    TooCoarse,
}

/// The verdict on `method` under `law` on `scene`.
fn verdict(points: &[Point], scene: &str, law: &str, method: &str) -> Verdict {
    let of_it = || {
        points.iter().filter(|p| p.scene == scene && p.law.name() == law && p.method.name == method)
    };
    let cheapest = of_it().filter(|point| point.keeps_budget()).map(|point| point.ns_per_update);
    match cheapest.min_by(f64::total_cmp) {
        Some(ns) => Verdict::Keeps(ns),
        None => of_it().find_map(|point| point.failure).map_or(Verdict::TooCoarse, Verdict::Fails),
    }
}

/// Columns: scene, law and heading in two lines.
const COLUMNS: [(&str, &str, [&str; 2]); 10] = [
    ("indoor", "first-order", ["indoor", ""]),
    ("street", "first-order", ["street", ""]),
    ("headlamp", "first-order", ["head-", "lamp"]),
    ("sun-glance", "first-order", ["sun", "glance"]),
    ("time-lapse", "first-order", ["time-", "lapse"]),
    ("flicker", "first-order", ["flicker", ""]),
    ("dark-recovery", "first-order", ["dark", "recovery"]),
    ("ramp", "first-order", ["ramp", ""]),
    ("sun-glance", "self-screened", ["sun, self-", "screened"]),
    ("time-lapse", "rate-limited", ["lapse, rate", "limited"]),
];

/// Height of a method's row.
pub(super) const ROW: f64 = 25.0;
const COLUMN: f64 = 80.0;
const LEFT: f64 = 180.0;

/// Draw the table for `methods` from `top`; returns where it ends.
pub(super) fn table(sheet: &mut Sheet, points: &[Point], methods: &[&str], top: f64) -> f64 {
    let centre = |column: usize| LEFT + COLUMN * (column as f64 + 0.5);
    for (column, (_, _, heading)) in COLUMNS.iter().enumerate() {
        for (line, words) in heading.iter().filter(|words| !words.is_empty()).enumerate() {
            sheet.text(
                (centre(column), top + 14.0 + 17.0 * line as f64),
                words,
                14,
                Anchor::Middle,
                BLACK,
            );
        }
    }
    let body = top + 42.0;
    for (i, method) in methods.iter().enumerate() {
        let y = body + ROW * i as f64;
        let (ink, marker) = of_method(method);
        sheet.mark((30.0, y + 0.5 * ROW), marker, 5.0, ink);
        sheet.text((44.0, y + 0.5 * ROW + 5.5), method, 15, Anchor::Start, BLACK);
        for (column, (scene, law, _)) in COLUMNS.iter().enumerate() {
            let verdict = verdict(points, scene, law, method);
            let best =
                matches!(verdict, Verdict::Keeps(ns) if ns <= least(points, scene, law, methods));
            let (ground, words, ink) =
                if best { (GREEN, verdict.words(), WHITE) } else { verdict.colours() };
            let left = LEFT + COLUMN * column as f64;
            sheet.block((left + 1.0, y + 1.0), COLUMN - 2.0, ROW - 2.0, ground);
            sheet.text((centre(column), y + 0.5 * ROW + 5.5), &words, 15, Anchor::Middle, ink);
        }
    }
    body + ROW * methods.len() as f64
}

/// The least that any of `methods` spends to keep the budget, ns.
fn least(points: &[Point], scene: &str, law: &str, methods: &[&str]) -> f64 {
    let spent = methods.iter().filter_map(|method| match verdict(points, scene, law, method) {
        Verdict::Keeps(ns) => Some(ns),
        _ => None,
    });
    spent.fold(f64::INFINITY, f64::min)
}

impl Verdict {
    fn words(&self) -> String {
        match self {
            Verdict::Keeps(ns) => format!("{ns:.0} ns"),
            Verdict::Fails(failure) => failure.name().to_owned(),
            Verdict::TooCoarse => "> 0.001".to_owned(),
        }
    }

    /// Ground, words and their ink.
    fn colours(&self) -> (Ink, String, Ink) {
        match self {
            Verdict::Keeps(_) => (PALE_GREEN, self.words(), BLACK),
            Verdict::Fails(_) => (PALE_RED, self.words(), VERMILION),
            Verdict::TooCoarse => (PALE_GREY, self.words(), GREY),
        }
    }
}
