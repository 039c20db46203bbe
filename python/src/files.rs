//! Frame files in.

use std::path::PathBuf;

use numpy::PyArray3;
use numpy::ndarray::Array3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sungaze::error::Result as Looked;
use sungaze::frames::{self, Header, Kind, ReadOptions};
use sungaze::light::{Planes, Samples};

use crate::config::config_of;
use crate::errors::raised;
use crate::look::array_of;
use crate::pool::awake;

/// Reads a frame file: OpenEXR, Radiance, ENVI, PNG or JPEG.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
/// config : str, os.PathLike, dict or None
///     A configuration whose `[input]` says how to read: `layer`, `channels`, `scale`, ...
///
/// Returns
/// -------
/// frame : ndarray
///     (h, w, 3) linear RGB, float16 where the file holds halves and float32 else; or (h, w, bands)
///     float32 spectral radiance, W m^-2 sr^-1 nm^-1.
/// header : dict
///     `kind` ("rgb" or "spectral"), `width`, `height`, `white_cd_m2` (luminance of (1, 1, 1), None
///     where the file does not say), `bands_nm` (centres) or `primaries` (xy of red, green, blue and
///     white), `frames_per_second`, `notes`.
///
/// Raises
/// ------
/// OSError
///     The file is missing, damaged or of no known format.
///
/// Examples
/// --------
/// >>> import sungaze
/// >>> frame, header = sungaze.read("data/sunset_mitsuba.exr")
/// >>> header["kind"], frame.shape == (header["height"], header["width"], frame.shape[2])
/// ('spectral', True)
#[pyfunction]
#[pyo3(signature = (path, config=None), text_signature = "(path, config=None)")]
pub(crate) fn read<'py>(
    py: Python<'py>,
    path: PathBuf,
    config: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
    awake()?;
    let options = config_of(config)?.read_options().map_err(raised)?;
    let (header, planes) = py.detach(|| loaded(path, &options)).map_err(raised)?;
    let described = described(py, &header)?;
    let Planes { width, height, count, samples } = planes;
    let frame = match samples {
        Samples::Half(samples) => {
            let rows = Array3::from_shape_vec((height, count, width), samples).unwrap_or_default();
            PyArray3::from_owned_array(py, rows.permuted_axes([0, 2, 1])).into_any()
        }
        samples => {
            let planes = Planes { width, height, count, samples };
            PyArray3::from_owned_array(py, array_of(planes)).into_any()
        }
    };
    Ok((frame, described))
}

fn loaded(path: PathBuf, options: &ReadOptions) -> Looked<(Header, Planes)> {
    let footage = frames::open(&[path], options)?;
    Ok((footage.header().clone(), footage.read(0, None, None)?.planes))
}

fn described<'py>(py: Python<'py>, header: &Header) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("width", header.width)?;
    dict.set_item("height", header.height)?;
    dict.set_item("white_cd_m2", header.white.map(|white| white.0))?;
    dict.set_item("frames_per_second", header.frames_per_second)?;
    dict.set_item("notes", &header.notes)?;
    match &header.kind {
        Kind::Rgb(of) => {
            dict.set_item("kind", "rgb")?;
            dict.set_item("primaries", [of.red, of.green, of.blue, of.white])?;
        }
        Kind::Spectral(bands) => {
            dict.set_item("kind", "spectral")?;
            let centres: Vec<f64> = bands.as_slice().iter().map(|band| band.centre).collect();
            dict.set_item("bands_nm", centres)?;
        }
    }
    Ok(dict)
}
