//! The threads that all looks share, and the process that owns them.

use std::process;
use std::sync::OnceLock;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::errors::refused;

/// The process whose threads they are: a fork copies the pool, but not its threads.
static OWNER: OnceLock<u32> = OnceLock::new();

/// Refuses to wait for threads that a fork has left behind.
pub(crate) fn awake() -> PyResult<()> {
    let here = process::id();
    if *OWNER.get_or_init(|| here) == here {
        return Ok(());
    }
    let problem = "sungaze was used before this process was forked, and its threads are not here; \
                   use it in the children only, or start them with \
                   multiprocessing.get_context(\"spawn\")";
    Err(PyRuntimeError::new_err(problem))
}

/// Sets how many threads all looks share. Results do not depend on it.
///
/// Parameters
/// ----------
/// count : int
///     1 or more. Before the first look, run or sweep: the threads live as long as the process.
///
/// Raises
/// ------
/// ValueError
///     If `count` is below 1, or the threads run already.
#[pyfunction]
#[pyo3(text_signature = "(count)")]
pub(crate) fn set_threads(count: i64) -> PyResult<()> {
    let threads = usize::try_from(count).ok().filter(|&n| n > 0);
    let threads = threads.ok_or_else(|| refused("count", count, "1 or more"))?;
    awake()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    pool.map_err(|_| {
        PyValueError::new_err("the threads run already: set them before the first look")
    })
}
