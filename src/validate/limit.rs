//! The steady state of the paper's Eq. 1 as the limit of long exposure, on uniform fields.
//!
//! ```text
//! |p(T) - p(inf)| = |p(0) - p(inf)| e^(-lambda T),     lambda = (1 + I/I0)/tau        first order
//!                 ~ e^(-lambda T),                     lambda = -d(dp/dt)/dp at rest  the other laws, near the end
//! ```
//!
//! `tracked` is walked frame by frame beside `steady`, through the code that a run uses; the rate
//! is fitted to what was measured, by least squares on the logarithm, where the error is above
//! rounding.

use rayon::prelude::*;

use crate::constants::CONSTANTS;
use crate::error::Result;
use crate::eye::pigment::{Model, PigmentStep};
use crate::kinetics::{Kinetics, Law};
use crate::observer::{CONES, Observer};
use crate::spectrum::Curve;
use crate::step;
use crate::units::{Seconds, Trolands};

use super::{Check, PAPER, STANDARD, Subject};

/// Decades of light, log10 td.
const DECADES: std::ops::RangeInclusive<i32> = 0..=10;

/// Unbleached fractions to start from.
pub(super) const STARTS: [f64; 3] = [1.0, 0.0, 0.5];

/// Length of a frame, and of the whole walk, in units of 1/lambda.
const FRAME: f64 = 0.02;
const WALK: f64 = 40.0;

/// Errors that the fit uses: above rounding, and small enough for a law that is not linear to be at
/// its end.
const FITTED: (f64, f64) = (1e-9, 1e-5);

/// The error of the steady state at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fall {
    pub(crate) time: f64,
    pub(crate) error: f64,
    p: f64,
}

/// One field of light, and how the error of the steady state falls on it.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub(crate) light: f64,
    pub(crate) start: f64,
    /// Theory's rate, 1/s.
    pub(crate) rate: f64,
    /// The rate of the measured fall, 1/s.
    pub(crate) fitted: f64,
    pub(crate) falls: Vec<Fall>,
}

/// The exact method as a run uses it.
pub(super) fn tracked() -> Model {
    let exact = step::EXACT;
    Model::Tracked { method: exact, substeps: 1, budget: 1e-3 }
}

/// One place under held light after one frame.
fn after(pigment: &Kinetics, model: Model, light: f64, duration: f64, p: f64) -> f64 {
    let pigments = [*pigment; 3];
    let mut row = [p];
    PigmentStep::new(pigments, model, Seconds(duration)).cone(0, &[light as f32], &mut row);
    row[0]
}

/// Walks `tracked` beside `steady` over frames of held light.
fn walk(pigment: &Kinetics, light: f64, start: f64) -> Field {
    let steady = after(pigment, Model::Steady, light, 1.0, start);
    let rate = -pigment.slope(steady, Trolands(light));
    let frame = FRAME / rate;
    let mut falls = vec![Fall { time: 0.0, error: (start - steady).abs(), p: start }];
    let mut p = start;
    for n in 1..=(WALK / FRAME) as usize {
        p = after(pigment, tracked(), light, frame, p);
        falls.push(Fall { time: n as f64 * frame, error: (p - steady).abs(), p });
    }
    let fitted = fit(falls.iter().map(|fall| (fall.time, fall.error)), span(pigment));
    Field { light, start, rate, fitted, falls }
}

fn span(pigment: &Kinetics) -> (f64, f64) {
    if pigment.law == Law::FirstOrder { (FITTED.0, 1.0) } else { FITTED }
}

/// The rate of an exponential fall, 1/s: minus the slope of the line through its logarithms.
pub(super) fn fit(falls: impl Iterator<Item = (f64, f64)>, (least, most): (f64, f64)) -> f64 {
    let points: Vec<_> =
        falls.filter(|f| f.1 > least && f.1 < most).map(|(t, e)| (t, e.ln())).collect();
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (t, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - t) * (p.1 - y)).sum();
    -covariance / points.iter().map(|p| (p.0 - t).powi(2)).sum::<f64>()
}

/// Every decade of light from every start.
pub(super) fn fields(pigment: &Kinetics) -> Vec<Field> {
    let cases: Vec<_> =
        DECADES.flat_map(|decade| STARTS.map(|start| (10f64.powi(decade), start))).collect();
    cases.into_par_iter().map(|(light, start)| walk(pigment, light, start)).collect()
}

