//! Arrays in: whatever NumPy can make an array of, without a copy where its samples will do.

use half::f16;
use numpy::ndarray::ArrayView3;
use numpy::{
    PyArray3, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray3, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use sungaze::error::Result as Looked;
use sungaze::eye::{Eye, Gaze, Look};
use sungaze::units::Seconds;

use crate::config::described;
use crate::errors::refused;

/// A frame of shape (h, w, planes), half or float.
pub(crate) enum Frame<'py> {
    Half(PyReadonlyArray3<'py, f16>),
    Float(PyReadonlyArray3<'py, f32>),
}

/// The same without Python's lock.
pub(crate) enum FrameView<'a> {
    Half(ArrayView3<'a, f16>),
    Float(ArrayView3<'a, f32>),
}

impl<'py> Frame<'py> {
    /// The frame that an object holds. Doubles and foreign byte orders become native floats.
    pub(crate) fn of(given: &Bound<'py, PyAny>) -> PyResult<Frame<'py>> {
        let array = required(given, None)?;
        if let Ok(half) = array.cast::<PyArray3<f16>>() {
            return Ok(Frame::Half(half.try_readonly()?));
        }
        if let Ok(float) = array.cast::<PyArray3<f32>>() {
            return Ok(Frame::Float(float.try_readonly()?));
        }
        if array.dtype().kind() != b'f' || array.ndim() != 3 {
            let found = format!("{} of {} dimensions", array.dtype(), array.ndim());
            let accepted = "float16, float32 or float64 of shape (h, w, planes), scene-linear";
            return Err(refused("frame", found, accepted));
        }
        let float = required(array.as_any(), Some("float32"))?;
        Ok(Frame::Float(float.cast::<PyArray3<f32>>()?.try_readonly()?))
    }

    /// Its samples.
    pub(crate) fn view(&self) -> FrameView<'_> {
        match self {
            Frame::Half(frame) => FrameView::Half(frame.as_array()),
            Frame::Float(frame) => FrameView::Float(frame.as_array()),
        }
    }
}

impl FrameView<'_> {
    /// One look at the frame.
    pub(crate) fn seen_by(self, eye: &mut Eye, gaze: Gaze, duration: Seconds) -> Looked<Look> {
        match self {
            FrameView::Half(frame) => eye.look(frame, gaze, duration),
            FrameView::Float(frame) => eye.look(frame, gaze, duration),
        }
    }
}

/// An aligned array of an object, of a given type or its own.
pub(crate) fn required<'py>(
    given: &Bound<'py, PyAny>,
    dtype: Option<&str>,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let numpy = given.py().import("numpy")?;
    let array = numpy.call_method1("require", (given, dtype, "A"))?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// An array of the percept's shape, (h, w, 3) float32, that can be written.
pub(crate) fn writable<'py>(
    given: &Bound<'py, PyAny>,
    (height, width): (usize, usize),
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let flags = |array: &Bound<'py, PyArray3<f32>>| -> PyResult<bool> {
        let flags = array.getattr("flags")?;
        Ok(flags.get_item("ALIGNED")?.extract()? && flags.get_item("WRITEABLE")?.extract()?)
    };
    let array = given.cast::<PyArray3<f32>>().ok().filter(|a| a.shape() == [height, width, 3]);
    match array {
        Some(array) if flags(array)? => Ok(array.clone()),
        _ => {
            let found = given.getattr("shape").map_or_else(
                |_| described(given),
                |shape| format!("shape {shape} of {}", given.get_type()),
            );
            let accepted = format!("a writable float32 array of shape ({height}, {width}, 3)");
            Err(refused("out", found, &accepted))
        }
    }
}
