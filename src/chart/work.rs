//! What a method costs on a scene, how far it errs, and how it fails.

use super::Progress;
use super::machine::{RUNS, median, nanoseconds};
use super::scenes::Scene;
use crate::kinetics::{Kinetics, Law};
use crate::step::{Drive, METHODS, Method, dormand_prince};
use crate::units::{Seconds, Trolands};
use std::hint::black_box;

/// How a method may fail on a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Failure {
    /// |p| passes 2, or is no number.
    BlowUp,
    /// Pigment below none.
    Negative,
    /// p swings to and fro while the truth goes one way, or passes 1.
    Ringing,
    /// p stands still while the truth moves on.
    Frozen,
}

impl Failure {
    pub(super) fn name(self) -> &'static str {
        match self {
            Failure::BlowUp => "blow-up",
            Failure::Negative => "negative",
            Failure::Ringing => "ringing",
            Failure::Frozen => "frozen",
        }
    }

    pub(super) fn letter(self) -> &'static str {
        match self {
            Failure::BlowUp => "B",
            Failure::Negative => "N",
            Failure::Ringing => "R",
            Failure::Frozen => "F",
        }
    }
}

/// What is spent on a frame: equal sub-steps, or whatever a tolerance asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Work {
    Substeps(u32),
    Tolerance(f64),
}

/// One point of the chart.
pub(super) struct Point {
    pub(crate) scene: &'static str,
    pub(crate) law: Law,
    pub(crate) method: &'static Method,
    pub(crate) work: Work,
    pub(crate) max_abs_error: f64,
    pub(crate) max_rel_error: f64,
    pub(crate) ns_per_update: f64,
    pub(crate) failure: Option<Failure>,
}

/// Error of p, and of a catch, that nobody can see.
pub(super) const BUDGET: f64 = 1e-3;

impl Point {
    /// Within the budget, of p and (in proportion to p) of a catch. Where light moves within
    /// frames, only of p: what it does there is known to half a frame at best, and that alone moves
    /// the little p left in the sun by half.
    pub(super) fn keeps_budget(&self) -> bool {
        let of_catch = self.scene == "ramp" || self.max_rel_error <= BUDGET;
        self.failure.is_none() && self.max_abs_error <= BUDGET && of_catch
    }
}

/// Every law with the constants of the `standard` set: half-bleach 2e4 td, 120 s; density 0.5, Km
/// 0.2.
pub(super) fn laws() -> impl Iterator<Item = Kinetics> {
    let laws = Law::NAMES.into_iter().map(|(_, law)| law.with(0.5, 0.2));
    laws.map(|law| Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) })
}

/// A point without its time, and what is run to time it.
pub(super) struct Untimed<'a> {
    scene: &'a Scene,
    kinetics: Kinetics,
    point: Point,
}

/// Errors and failures of every scene, law, method and amount of work.
pub(super) fn errors<'a>(scenes: &'a [Scene], progress: Progress) -> Vec<Untimed<'a>> {
    let mut all = Vec::new();
    for scene in scenes {
        progress(&format!("work-precision: errors, {}", scene.name));
        for kinetics in laws() {
            let truth = truth(&kinetics, scene);
            for method in METHODS {
                let works = amounts(&kinetics, scene, method).into_iter();
                all.extend(works.map(|work| {
                    let point = point(&kinetics, scene, method, work, &truth);
                    Untimed { scene, kinetics, point }
                }));
            }
        }
    }
    all
}

/// The points with their times: medians of runs that are spread over the whole measurement.
pub(super) fn timed(untimed: Vec<Untimed>, progress: Progress) -> Vec<Point> {
    let mut runs = vec![Vec::with_capacity(RUNS); untimed.len()];
    for run in 1..=RUNS {
        progress(&format!("work-precision: timing, run {run} of {RUNS}"));
        for (Untimed { scene, kinetics, point }, runs) in untimed.iter().zip(&mut runs) {
            runs.push(cost(kinetics, scene, point.method, point.work));
        }
    }
    let timed = untimed.into_iter().zip(runs);
    timed.map(|(of, runs)| Point { ns_per_update: median(runs), ..of.point }).collect()
}

