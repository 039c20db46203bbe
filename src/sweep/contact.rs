//! `contact.png`: the display pictures of all cells, durations across and cases down; with two varied
//! keys a grid for each duration, the first key's values down and the second's across. More rows
//! than a page holds go on to `contact.2.png` and so forth.

use std::path::Path;

use crate::config::Sweep;
use crate::error::Result;
use crate::plot::gallery::{self, Block, MOST_ACROSS, Picture, Row};
use crate::sweep::folder::Left;
use crate::sweep::plot::{MOST_CASES, plain, short};

/// What a sweep's pictures are laid out by.
struct Plan {
    /// How many pictures stand side by side.
    columns: usize,
    /// Whether the second of two keys runs across.
    is_grid: bool,
}

impl Plan {
    fn new(sweep: &Sweep) -> Self {
        let (cases, durations) = (sweep.cases.len(), sweep.durations.len());
        let across = second_values(sweep);
        let is_grid = sweep.keys.len() == 2 && (2..=MOST_ACROSS).contains(&across);
        Plan { columns: if is_grid { across } else { columns(cases, durations) }, is_grid }
    }
}

/// How many values the last key has: the last list runs fastest.
fn second_values(sweep: &Sweep) -> usize {
    let first = |case: &crate::config::Case| case.values.first().cloned();
    let begin = sweep.cases.first().map(first);
    sweep.cases.iter().take_while(|case| Some(first(case)) == begin).count()
}

/// How many durations of a case stand side by side. A few of one case are laid out in even rows.
fn columns(cases: usize, durations: usize) -> usize {
    match durations {
        0..=4 => durations.max(1),
        5..=16 if cases == 1 => {
            let square = (durations as f64).sqrt().ceil() as usize;
            let even = (square..=2 * square).find(|columns| durations.is_multiple_of(*columns));
            even.unwrap_or(square)
        }
        _ => durations.div_ceil(durations.div_ceil(MOST_ACROSS)),
    }
}

/// The square that a picture of a sweep's sheet must fit into, pixels.
pub(super) fn side(sweep: &Sweep) -> usize {
    let columns = Plan::new(sweep).columns;
    let cells = sweep.cases.len().min(MOST_CASES) * sweep.durations.len();
    gallery::side(columns, cells.div_ceil(columns), !sweep.keys.is_empty())
}

/// Writes the pages: `path`, then `contact.2.png` and so forth beside it.
///
/// # Errors
/// A page that cannot be written.
pub(super) fn write(path: &Path, sweep: &Sweep, left: &[Left]) -> Result<()> {
    let (side, shown) = (side(sweep), &left[..left.len().min(MOST_CASES)]);
    for (i, page) in gallery::pages(blocks(sweep, shown)).iter().enumerate() {
        let name = if i == 0 { "png".to_owned() } else { format!("{}.png", i + 1) };
        gallery::drawn(page, side).write(&path.with_extension(name))?;
    }
    Ok(())
}

fn blocks<'a>(sweep: &Sweep, shown: &'a [Left]) -> Vec<Block<'a>> {
    let plan = Plan::new(sweep);
    let mut blocks = match plan.is_grid {
        true => grids(sweep, shown, plan.columns),
        false => vec![list(sweep, shown, &plan)],
    };
    if let Some(last) = blocks.last_mut().filter(|_| shown.len() < sweep.cases.len()) {
        let label = format!("the first {} of {} cases", shown.len(), sweep.cases.len());
        last.rows.push(Row { label, pictures: Vec::new(), captions: Vec::new() });
    }
    blocks
}

/// A case's picture after one of its durations.
fn picture(left: &Left, duration: usize) -> Picture<'_> {
    let [w, h] = left.size;
    let bytes = 3 * w * h;
    Picture {
        size: [w, h],
        rgb: left.pictures.get(bytes * duration..bytes * (duration + 1)).unwrap_or(&[]),
    }
}

/// A grid for each duration, of rows that share the first key's value.
fn grids<'a>(sweep: &Sweep, shown: &'a [Left], columns: usize) -> Vec<Block<'a>> {
    let value = |case: usize, key: usize| plain(&sweep.cases[case].values[key..=key]);
    let [down, across] = [0, 1].map(|key| short(&sweep.keys[key..=key]));
    let block = |(duration, &length): (usize, &f64)| {
        let row = |(i, cases): (usize, &'a [Left])| Row {
            label: value(i * columns, 0),
            pictures: cases.iter().map(|left| picture(left, duration)).collect(),
            captions: Vec::new(),
        };
        Block {
            title: format!("after {}: {down} down, {across} across", seconds(length)),
            headings: (0..columns.min(shown.len())).map(|case| value(case, 1)).collect(),
            rows: shown.chunks(columns).enumerate().map(row).collect(),
        }
    };
    sweep.durations.iter().enumerate().map(block).collect()
}

/// All cases one below the other, each with its durations across; in several rows where they are
/// many.
fn list<'a>(sweep: &Sweep, shown: &'a [Left], plan: &Plan) -> Block<'a> {
    let durations: Vec<usize> = (0..sweep.durations.len()).collect();
    let words = |duration: &usize| seconds(sweep.durations[*duration]);
    let below = sweep.keys.is_empty() || durations.len() > plan.columns;
    let mut rows = Vec::new();
    for (case, left) in sweep.cases.iter().zip(shown) {
        for (i, part) in durations.chunks(plan.columns).enumerate() {
            let label = if i == 0 { plain(&case.values) } else { String::new() };
            let pictures = part.iter().map(|duration| picture(left, *duration)).collect();
            let captions = if below { part.iter().map(words).collect() } else { Vec::new() };
            rows.push(Row { label, pictures, captions });
        }
    }
    let headings = if below { Vec::new() } else { durations.iter().map(words).collect() };
    Block { title: short(&sweep.keys), headings, rows }
}

/// A duration in three digits.
pub(super) fn seconds(duration: f64) -> String {
    if duration >= 1e5 {
        return format!("{duration:.0e} s");
    }
    let digits = (2.0 - duration.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = if duration == 0.0 { "0".into() } else { format!("{duration:.digits$}") };
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_as_a_person_writes_them() {
        let written = [0.0, 0.3, 1.0, 30.0, 0.031_622_776, 316.227, 1000.0, 1e6, 0.01].map(seconds);
        assert_eq!(
            written,
            ["0 s", "0.3 s", "1 s", "30 s", "0.0316 s", "316 s", "1000 s", "1e6 s", "0.01 s"]
        );
    }

    #[test]
    fn one_case_is_laid_out_in_even_rows_and_many_in_one_row_each() {
        assert_eq!(
            [1, 3, 6, 8, 16, 64].map(|durations| columns(1, durations)),
            [1, 3, 3, 4, 4, 11]
        );
        assert_eq!([1, 6, 12, 13, 64].map(|durations| columns(5, durations)), [1, 6, 12, 7, 11]);
    }
}
