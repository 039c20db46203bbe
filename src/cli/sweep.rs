//! `sungaze sweep`.

use std::path::Path;
use std::process::ExitCode;

use clap::Args;
use serde_json::{Map, Value};

use sungaze::config::{Config, Sweep};
use sungaze::error::Result;
use sungaze::sweep::{self, Part, typed};

use super::watch::Terminal;
use super::{Common, say};

/// Which part of a sweep is asked for.
#[derive(Args, Clone)]
#[group(multiple = false)]
pub(crate) struct Asked {
    /// Print the cases, one a line, and run nothing.
    #[arg(long)]
    list: bool,
    /// Run one case, as one job of an array does.
    #[arg(long, value_name = "N")]
    index: Option<usize>,
    /// Gather what single cases left.
    #[arg(long)]
    merge: bool,
}

/// Runs a sweep, or the part of it that is asked for, and prints where its files are.
pub(crate) fn command(path: &Path, asked: &Asked, common: &Common) -> Result<ExitCode> {
    let config = Config::load(Some(path), &common.set)?;
    if asked.list {
        list(&config.sweep()?, common.json)?;
        return Ok(ExitCode::SUCCESS);
    }
    common.pool()?;
    let part = match (asked.index, asked.merge) {
        (Some(number), _) => Part::Index(number),
        (None, true) => Part::Merge,
        (None, false) => Part::All,
    };
    let folder = common.folder(&config.name);
    let terminal = Terminal::new(common.quiet);
    let outcome = sweep::sweep(&config, &folder, common.existing(), part, &terminal);
    terminal.end();
    let outcome = outcome?;
    if common.json {
        let rows = outcome.table.as_deref().map_or(Ok(Value::Array(Vec::new())), typed::rows)?;
        say::result(&format!("{rows:#}"))?;
    } else if part == Part::Merge {
        say::result(&format!("{}: all cases gathered", folder.display()))?;
    } else {
        let kept = if outcome.kept > 0 {
            format!(", {} finished before", outcome.kept)
        } else {
            String::new()
        };
        let cases = if outcome.ran == 1 { "case" } else { "cases" };
        say::result(&format!("{}: {} {cases} run{kept}", folder.display(), outcome.ran))?;
    }
    Ok(ExitCode::from(if outcome.went_on { 3 } else { 0 }))
}

fn list(sweep: &Sweep, json: bool) -> Result<()> {
    let pairs =
        |values: &[String]| sweep.keys.iter().cloned().zip(values.to_vec()).collect::<Vec<_>>();
    if json {
        let object = |case: &sungaze::config::Case| {
            let values =
                pairs(&case.values).into_iter().map(|(key, value)| (key, typed::value(&value)));
            Value::Object(
                std::iter::once(("case".into(), case.number.into()))
                    .chain(values)
                    .collect::<Map<_, _>>(),
            )
        };
        return say::result(&format!(
            "{:#}",
            Value::Array(sweep.cases.iter().map(object).collect())
        ));
    }
    for case in &sweep.cases {
        let values =
            pairs(&case.values).into_iter().map(|(key, value)| format!("  {key} = {value}"));
        say::result(&format!("{}{}", case.number, values.collect::<String>()))?;
    }
    Ok(())
}
