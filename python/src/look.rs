//! What one look found, as arrays.

use numpy::ndarray::Array3;
use numpy::{PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use sungaze::display::{Display, ToneMap};
use sungaze::eye;
use sungaze::light::{Planes, Samples, widen};

use crate::eye::Eye;
use crate::pool::awake;

/// What one look found. The display and the trolands are computed when they are asked for.
#[pyclass(module = "sungaze", frozen)]
pub struct Look {
    eye: Py<Eye>,
    number: u64,
    /// Read-only.
    percept: Py<PyArray3<f32>>,
    to_srgb: [[f32; 3]; 3],
    shown_by: (ToneMap, Display),
    display: PyOnceLock<Py<PyArray3<u8>>>,
    trolands: PyOnceLock<Py<PyArray3<f32>>>,
    /// Diameter of the pupil during the look, mm.
    #[pyo3(get)]
    pupil_mm: f64,
    /// Mean luminance over the fovea, to which the pupil has adapted, cd/m2.
    #[pyo3(get)]
    adapting_cd_m2: f64,
}

impl Look {
    /// A look's findings; its percept becomes the array's memory, and is copied to `out`.
    pub fn new(
        eye: Py<Eye>,
        py: Python<'_>,
        look: eye::Look,
        shown_by: (ToneMap, Display),
        number: u64,
        out: Option<Bound<'_, PyArray3<f32>>>,
    ) -> PyResult<Look> {
        let percept = PyArray3::from_owned_array(py, array_of(look.percept));
        if let Some(out) = out {
            let mut out = out.try_readwrite()?;
            out.as_array_mut().assign(&percept.readonly().as_array());
        }
        percept.try_readwrite()?.make_nonwriteable();
        Ok(Look {
            eye,
            number,
            percept: percept.unbind(),
            to_srgb: look.to_srgb,
            shown_by,
            display: PyOnceLock::new(),
            trolands: PyOnceLock::new(),
            pupil_mm: look.pupil.0,
            adapting_cd_m2: look.adapting.0,
        })
    }
}

#[pymethods]
impl Look {
    /// The percept: what an unbleached eye would have to look at to catch the same. (h, w, 3)
    /// float32 in the frame's scale; for spectral frames linear sRGB in cd/m2. Read-only, laid out
    /// as rows of planes; not copied.
    #[getter]
    fn percept(&self, py: Python<'_>) -> Py<PyArray3<f32>> {
        self.percept.clone_ref(py)
    }

    /// The percept tone-mapped for a display, as the program's `display.####.png`: (h, w, 3) uint8,
    /// sRGB.
    #[getter]
    fn display(&self, py: Python<'_>) -> PyResult<Py<PyArray3<u8>>> {
        let display = self.display.get_or_try_init(py, || {
            awake()?;
            let percept = self.percept.bind(py).try_readonly()?;
            let view = percept.as_array();
            let srgb = py.detach(|| {
                let planes = Planes::of_frame(view, None);
                let mut srgb = Array3::zeros((planes.height, planes.width, 3));
                let (map, display) = &self.shown_by;
                let bytes = srgb.as_slice_mut().unwrap_or_default();
                display.picture(&planes, &self.to_srgb, map, bytes);
                srgb
            });
            Ok::<_, PyErr>(PyArray3::from_owned_array(py, srgb).unbind())
        })?;
        Ok(display.clone_ref(py))
    }

    /// Cone illuminance of L, M and S, td: (h, w, 3) float32. To be asked for the first time before
    /// the eye's next look.
    #[getter]
    fn trolands(&self, py: Python<'_>) -> PyResult<Py<PyArray3<f32>>> {
        let trolands = self.trolands.get_or_try_init(py, || {
            awake()?;
            let td = py.detach(|| self.eye.get().trolands_of(self.number))?;
            Ok::<_, PyErr>(PyArray3::from_owned_array(py, td).unbind())
        })?;
        Ok(trolands.clone_ref(py))
    }
}

/// Planes as an array (h, w, planes) of floats over the same memory; halves are widened.
pub(crate) fn array_of(planes: Planes) -> Array3<f32> {
    let Planes { width, height, count, samples } = planes;
    let samples = match samples {
        Samples::Float(samples) => samples,
        Samples::Half(samples) => {
            let mut wide = vec![0.0; samples.len()];
            widen(&samples, &mut wide);
            wide
        }
    };
    let rows = Array3::from_shape_vec((height, count, width), samples);
    rows.unwrap_or_default().permuted_axes([0, 2, 1])
}
