//! The eye of `sungaze` on NumPy arrays: the same library, the same bits, no file between.
//!
//! A module of Python's each: [`eye`] and [`look`] (frames in memory), [`kinetics`] (the law on
//! arrays), [`runs`] (whole runs and sweeps), [`files`]. Whoever computes lets go of Python's lock.

use pyo3::prelude::*;

mod arrays;
mod config;
mod errors;
mod eye;
mod files;
mod kinetics;
mod look;
mod pool;
mod runs;

#[pymodule]
mod _sungaze {
    #[pymodule_export]
    use crate::eye::Eye;
    #[pymodule_export]
    use crate::files::read;
    #[pymodule_export]
    use crate::kinetics::{steady, unbleached};
    #[pymodule_export]
    use crate::look::Look;
    #[pymodule_export]
    use crate::pool::set_threads;
    #[pymodule_export]
    use crate::runs::{run, sweep};
}
