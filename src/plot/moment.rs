//! Moments: what a place showed at times that a table tells, and what it did between them.
//!
//! Pigment goes by the law ([`super::course`]) where the law leads from one row to the next. Percepts are
//! told at the ends of frames. Between two ends under the same light each class of cones catches
//!
//! ```text
//! catch(p) ~ 1 - 10^(-D p)
//! ```
//!
//! with the effective density D that leads from the one to the other ([`density`]).

use crate::colour::{self, Matrix, chromaticity};
use crate::kinetics::Kinetics;

use super::axes::{Axis, Panel};
use super::course::{Held, moments};
use super::palette::BLACK;
use super::sheet::{Anchor, Sheet};

/// What a place shows at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// s
    pub(crate) time: f64,
    /// Cone illuminance until then, td.
    pub(crate) light: [f64; 3],
    /// Unbleached fractions.
    pub(crate) p: [f64; 3],
    /// The percept, cd/m2; NaN where it is not known.
    pub(crate) xyz: [f64; 3],
}

/// What cones make of light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cones {
    pub(crate) kinetics: [Kinetics; 3],
    /// Catches of L, M and S to XYZ.
    pub(crate) lms_to_xyz: Matrix,
}

/// Samples of a curve over the whole length of an axis.
const SAMPLES: usize = 220;
/// Luminances below this share of the greatest are not drawn.
const DARKEST: f64 = 1e-8;

impl Moment {
    pub(crate) fn bleached(&self, k: usize) -> f64 {
        1.0 - self.p[k]
    }

    pub(crate) fn chromaticity(&self, i: usize) -> f64 {
        chromaticity(self.xyz)[i]
    }

    fn has_light_of(&self, other: &Moment) -> bool {
        self.light.iter().zip(other.light).all(|(a, b)| (a - b).abs() <= 1e-6 * a.abs())
    }
}

/// The rows of a table, and between them what pigment and percept did. A row at 0 s tells the start;
/// without one it is all pigment, if the law then leads to the first row.
pub(crate) fn course(rows: &[Moment], cones: &Cones, axis: &Axis) -> Vec<Moment> {
    let Some(&end) = rows.first() else { return Vec::new() };
    let rested = Moment { time: 0.0, p: [1.0; 3], ..end };
    let starts = end.time > 0.0 && follows(&rested, &end, cones);
    let first = if starts { Moment { xyz: start(rows, cones), ..rested } } else { end };
    let mut course = vec![first];
    for to in &rows[usize::from(!starts)..] {
        let from = course[course.len() - 1];
        course.extend(within(&from, to, cones, axis));
    }
    course
}

/// The percept of all pigment under the light of the first row, where a second row under the same
/// light tells how catches fall with pigment; else NaN.
fn start(rows: &[Moment], cones: &Cones) -> [f64; 3] {
    let [first, second, ..] = rows else { return [f64::NAN; 3] };
    // Little that is left, or two rows alike, tell too little of what all pigment would catch.
    let tells = |k: usize| {
        let apart = (first.p[k] - second.p[k]).abs();
        first.p[k] > 0.9 || (first.p[k] >= 0.1 && apart > 0.02)
    };
    if !first.has_light_of(second) || !(0..3).all(tells) {
        return [f64::NAN; 3];
    }
    let densities = densities(first, second, cones);
    let caught = cones.catches(first.xyz);
    let whole =
        [0, 1, 2].map(|k| caught[k] * share(1.0, densities[k]) / share(first.p[k], densities[k]));
    colour::apply(&cones.lms_to_xyz, whole)
}

fn held(from: &Moment, to: &Moment, k: usize) -> Held {
    Held { from: from.time, to: to.time, p: from.p[k], light: to.light[k] }
}

/// Whether the law leads from one moment to the other: not where the gaze moved, or where frames
/// were left out.
fn follows(from: &Moment, to: &Moment, cones: &Cones) -> bool {
    (0..3).all(|k| (held(from, to, k).end(&cones.kinetics[k]) - to.p[k]).abs() < 2e-3)
}

/// The moments of a frame after its start: by the law, or its end alone where the law does not lead
/// there.
fn within(from: &Moment, to: &Moment, cones: &Cones, axis: &Axis) -> Vec<Moment> {
    if !follows(from, to, cones) {
        return vec![*to];
    }
    let mut times = moments(axis, from.time, to.time, SAMPLES);
    times.pop();
    let p = [0, 1, 2].map(|k| held(from, to, k).fractions(&cones.kinetics[k], &times));
    let is_known = from.has_light_of(to) && from.xyz[1].is_finite();
    let (densities, caught) = (densities(from, to, cones), cones.catches(to.xyz));
    let at = |(i, &time): (usize, &f64)| {
        let p = [0, 1, 2].map(|k| p[k][i]);
        let now = |k: usize| caught[k] * share(p[k], densities[k]) / share(to.p[k], densities[k]);
        let xyz = if is_known {
            colour::apply(&cones.lms_to_xyz, [0, 1, 2].map(now))
        } else {
            [f64::NAN; 3]
        };
        Moment { time, p, xyz, ..*to }
    };
    times.iter().enumerate().map(at).chain([*to]).collect()
}

impl Cones {
    fn catches(&self, xyz: [f64; 3]) -> [f64; 3] {
        colour::apply(&colour::inverse(&self.lms_to_xyz), xyz)
    }
}

/// What a pigment of density D catches of the light where a share p of it is left.
fn share(p: f64, density: f64) -> f64 {
    -(-density * std::f64::consts::LN_10 * p).exp_m1()
}