/// The amounts of work worth showing: a method that is exact on a scene is one point.
fn amounts(kinetics: &Kinetics, scene: &Scene, method: &Method) -> Vec<Work> {
    let held = scene.frames.iter().all(|(drive, _)| matches!(drive, Drive::Held(_)));
    let is_exact =
        (method.damping)(1.0) == (-1.0_f64).exp() && kinetics.law == Law::FirstOrder && held;
    if method.tolerance > 0.0 {
        [1e-2, 1e-4, 1e-6, 1e-8, 1e-10].map(Work::Tolerance).to_vec()
    } else if is_exact {
        vec![Work::Substeps(1)]
    } else {
        [1, 2, 4, 8, 16].map(Work::Substeps).to_vec()
    }
}

/// The point without its time.
fn point(
    kinetics: &Kinetics,
    scene: &Scene,
    method: &'static Method,
    work: Work,
    truth: &[f64],
) -> Point {
    let path = path(scene, |p, drive, dt| frame(method, work, kinetics, p, drive, dt));
    let worst = |error: &dyn Fn(f64, f64) -> f64| {
        let errors = path.iter().zip(truth).map(|(&p, &true_p)| error(p, true_p));
        errors.fold(0.0, |most: f64, e| if e.is_nan() { f64::INFINITY } else { most.max(e) })
    };
    Point {
        scene: scene.name,
        law: kinetics.law,
        method,
        work,
        max_abs_error: worst(&|p, true_p| (p - true_p).abs()),
        max_rel_error: worst(&|p, true_p| (p / true_p - 1.0).abs()),
        ns_per_update: f64::NAN,
        failure: failure(scene.start, &path, truth),
    }
}

/// p after one frame.
fn frame(
    method: &Method,
    work: Work,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
) -> f64 {
    match work {
        Work::Tolerance(tolerance) => dormand_prince(kinetics, p, drive, dt, tolerance).p,
        Work::Substeps(1) => (method.step)(kinetics, p, drive, dt),
        Work::Substeps(count) => {
            let (count, part) = (f64::from(count), Seconds(dt.0 / f64::from(count)));
            let parts = (0..count as u32).map(f64::from);
            parts.fold(p, |p, i| {
                (method.step)(kinetics, p, drive.part(i / count, (i + 1.0) / count), part)
            })
        }
    }
}

/// p at the end of every frame.
fn path(scene: &Scene, mut frame: impl FnMut(f64, Drive, Seconds) -> f64) -> Vec<f64> {
    let mut p = scene.start;
    let each = scene.frames.iter().map(|&(drive, dt)| {
        p = frame(p, drive, dt);
        p
    });
    each.collect()
}

/// The truth by another way than any method's: the convex form of the solution for the first-order
/// law under held light, the closed form of the ramp, and for the other laws Radau IIA 5 with steps
/// so small that it errs by 1e-12.
fn truth(kinetics: &Kinetics, scene: &Scene) -> Vec<f64> {
    path(scene, |p, drive, dt| match (kinetics.law, drive) {
        (Law::FirstOrder, Drive::Held(light)) => {
            let rates = kinetics.rates(p, light);
            let kept = (-dt.0 * rates.sum()).exp();
            kept * p + (1.0 - kept) * kinetics.steady(light)
        }
        (Law::FirstOrder, _) => by("ramp", kinetics, p, drive, dt, 1),
        _ => {
            let stiffness = dt.0 * kinetics.contraction(drive.mean())[1];
            by("radau-iia-5", kinetics, p, drive, dt, (30.0 * stiffness).clamp(8.0, 6000.0) as u32)
        }
    })
}

fn by(name: &str, kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds, substeps: u32) -> f64 {
    Method::named(name)
        .map_or(f64::NAN, |method| frame(method, Work::Substeps(substeps), kinetics, p, drive, dt))
}

/// Below this, a negative p is rounding.
const ROUNDING: f64 = 1e-12;

