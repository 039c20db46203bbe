//! Tables of the program's own CSV files, as the page takes them.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use crate::error::{Error, Result};

/// The most frames of a table, and of a report; more are thinned evenly.
const FRAMES: usize = 2000;

/// Columns by name, and rows of numbers, texts and null for what is no number.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Table {
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<Vec<Value>>,
}

impl Table {
    /// Reads a CSV file row by row. Rows that follow one another with the same `by` are one frame; of the frames at
    /// most [`FRAMES`] are kept, evenly thinned, and always the last.
    ///
    /// # Errors
    /// A file that cannot be read, or without a column `by`.
    pub(crate) fn read(path: &Path, by: &str) -> Result<Table> {
        let frames = Frames::of(path, by)?;
        let (stride, last) = (frames.count.div_ceil(FRAMES).max(1), frames.count.saturating_sub(1));
        let mut table = Table { columns: frames.columns, rows: Vec::new() };
        rows(path, frames.by, |frame, row| {
            if frame % stride == 0 || frame == last {
                table.rows.push(row.iter().map(cell).collect());
            }
        })?;
        Ok(table)
    }

    /// Where a column is.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// A number of a row; `None` where there is no such column or no number.
    pub(crate) fn number(&self, row: &[Value], name: &str) -> Option<f64> {
        row.get(self.column(name)?)?.as_f64()
    }
}

/// What a first pass finds: the columns, which of them tells frames apart, and how many frames there are.
struct Frames {
    columns: Vec<String>,
    by: usize,
    count: usize,
}

impl Frames {
    fn of(path: &Path, by: &str) -> Result<Frames> {
        let header = reader(path)?.headers().map_err(|e| Error::file(path, e.to_string()))?.clone();
        let columns: Vec<String> = header.iter().map(str::to_owned).collect();
        let missing = || Error::file(path, format!("has no column {by}"));
        let by = columns.iter().position(|column| column == by).ok_or_else(missing)?;
        let mut count = 0;
        rows(path, by, |frame, _| count = frame + 1)?;
        Ok(Frames { columns, by, count })
    }
}

fn reader(path: &Path) -> Result<csv::Reader<std::fs::File>> {
    let file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
    Ok(csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).from_reader(file))
}

/// Hands over every row with the number of its frame, from 0.
fn rows(path: &Path, by: usize, mut each: impl FnMut(usize, &csv::StringRecord)) -> Result<()> {
    let (mut frame, mut last) = (0, None);
    for row in reader(path)?.records() {
        let row = row.map_err(|e| Error::file(path, e.to_string()))?;
        let key = row.get(by).map(str::to_owned);
        frame += usize::from(last.is_some() && last != Some(key.clone()));
        last = Some(key);
        each(frame, &row);
    }
    Ok(())
}

fn cell(text: &str) -> Value {
    if ["NaN", "inf", "-inf"].contains(&text) {
        return Value::Null;
    }
    let number = text.parse().ok().and_then(serde_json::Number::from_f64);
    number.map_or_else(|| Value::String(text.to_owned()), Value::Number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(text: &str) -> Result<Table> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("probes.csv");
        std::fs::write(&path, text).unwrap();
        Table::read(&path, "frame")
    }

    #[test]
    fn numbers_are_numbers_words_are_words_and_what_is_no_number_is_null() {
        let table = read("frame,probe,x\n1,\"a, b\",0.25\n2,sun,NaN\n").unwrap();
        assert_eq!(table.columns, ["frame", "probe", "x"]);
        assert_eq!(
            table.rows,
            [
                vec![json!(1.0), json!("a, b"), json!(0.25)],
                vec![json!(2.0), json!("sun"), json!(null)]
            ]
        );
        assert_eq!(table.number(&table.rows[0], "x"), Some(0.25));
        assert_eq!(table.number(&table.rows[1], "x"), None);
    }

    #[test]
    fn many_frames_are_thinned_whole_and_the_last_is_kept() {
        let rows: String = (0..5000).map(|i| format!("{i},a\n{i},b\n")).collect();
        let table = read(&format!("frame,probe\n{rows}")).unwrap();
        let frames: Vec<f64> = table.rows.iter().filter_map(|row| row[0].as_f64()).collect();
        assert!(frames.len() <= 2 * FRAMES + 2 && frames.len() > FRAMES);
        assert!(frames.chunks(2).all(|pair| pair[0] == pair[1]), "a frame keeps all of its probes");
        assert_eq!(frames.last(), Some(&4999.0));
    }

    #[test]
    fn a_table_without_its_frames_is_refused_and_one_without_rows_is_empty() {
        assert!(read("time\n1\n").unwrap_err().to_string().contains("no column frame"));
        assert!(read("frame,probe\n").unwrap().rows.is_empty());
    }
}