fn densities(from: &Moment, to: &Moment, cones: &Cones) -> [f64; 3] {
    let caught = [from, to].map(|at| cones.catches(at.xyz));
    [0, 1, 2].map(|k| density([from.p[k], to.p[k]], caught[1][k] / caught[0][k]))
}

/// Effective densities of an eye lie between these.
const DENSITIES: [f64; 2] = [1e-3, 3.0];

/// The density by which a catch changes by `ratio` from the first to the second share of pigment; a
/// usual one where that cannot be told.
fn density([from, to]: [f64; 2], ratio: f64) -> f64 {
    if (from - to).abs() < 1e-9 || !(ratio.is_finite() && ratio > 0.0) {
        return 0.3;
    }
    // The denser the pigment, the less a catch follows it: the ratio goes from to/from to 1.
    let is_below = |density: f64| {
        let found = share(to, density) / share(from, density);
        if to < from { found < ratio } else { found > ratio }
    };
    let halved = (0..50).fold(DENSITIES, |[low, high], _| {
        let middle = 0.5 * (low + high);
        if is_below(middle) { [middle, high] } else { [low, middle] }
    });
    0.5 * (halved[0] + halved[1])
}

/// Powers of ten where luminance spans more than a factor of 20, else even steps from 0.
pub(crate) fn luminance_axis(values: impl Iterator<Item = f64>) -> Axis<'static> {
    let seen: Vec<f64> = values.filter(|y| y.is_finite() && *y > 0.0).collect();
    let most = seen.iter().copied().fold(0.0, f64::max);
    let least = seen.iter().copied().fold(most, f64::min).max(DARKEST * most);
    let label = "Y of the percept (cd/m²)";
    if most == 0.0 || most <= 20.0 * least {
        return Axis::linear(0.0, most, 5.0, label);
    }
    let [from, to] = [least.log10().floor(), most.log10().ceil()].map(|e| 10f64.powf(e));
    Axis::logarithmic(from, to, 5.0, label)
}

/// Says above a panel why its lines break, if they do. Black alone has no chromaticity.
pub(crate) fn note_breaks(sheet: &mut Sheet, panel: &Panel, values: impl Iterator<Item = f64>) {
    let (black, outside): (Vec<f64>, Vec<f64>) =
        values.filter(|v| !panel.y.holds(*v)).partition(|v| v.is_nan() || *v == 0.0);
    let words = match (black.is_empty(), outside.is_empty()) {
        (true, true) => return,
        (true, false) => "breaks: outside the panel",
        (false, true) => "breaks: black",
        (false, false) => "breaks: outside or black",
    };
    sheet.text((panel.right(), panel.top - 6.0), words, 12, Anchor::End, BLACK);
}

#[cfg(test)]
mod tests {
    use super::*;

    const LMS_TO_XYZ: Matrix = [[1.94, -1.35, 0.36], [0.69, 0.35, 0.0], [0.0, 0.0, 1.93]];
    const LIGHT: [f64; 3] = [1.1e5, 1e5, 3e4];

    fn cones() -> Cones {
        Cones { kinetics: Kinetics::standard(), lms_to_xyz: LMS_TO_XYZ }
    }

    /// A rested eye under the light; cones catch by bands of several densities.
    fn at(time: f64, densities: &[f64]) -> Moment {
        let p = [0, 1, 2].map(|k| {
            let held = Held { from: 0.0, to: time, p: 1.0, light: LIGHT[k] };
            held.end(&cones().kinetics[k])
        });
        let caught = p.map(|p| densities.iter().map(|density| share(p, *density)).sum::<f64>());
        Moment { time, light: LIGHT, p, xyz: colour::apply(&LMS_TO_XYZ, caught) }
    }

    fn worst(densities: &[f64]) -> f64 {
        let rows = [3.0, 30.0, 300.0].map(|time| at(time, densities));
        let course = course(&rows, &cones(), &Axis::logarithmic(0.1, 300.0, 5.0, ""));
        assert_eq!(course[0].time, 0.0);
        let apart = |found: &Moment| {
            let true_y = at(found.time, densities).xyz[1];
            (found.xyz[1] / true_y - 1.0).abs()
        };
        course.iter().map(apart).fold(0.0, f64::max)
    }

    #[test]
    fn percepts_between_rows_and_back_to_the_start_are_those_of_the_pigment_then() {
        assert!(worst(&[0.38]) < 1e-6, "{}", worst(&[0.38]));
        let mixed = worst(&[0.05, 0.2, 0.5]);
        assert!(mixed < 0.02, "{mixed}");
    }

    #[test]
    fn the_start_is_not_guessed_from_rows_that_have_little_pigment_left() {
        let rows = [1e3, 1e4].map(|time| at(time, &[0.3]));
        let course = course(&rows, &cones(), &Axis::logarithmic(0.1, 1e4, 5.0, ""));
        let known = course.iter().find(|moment| moment.xyz[1].is_finite());
        assert_eq!(known.map(|moment| moment.time), Some(1e3));
    }

    #[test]
    fn a_percept_is_not_made_up_where_light_has_changed() {
        let [lit, mut dark] = [30.0, 300.0].map(|time| at(time, &[0.3]));
        dark.light = [0.0; 3];
        dark.p = [0, 1, 2].map(|k| {
            let held = Held { from: 30.0, to: 300.0, p: lit.p[k], light: 0.0 };
            held.end(&cones().kinetics[k])
        });
        dark.xyz = [0.0; 3];
        let course = course(&[lit, dark], &cones(), &Axis::linear(0.0, 300.0, 5.0, ""));
        let known = course.iter().filter(|moment| moment.xyz[1].is_finite());
        assert_eq!(known.map(|moment| moment.time).collect::<Vec<_>>(), [30.0, 300.0]);
    }
}
