//! The law on arrays, in double precision.

use numpy::ndarray::{ArrayD, ArrayViewD, Dimension, IxDyn, iter::Iter};
use numpy::{PyArray, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sungaze::kernel::{self, Exposures};
use sungaze::kinetics::Law;

use crate::arrays::required;
use crate::errors::refused;

/// Unbleached fraction of a pigment after steady light, from any start: the exact step on arrays.
///
/// First order (Rushton & Henry 1968): dp/dt = (1 - p)/tau - (I/I0) p/tau, solved in closed form, to
/// 1e-15. `self-screened` and `rate-limited` have no closed form: they take as many steps as prove an
/// error below 1e-6.
///
/// Parameters
/// ----------
/// trolands : array_like
///     Light on the retina, td, 0 or more.
/// seconds : array_like
///     How long it lasts, s, 0 or more; `inf` leaves the steady state.
/// start : array_like
///     Unbleached fraction at the start, 0 to 1.
/// half_bleach_log_td : array_like
///     log10 of the light in td that leaves half of the pigment in the steady state.
/// tau_s : array_like
///     Time constant of regeneration, s.
/// law : {"first-order", "self-screened", "rate-limited"}
/// optical_density : float
///     Peak optical density, for `self-screened`.
/// km : float
///     Half-saturation of regeneration, for `rate-limited`.
///
/// Returns
/// -------
/// float or ndarray of float64
///     Of the shape that the arrays broadcast to.
///
/// Examples
/// --------
/// Half of the pigment is gone under the half-bleach light, and back after five minutes in the dark:
///
/// >>> import numpy as np
/// >>> import sungaze
/// >>> round(sungaze.unbleached(10**4.3, np.inf), 9)
/// 0.5
/// >>> sungaze.unbleached(0, [0, 60, 300], start=0.5).round(3)
/// array([0.5  , 0.697, 0.959])
#[pyfunction]
#[pyo3(
    signature = (trolands, seconds, start=None, half_bleach_log_td=None, tau_s=None,
                 law="first-order", *, optical_density=0.5, km=0.2),
    text_signature = "(trolands, seconds, start=1.0, half_bleach_log_td=4.3, tau_s=120.0, law='first-order', *, optical_density=0.5, km=0.2)"
)]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn unbleached<'py>(
    py: Python<'py>,
    trolands: &Bound<'py, PyAny>,
    seconds: &Bound<'py, PyAny>,
    start: Option<&Bound<'py, PyAny>>,
    half_bleach_log_td: Option<&Bound<'py, PyAny>>,
    tau_s: Option<&Bound<'py, PyAny>>,
    law: &str,
    optical_density: f64,
    km: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let law = law_of(law, optical_density, km)?;
    let operands = [
        operand("start", start, 1.0, |p| (0.0..=1.0).contains(&p), "fractions from 0 to 1")?,
        operand("trolands", Some(trolands), 0.0, is_light, "finite light, 0 or more")?,
        operand("seconds", Some(seconds), 0.0, |s| s >= 0.0, "seconds, 0 or more")?,
        half_bleach(half_bleach_log_td)?,
        operand("tau_s", tau_s, 120.0, is_scale, "finite seconds above 0")?,
    ];
    each(py, &operands, |exposures, out| kernel::unbleached(law, exposures, out))
}

/// Unbleached fraction of a pigment that lasts under steady light.
///
/// First order: 1/(1 + I/I0), equation 1 of Gutierrez et al. 2005 as 1 - B.
///
/// Parameters
/// ----------
/// trolands : array_like
///     Light on the retina, td, 0 or more.
/// half_bleach_log_td, law, optical_density, km
///     As for :func:`unbleached`.
///
/// Returns
/// -------
/// float or ndarray of float64
///     Of the shape that the arrays broadcast to.
///
/// Examples
/// --------
/// >>> import sungaze
/// >>> sungaze.steady([0.0, 1e3, 1e9]).round(4)
/// array([1.    , 0.9523, 0.    ])
#[pyfunction]
#[pyo3(
    signature = (trolands, half_bleach_log_td=None, law="first-order", *,
                 optical_density=0.5, km=0.2),
    text_signature = "(trolands, half_bleach_log_td=4.3, law='first-order', *, optical_density=0.5, km=0.2)"
)]
pub(crate) fn steady<'py>(
    py: Python<'py>,
    trolands: &Bound<'py, PyAny>,
    half_bleach_log_td: Option<&Bound<'py, PyAny>>,
    law: &str,
    optical_density: f64,
    km: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let law = law_of(law, optical_density, km)?;
    let one = || ArrayD::from_elem(IxDyn(&[]), 1.0);
    let light = operand("trolands", Some(trolands), 0.0, is_light, "finite light, 0 or more")?;
    let operands = [one(), light, one(), half_bleach(half_bleach_log_td)?, one()];
    each(py, &operands, |exposures, out| kernel::steady_each(law, exposures, out))
}

