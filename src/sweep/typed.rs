//! Tables as typed data: the rows of a CSV file as JSON objects.

use std::path::Path;

use serde_json::{Map, Number, Value};

use crate::error::{Error, Result};

/// The rows of a CSV file as objects.
///
/// # Errors
/// The file cannot be read, or a row has more or fewer cells than the header.
pub fn rows(path: &Path) -> Result<Value> {
    let wrong = |problem: csv::Error| Error::file(path, problem.to_string());
    let table = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path);
    let mut table = table.map_err(wrong)?;
    let names = table.headers().map_err(wrong)?.clone();
    let row = |row: csv::Result<csv::StringRecord>| {
        let row = row.map_err(wrong)?;
        let cells = names.iter().zip(row.iter()).map(|(name, cell)| (name.to_owned(), value(cell)));
        Ok(Value::Object(cells.collect::<Map<_, _>>()))
    };
    table.records().map(row).collect()
}

/// A cell: numbers become numbers, those that are not finite null, lists what they stand for.
pub fn value(cell: &str) -> Value {
    let whole = || cell.parse().ok().map(|number: i64| number.into());
    let real = || Some(Number::from_f64(cell.parse().ok()?).map_or(Value::Null, Value::Number));
    let composed = cell.starts_with(['[', '{']) || ["true", "false"].contains(&cell);
    let list = || serde_json::from_str(cell).ok().filter(|_| composed);
    whole().or_else(real).or_else(list).unwrap_or_else(|| cell.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_the_types_of_what_they_stand_for() {
        let cells = ["3", "-0.5", "NaN", "[4.3, 5.0]", "true", "exact", "a \"word\""];
        let typed: Vec<Value> = cells.map(value).into();
        let expected = r#"[3, -0.5, null, [4.3, 5.0], true, "exact", "a \"word\""]"#;
        assert_eq!(Value::Array(typed), serde_json::from_str::<Value>(expected).unwrap());
    }
}
