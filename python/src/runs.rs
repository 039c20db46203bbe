//! Whole runs and sweeps, as the program does them.

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyOSError, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sungaze::config::Value;
use sungaze::error::{Error, Result as Ran};
use sungaze::run::{Existing, Watch};
use sungaze::sweep::Part;

use crate::config::config_of;
use crate::errors::{raised, refused};
use crate::pool::awake;

/// Runs a configuration into a folder, as `sungaze run` does.
///
/// Parameters
/// ----------
/// config : str, os.PathLike, dict or None
///     A TOML file or a dict of its tables; None is the built-in sunset. Relative paths of a dict are
///     relative to the working directory.
/// out : str or os.PathLike
///     The folder; `out/<config name>` without one.
/// progress : callable
///     Called with (frames written, frames in all). What it raises ends the run.
/// resume, overwrite : bool
///     Go on where a run stopped, or replace what one left. Otherwise the folder must be empty.
///
/// Returns
/// -------
/// dict
///     `report.json`.
///
/// Raises
/// ------
/// ValueError
///     A key is wrong, or the folder is not empty.
/// OSError
///     A file cannot be read or written.
/// KeyboardInterrupt
///     After the frame in hand; `resume=True` goes on.
#[pyfunction]
#[pyo3(
    signature = (config=None, out=None, progress=None, *, resume=false, overwrite=false),
    text_signature = "(config=None, out=None, progress=None, *, resume=False, overwrite=False)"
)]
pub(crate) fn run<'py>(
    py: Python<'py>,
    config: Option<&Bound<'py, PyAny>>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
    resume: bool,
    overwrite: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (config, existing) = (config_of(config)?, existing(resume, overwrite)?);
    let folder = out.unwrap_or_else(|| PathBuf::from("out").join(&config.name));
    let outcome =
        watched(py, progress, |watch| sungaze::run::run(&config, &folder, existing, watch))?;
    py.import("json")?.call_method1("loads", (outcome.report.to_string(),))
}

/// Runs a sweep, as `sungaze sweep` does, and returns its table.
///
/// Parameters
/// ----------
/// config : str, os.PathLike or dict
///     With a table `sweep`.
/// out : str or os.PathLike
///     A folder for all that the program leaves; without one only the table is made.
/// progress : callable
///     Called with (cells done, cells in all).
/// resume, overwrite : bool
///     As for :func:`run`.
///
/// Returns
/// -------
/// dict of str to ndarray
///     The columns of `sweep.csv`, float64, int64 or str: `pandas.DataFrame(sungaze.sweep(...))`.
///
/// Examples
/// --------
/// >>> import sungaze
/// >>> table = sungaze.sweep({
/// ...     "input": {"width": 16},
/// ...     "sweep": {"durations_s": [1, 60], "vary": [{"key": "observer.age", "values": [20, 80]}]},
/// ... })
/// >>> table["observer.age"], table["duration_s"]
/// (array([20., 20., 80., 80.]), array([ 1., 60.,  1., 60.]))
#[pyfunction]
#[pyo3(
    signature = (config, out=None, progress=None, *, resume=false, overwrite=false),
    text_signature = "(config, out=None, progress=None, *, resume=False, overwrite=False)"
)]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    config: &Bound<'py, PyAny>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
    resume: bool,
    overwrite: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (config, existing) = (config_of(Some(config))?, existing(resume, overwrite)?);
    config.sweep().map_err(raised)?;
    let (aside, config) = match out {
        Some(_) => (None, config),
        None => {
            let no_pictures = [("sweep.pictures".to_owned(), Value::Boolean(false))];
            (Some(tempfile::tempdir()?), config.with(&no_pictures).map_err(raised)?)
        }
    };
    let folder = out.or(aside.as_ref().map(|aside| aside.path().join("sweep"))).unwrap_or_default();
    let outcome = watched(py, progress, |watch| {
        sungaze::sweep::sweep(&config, &folder, existing, Part::All, watch)
    })?;
    columns(py, &outcome.table.unwrap_or_default())
}

fn existing(resume: bool, overwrite: bool) -> PyResult<Existing> {
    match (resume, overwrite) {
        (true, true) => Err(refused("resume, overwrite", "both", "one of them")),
        (true, false) => Ok(Existing::Resume),
        (false, true) => Ok(Existing::Overwrite),
        (false, false) => Ok(Existing::Refuse),
    }
}

/// Python's ear during a run: progress, warnings, signals. The first exception ends it.
struct Listener {
    progress: Option<Py<PyAny>>,
    raised: Mutex<Option<PyErr>>,
}

impl Listener {
    fn note(&self, result: PyResult<()>) {
        if let (Err(error), Ok(mut raised)) = (result, self.raised.lock()) {
            raised.get_or_insert(error);
        }
    }
}

impl Watch for Listener {
    fn frames(&self, done: usize, total: usize) {
        if let Some(progress) = &self.progress {
            Python::attach(|py| self.note(progress.call1(py, (done, total)).map(drop)));
        }
    }

    fn warn(&self, message: &str) {
        let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
        Python::attach(|py| {
            self.note(PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1));
        });
    }

    fn interrupted(&self) -> bool {
        self.raised.lock().map_or(true, |raised| raised.is_some())
    }
}

/// How often signals are heard.
const OFTEN: Duration = Duration::from_millis(50);

/// Works in a thread of its own, while the caller's hears Python's signals.
fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Listener) -> Ran<T> + Send,
) -> PyResult<T> {
    awake()?;
    let listener = Listener { progress, raised: Mutex::new(None) };
    let listening = &listener;
    let done = py.detach(|| {
        thread::scope(|threads| {
            let (finished, is_finished) = channel::<()>();
            let worker = thread::Builder::new().spawn_scoped(threads, move || {
                let _finished = finished;
                work(listening)
            });
            let worker = worker.map_err(Error::io("a thread", "start"))?;
            while is_finished.recv_timeout(OFTEN) == Err(RecvTimeoutError::Timeout) {
                Python::attach(|py| listening.note(py.check_signals()));
            }
            worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    });
    match listener.raised.into_inner().ok().flatten() {
        Some(error) => Err(error),
        None => done.map_err(raised),
    }
}

/// The columns of a table.
fn columns<'py>(py: Python<'py>, table: &Path) -> PyResult<Bound<'py, PyDict>> {
    let unreadable = |e: csv::Error| PyOSError::new_err(format!("{}: {e}", table.display()));
    let reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(table);
    let mut reader = reader.map_err(unreadable)?;
    let header = reader.headers().map_err(unreadable)?.clone();
    let rows = reader.records().collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    let (dict, numpy) = (PyDict::new(py), py.import("numpy")?);
    for (i, name) in header.iter().enumerate() {
        let words: Vec<&str> = rows.iter().map(|row| row.get(i).unwrap_or_default()).collect();
        let numbers: Result<Vec<f64>, _> = words.iter().map(|word| word.parse()).collect();
        let column = match numbers {
            Ok(numbers) if name == "case" => {
                numbers.into_iter().map(|n| n as i64).collect::<Vec<_>>().into_pyobject(py)?
            }
            Ok(numbers) => numbers.into_pyobject(py)?,
            Err(_) => words.into_pyobject(py)?,
        };
        dict.set_item(name, numpy.call_method1("array", (column,))?)?;
    }
    Ok(dict)
}