fn law_of(name: &str, optical_density: f64, km: f64) -> PyResult<Law> {
    let positive = |name: &str, value: f64| match is_scale(value) {
        true => Ok(value),
        false => Err(refused(name, value, "a finite number above 0")),
    };
    let Some((_, law)) = Law::NAMES.iter().find(|(of, _)| *of == name) else {
        let accepted = Law::NAMES.map(|(name, _)| name).join(", ");
        return Err(refused("law", format!("{name:?}"), &accepted));
    };
    Ok(law.with(positive("optical_density", optical_density)?, positive("km", km)?))
}

fn is_light(td: f64) -> bool {
    td.is_finite() && td >= 0.0
}

fn is_scale(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

fn half_bleach(log_td: Option<&Bound<'_, PyAny>>) -> PyResult<ArrayD<f64>> {
    let accepted = "log10 of light in td, -100 to 100";
    let within = |log: f64| (-100.0..=100.0).contains(&log);
    let log_td = operand("half_bleach_log_td", log_td, 4.3, within, accepted)?;
    Ok(log_td.mapv_into(|log| 10f64.powf(log)))
}

/// An argument as an array, every value of which is accepted.
fn operand(
    name: &str,
    given: Option<&Bound<'_, PyAny>>,
    default: f64,
    accepts: impl Fn(f64) -> bool,
    accepted: &str,
) -> PyResult<ArrayD<f64>> {
    let Some(given) = given else { return Ok(ArrayD::from_elem(IxDyn(&[]), default)) };
    let array = required(given, Some("float64"))?;
    let array = array.cast::<PyArrayDyn<f64>>()?.try_readonly()?;
    let values = array.as_array();
    if values.iter().all(|value| accepts(*value)) {
        return Ok(values.to_owned());
    }
    let wrong = values.indexed_iter().find(|(_, value)| !accepts(**value));
    let found = wrong.map_or_else(String::new, |(at, value)| match at.slice() {
        [] => value.to_string(),
        at => format!("{value} at index {at:?}"),
    });
    Err(refused(name, found, accepted))
}

/// How many values are computed at a time.
const RUN: usize = 256;

/// The values of start, light, seconds, half bleach and tau, broadcast to one shape.
fn each<'py>(
    py: Python<'py>,
    operands: &[ArrayD<f64>; 5],
    compute: impl Fn(Exposures<'_>, &mut [f64]) + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    let shapes = PyTuple::new(py, operands.each_ref().map(|operand| operand.shape()))?;
    let shape: Vec<usize> = numpy.call_method1("broadcast_shapes", shapes)?.extract()?;
    let mut out = ArrayD::zeros(IxDyn(&shape));
    let values = out.as_slice_mut().unwrap_or_default();
    py.detach(|| {
        let mut runs = operands.each_ref().map(|operand| Run::of(operand, &shape));
        for out in values.chunks_mut(RUN) {
            let n = out.len();
            let [start, light, seconds, half_bleach, tau] = runs.each_mut().map(|run| run.next(n));
            compute(Exposures { start, light, seconds, half_bleach, tau }, out);
        }
    });
    match shape.is_empty() {
        true => Ok(out.sum().into_pyobject(py)?.into_any()),
        false => Ok(PyArray::from_owned_array(py, out).into_any()),
    }
}

/// The values of one array that is broadcast, run after run.
struct Run<'a> {
    from: Values<'a>,
    room: Box<[f64; RUN]>,
}

enum Values<'a> {
    Constant,
    Slice(&'a [f64]),
    Each(Iter<'a, f64, IxDyn>),
}

impl<'a> Run<'a> {
    fn of(array: &'a ArrayD<f64>, shape: &[usize]) -> Self {
        let mut room = Box::new([0.0; RUN]);
        let whole = array.as_slice().filter(|_| array.shape() == shape);
        let from = match (array.len(), whole) {
            (1, _) => {
                room.fill(array.sum());
                Values::Constant
            }
            (_, Some(slice)) => Values::Slice(slice),
            _ => Values::Each(broadcast(array, shape).into_iter()),
        };
        Run { from, room }
    }

    fn next(&mut self, n: usize) -> &[f64] {
        match &mut self.from {
            Values::Constant => &self.room[..n],
            Values::Slice(slice) => slice.split_off(..n).unwrap_or_default(),
            Values::Each(values) => {
                for (room, value) in self.room[..n].iter_mut().zip(values) {
                    *room = *value;
                }
                &self.room[..n]
            }
        }
    }
}

fn broadcast<'a>(array: &'a ArrayD<f64>, shape: &[usize]) -> ArrayViewD<'a, f64> {
    array.broadcast(IxDyn(shape)).unwrap_or_else(|| array.view())
}
