//! `sungaze chart`.

use std::process::ExitCode;

use serde_json::{Map, Value};

use sungaze::chart::{CHARTS, Chart};
use sungaze::error::{Error, Result};

use super::{Common, say, table};

/// Makes the named charts, or all, and prints what was written.
pub fn command(names: &[String], common: &Common) -> Result<ExitCode> {
    let charts = chosen(names)?;
    if let Some(set) = common.set.first() {
        return Err(Error::config(
            "--set",
            set,
            "has no meaning for charts: they show the standard constants",
        ));
    }
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
        (chart.write)(&folder, &mut progress)?;
        let csv = folder.join(format!("{}.csv", chart.name.replace('-', "_")));
        if common.json {
            rows.insert(
                chart.name.into(),
                if csv.exists() { table::rows(&csv)? } else { Value::Null },
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

fn chosen(names: &[String]) -> Result<Vec<&'static Chart>> {
    if names.is_empty() {
        return Ok(CHARTS.iter().collect());
    }
    let named = |name: &String| {
        CHARTS.iter().find(|chart| chart.name == name).ok_or_else(|| {
            let known: Vec<_> = CHARTS.iter().map(|chart| chart.name).collect();
            Error::config(
                "the command line",
                "NAME",
                format!("found {name:?}; accepted: {}", known.join(", ")),
            )
        })
    };
    names.iter().map(named).collect()
}
