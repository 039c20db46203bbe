//! Charts that the program makes of itself: each writes `<name>.csv`, `.svg` and `.png` into a
//! folder.
//!
//! A chart is a function and a row of [`CHARTS`]; the ink is laid by the room `plot`.

mod difference;
mod fundamentals;
mod ladder;
mod ladder_scenes;
mod machine;
mod methods;
mod pigment;
mod scenes;
mod stability;
mod stability_map;
mod verdict;
mod work;
mod work_precision;

use crate::error::Result;
use crate::frames::atomic;
use std::path::Path;

/// Takes the progress of a chart, line by line.
pub type Progress<'a> = &'a mut (dyn FnMut(&str) + 'a);

/// One chart: its name on the command line and what makes it in a folder.
pub struct Chart {
    pub name: &'static str,
    pub write: fn(&Path, Progress) -> Result<()>,
}

/// Every chart, in the order in which they are made.
pub const CHARTS: &[Chart] = &[
    Chart { name: "work-precision", write: work_precision::write },
    Chart { name: "stability", write: stability_map::write },
    Chart { name: "ladder", write: ladder::write },
    Chart { name: "pigment", write: pigment::write },
    Chart { name: "fundamentals", write: fundamentals::write },
];

/// Write a table of `header` and `rows` as `<name>.csv`. No value of ours holds a comma.
pub fn write_csv(
    out_dir: &Path,
    name: &str,
    header: &str,
    rows: impl Iterator<Item = String>,
) -> Result<()> {
    let table = std::iter::once(header.to_owned())
        .chain(rows)
        .fold(String::new(), |text, row| text + &row + "\n");
    atomic::write_text(&out_dir.join(format!("{name}.csv")), &table)
}
