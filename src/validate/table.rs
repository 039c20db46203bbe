//! The checks as words: `validate.csv`, rows for machines, and a table to be read at a glance.

use std::fmt::Write;

use serde_json::{Value, json};

use super::{Check, Validation, Verdict};

/// `validate.csv`.
pub fn csv(validation: &Validation) -> String {
    let header = "check,source,measured,expected,tolerance,pass\n".to_owned();
    validation.checks().fold(header, |text, c| {
        let cell = |v: f64| match v.abs() {
            size if size.is_nan() => String::new(),
            size if size > 0.0 && size < 1e-3 => format!("{v:e}"),
            _ => v.to_string(),
        };
        let (name, source) = (quoted(&c.name), quoted(c.source));
        let [measured, expected, tolerance] = [c.measured, c.expected, c.tolerance].map(cell);
        text + &format!("{name},{source},{measured},{expected},{tolerance},{}\n", c.verdict.word())
    })
}

/// A cell; quoted if it holds a comma.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
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
const NAME: usize = 68;
const NUMBER: usize = 12;

/// The table for a terminal; `colour`: whether it knows ANSI colours. It ends with one line a
/// group.
pub fn text(validation: &Validation, colour: bool) -> String {
    let mut text = String::new();
    let paint = |code: &str, words: &str| {
        if colour { format!("\x1b[{code}m{words}\x1b[0m") } else { words.to_owned() }
    };
    let columns =
        format!("{:NAME$} {:>NUMBER$} {:>NUMBER$} {:>6}  source", "", "measured", "expected", "+-");
    for group in &validation.groups {
        let _ = writeln!(text, "{}\n   {}", paint("1", group.title), paint("2", &columns));
        for check in &group.checks {
            let _ = writeln!(
                text,
                "{} {}  {}",
                mark(check.verdict, paint),
                line(check),
                paint("2", check.source)
            );
        }
        text.push('\n');
    }
    for group in &validation.groups {
        let count = |verdict| group.checks.iter().filter(|check| check.verdict == verdict).count();
        let (pass, fail, all) = (count(Verdict::Pass), count(Verdict::Fail), group.checks.len());
        let verdict = match (pass, fail) {
            (_, 1..) => Verdict::Fail,
            (0, 0) => Verdict::Info,
            _ => Verdict::Pass,
        };
        let _ = writeln!(text, "{} {pass:>3} of {all:>3}  {}", mark(verdict, paint), group.title);
    }
    text + &summary(validation)
}

fn mark(verdict: Verdict, paint: impl Fn(&str, &str) -> String) -> String {
    match verdict {
        Verdict::Pass => paint("32", "ok"),
        Verdict::Fail => paint("1;31", "NO"),
        Verdict::Info => paint("36", " i"),
    }
}

fn line(check: &Check) -> String {
    let tolerance =
        if check.tolerance.is_nan() { String::new() } else { format!("{:.0e}", check.tolerance) };
    let [measured, expected] =
        [check.measured, check.expected].map(|v| sensible(v, check.tolerance));
    format!("{:NAME$} {measured:>NUMBER$} {expected:>NUMBER$} {tolerance:>6}", check.name)
}

/// Digits down to a tenth of the tolerance, seven significant ones at most; blank where there is no
/// number.
fn sensible(value: f64, tolerance: f64) -> String {
    if value.is_nan() {
        return String::new();
    }
    if value == 0.0 {
        return "0".into();
    }
    // A value that rounds up to the next power of ten has its digits.
    let magnitude = (1.000_001 * value.abs()).log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let finest = if tolerance.is_nan() { 4.0 } else { (1.0 - tolerance.log10()).ceil() };
    let decimals = finest.clamp(0.0, 6.0 - magnitude) as usize;
    format!("{value:.decimals$}")
}

/// The last line: how many passed, failed and are stated.
pub(crate) fn summary(validation: &Validation) -> String {
    let [pass, fail, info] =
        [Verdict::Pass, Verdict::Fail, Verdict::Info].map(|verdict| validation.count(verdict));
    format!("{} checks: {pass} pass, {fail} fail, {info} stated as information", pass + fail + info)
}
