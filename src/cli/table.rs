//! Tables as JSON: rows as objects.

use std::path::Path;

use serde_json::{Map, Value};

use sungaze::error::{Error, Result};

/// The rows of a CSV file as objects. Cells that read as finite numbers become numbers.
pub fn rows(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).map_err(Error::io(path, "read"))?;
    let mut lines = text.lines().map(cells);
    let names = lines.next().unwrap_or_default();
    let row = |cells: Vec<String>| {
        Value::Object(names.iter().cloned().zip(cells.into_iter().map(value)).collect::<Map<_, _>>())
    };
    Ok(Value::Array(lines.map(row).collect()))
}

fn value(cell: String) -> Value {
    let number = cell.parse().ok().filter(|v: &f64| v.is_finite()).and_then(serde_json::Number::from_f64);
    number.map_or(Value::String(cell), Value::Number)
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
