//! Moments: what a place showed at times that a table tells, and what it did between them.
//!
//! Pigment goes by the law ([`super::course`]) where the law leads from one row to the next. A percept is
//! known at the ends of frames; between two ends under the same light it goes as far as the catches
//! of its pigments have gone.

use crate::colour::chromaticity;
use crate::kinetics::Kinetics;

use super::axes::{Axis, Panel};
use super::course::{Held, moments};
use super::palette::BLACK;
use super::sheet::{Anchor, Sheet};

/// What a place shows at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// s
    pub time: f64,
    /// Cone illuminance until then, td.
    pub light: [f64; 3],
    /// Unbleached fractions.
    pub p: [f64; 3],
    /// The percept, cd/m2; NaN where it is not known.
    pub xyz: [f64; 3],
}

/// Samples of a curve over the whole length of an axis.
const SAMPLES: usize = 220;
/// Luminances below this share of the greatest are not drawn.
const DARKEST: f64 = 1e-8;

impl Moment {
    pub fn bleached(&self, k: usize) -> f64 {
        1.0 - self.p[k]
    }

    pub fn chromaticity(&self, i: usize) -> f64 {
        chromaticity(self.xyz)[i]
    }

    /// Under a light that has just changed, a percept is known at the frame's end only.
    fn without_percept(self, end: &Moment) -> Self {
        if self.time < end.time { Moment { xyz: [f64::NAN; 3], ..self } } else { self }
    }

    fn has_light_of(&self, other: &Moment) -> bool {
        self.light.iter().zip(other.light).all(|(a, b)| (a - b).abs() <= 1e-6 * a.abs())
    }
}

/// The rows of a table, and between them what pigment and percept did. A row at 0 s tells the start;
/// without one it is all pigment, if the law then leads to the first row.
pub fn course(rows: &[Moment], kinetics: &[Kinetics; 3], axis: &Axis) -> Vec<Moment> {
    let Some(&end) = rows.first() else { return Vec::new() };
    let rested = Moment { time: 0.0, p: [1.0; 3], xyz: [f64::NAN; 3], ..end };
    let starts = end.time > 0.0 && follows(&rested, &end, kinetics);
    let mut course = vec![if starts { rested } else { end }];
    if starts {
        course.extend(within(&rested, &end, kinetics, axis));
    }
    for pair in rows.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        let frame = within(from, to, kinetics, axis).into_iter();
        let lasts = from.has_light_of(to);
        course.extend(frame.map(|at| if lasts { at } else { at.without_percept(to) }));
    }
    course
}

fn held(from: &Moment, to: &Moment, k: usize) -> Held {
    Held { from: from.time, to: to.time, p: from.p[k], light: to.light[k] }
}

/// Whether the law leads from one moment to the other: not where the gaze moved, or where frames
/// were left out.
fn follows(from: &Moment, to: &Moment, kinetics: &[Kinetics; 3]) -> bool {
    (0..3).all(|k| (held(from, to, k).end(&kinetics[k]) - to.p[k]).abs() < 2e-3)
}

/// The moments of a frame after its start: by the law, or its end alone where the law does not lead
/// there.
fn within(from: &Moment, to: &Moment, kinetics: &[Kinetics; 3], axis: &Axis) -> Vec<Moment> {
    if !follows(from, to, kinetics) {
        return vec![*to];
    }
    let mut times = moments(axis, from.time, to.time, SAMPLES);
    times.pop();
    let p = [0, 1, 2].map(|k| held(from, to, k).fractions(&kinetics[k], &times));
    let at = |(i, &time): (usize, &f64)| {
        let p = [0, 1, 2].map(|k| p[k][i]);
        Moment { time, p, xyz: percept(from, to, p), ..*to }
    };
    times.iter().enumerate().map(at).chain([*to]).collect()
}

/// Optical density of cones about their peak, by which a catch falls with its pigment.
const DENSITY: f64 = 0.5;

/// The percept at `p` between two ends under the same light: as far on its way as the catches of
/// the cones are together, each a share 1 - 10^(-D p) of the light.
fn percept(from: &Moment, to: &Moment, p: [f64; 3]) -> [f64; 3] {
    let catch = |p: f64| 1.0 - 10f64.powf(-DENSITY * p);
    let apart = |p: [f64; 3]| -> f64 {
        p.iter().zip(to.p).map(|(p, end)| (catch(*p) - catch(end)).abs()).sum()
    };
    let left = apart(p) / apart(from.p).max(f64::MIN_POSITIVE);
    [0, 1, 2].map(|i| to.xyz[i] + left * (from.xyz[i] - to.xyz[i]))
}

/// Powers of ten where luminance spans more than a factor of 20, else even steps from 0.
pub fn luminance_axis(values: impl Iterator<Item = f64>) -> Axis<'static> {
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
pub fn note_breaks(sheet: &mut Sheet, panel: &Panel, values: impl Iterator<Item = f64>) {
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
