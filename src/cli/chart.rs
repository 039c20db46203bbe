//! `sungaze chart`.

use std::process::ExitCode;

use clap::builder::{PossibleValue, PossibleValuesParser};
use serde_json::{Map, Value};

use sungaze::chart::{self, CHARTS, Chart};
use sungaze::error::{Error, Result};

use sungaze::sweep::typed;

use super::{Common, say};

/// Makes the named charts, or all, and prints what was written.
pub(crate) fn command(names: &[String], common: &Common) -> Result<ExitCode> {
    let charts = chosen(names, common)?;
    let observer = chart::observer(&common.set)?;
    common.pool()?;
    let folder = common.folder("chart");
    common.ready(&folder)?;
    let mut rows = Map::new();
    for chart in charts {
        let mut progress = |line: &str| {
            if !common.quiet {
                say::message(line);
            }
        };
        chart.write(&folder, &observer, &mut progress)?;
        let csv = folder.join(format!("{}.csv", chart.name.replace('-', "_")));
        if common.json {
            rows.insert(
                chart.name.into(),
                if csv.exists() { typed::rows(&csv)? } else { Value::Null },
            );
        } else {
            say::result(&format!("{}", csv.with_extension("png").display()))?;
        }
    }
    if common.json {
        say::result(&format!("{:#}", Value::Object(rows)))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The charts of these names, in the order of the table; without a name all, or all that take an
/// observer if one is set.
fn chosen(names: &[String], common: &Common) -> Result<Vec<&'static Chart>> {
    let takes = |chart: &&Chart| common.set.is_empty() || chart.takes_observer();
    if names.is_empty() {
        return Ok(CHARTS.iter().filter(takes).collect());
    }
    let named = CHARTS.iter().filter(|chart| names.iter().any(|name| name == chart.name));
    match named.clone().find(|chart| !takes(chart)) {
        None => Ok(named.collect()),
        Some(Chart { name, .. }) => {
            let takers: Vec<_> = CHARTS.iter().filter(takes).map(|chart| chart.name).collect();
            let problem = format!(
                "has no meaning for {name}, which shows the standard observer; charts that take one: {}",
                takers.join(", ")
            );
            Err(Error::config("--set", &common.set[0], problem))
        }
    }
}

/// The names of charts, each with what it shows.
pub(crate) fn names() -> PossibleValuesParser {
    let value = |chart: &Chart| PossibleValue::new(chart.name).help(chart.shows);
    PossibleValuesParser::new(CHARTS.iter().map(value))
}