fn failure(start: f64, path: &[f64], truth: &[f64]) -> Option<Failure> {
    let any = |wrong: &dyn Fn(f64) -> bool| path.iter().any(|&p| wrong(p));
    if any(&|p| p.abs() > 2.0 || p.is_nan()) {
        return Some(Failure::BlowUp);
    }
    if any(&|p| p < -ROUNDING) {
        return Some(Failure::Negative);
    }
    if any(&|p| p > 1.0 + ROUNDING) || swings(path, truth) {
        return Some(Failure::Ringing);
    }
    let moves = |path: &[f64]| path.iter().map(|p| (p - start).abs()).fold(0.0, f64::max);
    (moves(path) == 0.0 && moves(truth) > 1e-3).then_some(Failure::Frozen)
}

/// Whether p turns back on three frames running, by more than the budget, while the truth goes one
/// way.
fn swings(path: &[f64], truth: &[f64]) -> bool {
    let turns =
        |of: &[f64]| of.windows(3).map(|p| (p[1] - p[0]) * (p[2] - p[1])).collect::<Vec<f64>>();
    let far = |of: &[f64]| of.windows(2).all(|p| (p[1] - p[0]).abs() > BUDGET);
    let (found, meant) = (turns(path), turns(truth));
    (3..=found.len()).any(|end| {
        let last = end - 3..end;
        let alternates =
            found[last.clone()].iter().all(|&turn| turn < 0.0) && far(&path[end - 3..end + 2]);
        alternates && meant[last].iter().all(|&turn| turn >= 0.0)
    })
}

/// Places advanced side by side, so that a processor can overlap them as it does over a picture;
/// fewer where each takes long, so that a run ends before the system takes the processor away.
const PLACES: [usize; 2] = [16, 4];

/// Nanoseconds for one frame of one place, as a run calls a method: once per place and sub-step.
fn cost(kinetics: &Kinetics, scene: &Scene, method: &Method, work: Work) -> f64 {
    let stride = scene.frames.len().div_ceil(64);
    let frames: Vec<(Drive, Seconds)> = scene.frames.iter().copied().step_by(stride).collect();
    let places = PLACES[usize::from(!matches!(work, Work::Substeps(1 | 2)))];
    let mut state = [scene.start; PLACES[0]];
    let elapsed = nanoseconds(|| {
        let row = &mut black_box(&mut state)[..places];
        row.fill(scene.start);
        for &(drive, dt) in &frames {
            for p in row.iter_mut() {
                *p = frame(method, work, kinetics, *p, drive, dt);
            }
        }
        black_box(row);
    });
    elapsed / (places * frames.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::super::scenes::scenes;
    use super::*;

    /// Points of a method under the first-order law on a scene.
    fn of<'a>(all: &'a [Untimed], scene: &str, method: &str) -> Vec<&'a Point> {
        let points = all.iter().map(|of| &of.point);
        let first_order = points.filter(|point| point.law == Law::FirstOrder);
        first_order.filter(|point| point.scene == scene && point.method.name == method).collect()
    }

    #[test]
    fn the_exact_step_is_exact_wherever_light_is_held_and_explicit_ones_die_in_the_sun() {
        let scenes = scenes();
        let all = errors(&scenes, &mut |_| {});
        let held = scenes.iter().filter(|scene| scene.name != "ramp");
        for scene in held {
            let exact = of(&all, scene.name, "exact");
            assert_eq!(exact.len(), 1);
            assert!(
                exact[0].max_abs_error <= 1e-14 && exact[0].failure.is_none(),
                "{}",
                scene.name
            );
        }
        let sun = of(&all, "sun-glance", "forward-euler");
        assert!(sun.iter().all(|point| point.failure == Some(Failure::BlowUp)));
        let indoor = of(&all, "indoor", "forward-euler");
        assert!(indoor.iter().all(|point| point.failure.is_none() && point.max_abs_error < 1e-6));
        let bound = 0.197 / 24.0 / 120.0;
        let ramp = of(&all, "ramp", "exact")[0].max_abs_error;
        assert!(ramp <= bound && ramp > 0.99 * bound, "{ramp:e} against {bound:e}");
    }
}
