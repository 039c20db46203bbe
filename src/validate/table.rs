//! The checks as words: `validate.csv`, rows for machines, and a table to be read at a glance.

use std::fmt::Write;

use serde_json::{Value, json};

use super::{Check, Validation, Verdict};

/// `validate.csv`.
pub fn csv(validation: &Validation) -> String {
    let header = "check,source,measured,expected,tolerance,pass\n".to_owned();
    validation.checks().fold(header, |text, c| {
        let tolerance = if c.tolerance.is_nan() { String::new() } else { c.tolerance.to_string() };
        let (name, source) = (quoted(&c.name), quoted(c.source));
        text + &format!("{name},{source},{},{},{tolerance},{}\n", c.measured, c.expected, c.verdict.word())
    })
}

/// A cell; quoted if it holds a comma.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

/// The rows as objects.
pub fn rows(validation: &Validation) -> Value {
    let row = |c: &Check| {
        let pass = match c.verdict {
            Verdict::Info => json!("info"),
            verdict => json!(verdict == Verdict::Pass),
        };
        json!({
            "check": c.name, "source": c.source, "measured": c.measured, "expected": c.expected,
            "tolerance": c.tolerance, "pass": pass,
        })
    };
    Value::Array(validation.checks().map(row).collect())
}

/// Widths of the table's columns.
const NAME: usize = 78;
const NUMBER: usize = 12;

/// The table for a terminal; `colour`: whether it knows ANSI colours.
pub fn text(validation: &Validation, colour: bool) -> String {
    let mut text = String::new();
    let paint = |code: &str, words: &str| if colour { format!("\x1b[{code}m{words}\x1b[0m") } else { words.to_owned() };
    for group in &validation.groups {
        let heading = paint("1", group.title);
        let _ = writeln!(text, "{heading}");
        let columns = format!("{:NAME$} {:>NUMBER$} {:>NUMBER$} {:>9}", "", "measured", "expected", "+-");
        let _ = writeln!(text, "   {}", paint("2", &columns));
        for check in &group.checks {
            let mark = match check.verdict {
                Verdict::Pass => paint("32", "ok"),
                Verdict::Fail => paint("1;31", "NO"),
                Verdict::Info => paint("36", " i"),
            };
            let _ = writeln!(text, "{mark} {}", line(check));
            if check.verdict != Verdict::Pass {
                let _ = writeln!(text, "   {}", paint("2", check.source));
            }
        }
        text.push('\n');
    }
    text + &summary(validation)
}

fn line(check: &Check) -> String {
    let tolerance = if check.tolerance.is_nan() { String::new() } else { format!("{:.0e}", check.tolerance) };
    let [measured, expected] = [check.measured, check.expected].map(|v| sensible(v, check.tolerance));
    format!("{:NAME$} {measured:>NUMBER$} {expected:>NUMBER$} {tolerance:>9}", check.name)
}

/// Digits down to a tenth of the tolerance, seven significant ones at most.
fn sensible(value: f64, tolerance: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let finest = if tolerance.is_nan() { 4.0 } else { (1.0 - tolerance.log10()).ceil() };
    let decimals = finest.clamp(0.0, 6.0 - magnitude.max(0.0)).max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// The last line: how many passed, failed and are stated.
pub fn summary(validation: &Validation) -> String {
    let [pass, fail, info] = [Verdict::Pass, Verdict::Fail, Verdict::Info].map(|verdict| validation.count(verdict));
    format!("{} checks: {pass} pass, {fail} fail, {info} known disagreements stated", pass + fail + info)
}
