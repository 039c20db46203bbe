//! Tables as JSON: rows as objects.

use std::path::Path;

use serde_json::{Map, Value};

use sungaze::error::{Error, Result};

/// The rows of a CSV file as objects.
pub fn rows(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).map_err(Error::io(path, "read"))?;
    let mut lines = text.lines().map(cells);
    let names = lines.next().unwrap_or_default();
    let row = |cells: Vec<String>| {
        Value::Object(
            names.iter().cloned().zip(cells.into_iter().map(value)).collect::<Map<_, _>>(),
        )
    };
    Ok(Value::Array(lines.map(row).collect()))
}

/// A cell: whole and other finite numbers become numbers, TOML lists and quoted strings what they
/// stand for.
pub fn value(cell: String) -> Value {
    let whole = || cell.parse().ok().map(|number: i64| number.into());
    let real = || cell.parse().ok().and_then(serde_json::Number::from_f64).map(Value::Number);
    whole().or_else(real).or_else(|| toml_value(&cell)).unwrap_or(Value::String(cell))
}

/// The value of a varied key that is a list, a string or a truth.
fn toml_value(cell: &str) -> Option<Value> {
    let written = cell.starts_with(['[', '"', '\'', '{']) || ["true", "false"].contains(&cell);
    let table: toml::Table =
        written.then(|| toml::from_str(&format!("value = {cell}")).ok()).flatten()?;
    serde_json::to_value(table.get("value")?).ok()
}

/// Splits a line; a quoted cell may hold commas and doubled quotes.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut cell, mut quoted) = (Vec::new(), String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => cell.extend(letters.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(std::mem::take(&mut cell)),
            other => cell.push(other),
        }
    }
    cells.push(cell);
    cells
}
