//! `sungaze plan`.

use std::path::Path;
use std::process::ExitCode;

use serde_json::Value;
use sungaze::error::Result;
use sungaze::run;

use super::frames::Keys;
use super::watch::Terminal;
use super::{Common, say};

/// Surveys a configuration's frames and prints what a run would model, and what it would leave out.
pub(crate) fn command(path: &Path, keys: &Keys, common: &Common) -> Result<ExitCode> {
    let config = keys.load(Some(path), &common.set, "plan")?;
    common.pool()?;
    let terminal = Terminal::new(common.quiet);
    let plan = run::rehearse(&config, &terminal);
    terminal.end();
    let plan = plan?;
    say::result(&if common.json { format!("{plan:#}") } else { in_words(&plan) })?;
    Ok(ExitCode::SUCCESS)
}

/// The plan as lines that a person can check.
fn in_words(plan: &Value) -> String {
    let bound = |value: &Value| value.as_f64().map_or("no limit".into(), |v| format!("{v:.1e}"));
    let (tiles, tracked) =
        (plan["tiles"].as_u64().unwrap_or(0), plan["tiles_tracked"].as_u64().unwrap_or(0));
    let cost = |what: &str| plan["cost_ms_per_megapixel_frame"][what].as_f64().unwrap_or(0.0);
    let mut lines = vec![
        format!("{} over {} frames", plan["model"].as_str().unwrap_or(""), plan["frames"]),
        format!("  {tracked} of {tiles} tiles modelled, {} left untouched", tiles - tracked),
        "  taken  at most".into(),
    ];
    for term in plan["terms"].as_array().into_iter().flatten() {
        let taken = if term["chosen"] == true { "yes" } else { "no" };
        let [what, why] = ["what", "why"].map(|key| term[key].as_str().unwrap_or(""));
        lines.push(format!("  {taken:<5}  {:<8}  {what}: {why}", bound(&term["bound"])));
    }
    if let Some(what) = plan["optics"]["what"].as_str() {
        let [p, catch] =
            ["moves_p", "moves_catch"].map(|key| plan["optics"][key].as_f64().unwrap_or(0.0));
        lines.push(format!("  {what}: moves p by {p:.1e}, a catch by {catch:.1e} of it"));
    }
    let total = bound(&plan["bound_total"]);
    lines.push(match plan["budget"].as_f64() {
        Some(budget) => format!("  taken together: at most {total}, of a budget of {budget:.1e}"),
        None => {
            format!("  taken together: {total}; numerics.model = \"auto\" would keep a budget")
        }
    });
    lines.push(format!(
        "  a frame of a megapixel: {:.1} ms to read, {:.1} ms to see",
        cost("reading"),
        cost("seeing")
    ));
    lines.join("\n")
}
