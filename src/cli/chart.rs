//! `sungaze chart`.

use std::process::ExitCode;

use serde_json::{Map, Value};

use sungaze::chart::{self, CHARTS, Chart};
use sungaze::error::{Error, Result};

use sungaze::sweep::typed;

use super::{Common, say};

/// Makes the named charts, or all, and prints what was written.
pub fn command(names: &[String], common: &Common) -> Result<ExitCode> {
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

/// The charts of these names; without one all, or all that take an observer if one is set.
fn chosen(names: &[String], common: &Common) -> Result<Vec<&'static Chart>> {
    let takes = |chart: &&Chart| common.set.is_empty() || chart.takes_observer();
    if names.is_empty() {
        return Ok(CHARTS.iter().filter(takes).collect());
    }
    let listed =
        |charts: Vec<&Chart>| charts.iter().map(|chart| chart.name).collect::<Vec<_>>().join(", ");
    let named = |name: &String| {
        let chart = CHARTS.iter().find(|chart| chart.name == name).ok_or_else(|| {
            let known = listed(CHARTS.iter().collect());
            Error::config("the command line", "NAME", format!("found {name:?}; accepted: {known}"))
        })?;
        if !takes(&chart) {
            let problem = format!(
                "has no meaning for {name}, which shows the standard observer; charts that take one: {}",
                listed(CHARTS.iter().filter(takes).collect())
            );
            return Err(Error::config("--set", &common.set[0], problem));
        }
        Ok(chart)
    };
    names.iter().map(named).collect()
}
