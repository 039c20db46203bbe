//! `sungaze run`.

use std::path::Path;
use std::process::ExitCode;

use sungaze::error::Result;
use sungaze::run;

use super::frames::Keys;
use super::watch::Terminal;
use super::{Common, say};

/// Runs a configuration and prints where its files are.
pub(crate) fn command(path: Option<&Path>, keys: &Keys, common: &Common) -> Result<ExitCode> {
    let config = keys.load(path, &common.set, "run")?;
    common.pool()?;
    let folder = common.folder(&config.name);
    let terminal = Terminal::new(common.quiet);
    let outcome = run::run(&config, &folder, common.existing(), &terminal);
    terminal.end();
    let outcome = outcome?;
    if common.json {
        say::result(&format!("{:#}", outcome.report))?;
    } else if outcome.already {
        say::result(&format!("{}: the run is complete already", folder.display()))?;
    } else {
        let seconds = outcome.report["timing"]["wall_s"].as_f64().unwrap_or(0.0);
        say::result(&format!(
            "{}: {} frames in {seconds:.1} s",
            folder.display(),
            outcome.report["frames"]["count"]
        ))?;
    }
    Ok(ExitCode::from(if outcome.went_on { 3 } else { 0 }))
}
