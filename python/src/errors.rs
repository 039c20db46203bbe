//! The library's errors as Python's, with the same words.

use pyo3::PyErr;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyValueError};
use sungaze::error::Error;

/// What Python raises for an error: `ValueError` for keys and arrays, `OSError` for files.
pub(crate) fn raised(error: Error) -> PyErr {
    let message = error.to_string();
    match error {
        Error::Config { .. } | Error::Light(_) => PyValueError::new_err(message),
        Error::File { .. } => PyOSError::new_err(message),
        Error::Io { source, .. } => std::io::Error::new(source.kind(), message).into(),
        Error::Interrupted { .. } => PyKeyboardInterrupt::new_err(message),
    }
}

/// An argument that is not accepted: what was found, what is accepted.
pub(crate) fn refused(name: &str, found: impl std::fmt::Display, accepted: &str) -> PyErr {
    PyValueError::new_err(format!("{name}: found {found}; accepted: {accepted}"))
}