/// The value that is farthest from `from`; NaN is farther than anything.
pub(super) fn worst(values: impl Iterator<Item = f64>, from: f64) -> f64 {
    let farther = |a: f64, b: f64| if (b - from).abs() <= (a - from).abs() { a } else { b };
    values.fold(from, farther)
}

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let mut checks = standard_rates(subject)?;
    for set in CONSTANTS {
        checks.extend(of_set(subject, set.name)?);
    }
    for (preset, name) in [(STANDARD, "standard"), (PAPER, "paper")] {
        for narrowing in ["depleted", "narrowed"] {
            let toml = format!("{preset}\nobserver.narrowing = {narrowing:?}");
            checks.push(of_catch(
                &subject.config(&toml)?.observer(),
                &subject.pigments(&toml)?[0],
                name,
                narrowing,
            ));
        }
    }
    Ok(checks)
}

/// The fitted rates of the standard L cone, light by light, against numbers: (1 + I/10^4.3)/120.
fn standard_rates(subject: &Subject) -> Result<Vec<Check>> {
    let fields = fields(&subject.pigments(STANDARD)?[0]);
    let check = |decade: i32| {
        let light = 10f64.powi(decade);
        let expected = (1.0 + light / 10f64.powf(4.3)) / 120.0;
        let measured =
            worst(fields.iter().filter(|f| f.light == light).map(|f| f.fitted), expected);
        let name = format!("rate of fall, 1/s, standard, 1e{decade} td, worst of 3 starts");
        Check::new(name, "(1 + I/I0)/tau", measured, expected, 1e-6 * expected)
    };
    Ok(DECADES.map(check).collect())
}

/// Rate and last error of a named set: the worst of all lights, starts and cones.
fn of_set(subject: &Subject, set: &str) -> Result<[Check; 2]> {
    let pigments = subject.pigments(&format!("observer.constants = {set:?}"))?;
    let all: Vec<Field> = [0, 2].iter().flat_map(|&k: &usize| fields(&pigments[k])).collect();
    let linear = pigments[0].law == Law::FirstOrder;
    let (theory, tolerance) =
        if linear { ("(1 + I/I0)/tau", 1e-6) } else { ("slope at the steady state", 1e-3) };
    let ratio = worst(all.iter().map(|f| f.fitted / f.rate), 1.0);
    let last = worst(all.iter().filter_map(|f| f.falls.last()).map(|f| f.error), 0.0);
    let (lights, what) = ("1 to 1e10 td, 3 starts", set);
    Ok([
        Check::new(format!("rate over theory, {what}, {lights}"), theory, ratio, 1.0, tolerance),
        Check::new(
            format!("error after {WALK}/rate, {what}, {lights}"),
            "rounding of p",
            last,
            0.0,
            1e-14,
        ),
    ])
}

/// Rate at which a catch approaches that of the steady state: for either narrowing the pigment's
/// own.
fn of_catch(observer: &Observer, pigment: &Kinetics, preset: &str, narrowing: &str) -> Check {
    let light = Curve::sampled(|nm| (-((nm - 600.0) / 60.0).powi(2)).exp());
    let catch = |p: f64| observer.catch(&light, [p, 1.0, 1.0])[0];
    let ratio = |field: &Field| {
        let end = catch(pigment.steady(Trolands(field.light)));
        let late = field.falls.iter().filter(|f| (1e-8..1e-5).contains(&f.error)).step_by(40);
        let falls = late.map(|f| (f.time, (catch(f.p) / end - 1.0).abs()));
        fit(falls, (0.0, 1e-3)) / field.rate
    };
    let fields: Vec<Field> =
        fields(pigment).into_iter().filter(|f| (1e2..=1e8).contains(&f.light)).collect();
    let ratios: Vec<f64> = fields.par_iter().map(ratio).collect();
    let name =
        format!("rate of fall of {}'s catch over theory, preset {preset}, {narrowing}", CONES[0]);
    Check::new(name, "(1 + I/I0)/tau", worst(ratios.into_iter(), 1.0), 1.0, 1e-3)
}
