//! What a folder holds of a run, or of a case of a sweep.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::Table;
use crate::error::Result;

/// A series of pictures and the probes' table over the same frames.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Case {
    /// What tells it from the others; empty where it is the only one.
    name: String,
    /// The picture before anything has bleached.
    before: Option<String>,
    frames: Vec<Frame>,
    probes: Table,
}

/// One frame, at its end.
#[derive(Clone, Debug, Default, Serialize)]
struct Frame {
    frame: u64,
    time_s: f64,
    /// Name relative to the page; `None` where no picture was written.
    picture: Option<String>,
    /// Fractions of the picture.
    gaze: Option<[f64; 2]>,
    pupil_mm: Option<f64>,
    adapting_cd_m2: Option<f64>,
}

/// The case of a run's folder, from `trace.csv`, `probes.csv` and the pictures that are there.
///
/// # Errors
/// A table that cannot be read.
pub(crate) fn of_run(folder: &Path) -> Result<Case> {
    let trace = Table::read(&folder.join("trace.csv"), "frame")?;
    let frames: Vec<Frame> = trace.rows.iter().map(|row| of_trace(folder, &trace, row)).collect();
    let probes = Table::read(&folder.join("probes.csv"), "frame")?;
    Ok(Case { name: String::new(), before: before(folder, "", &frames), frames, probes })
}

fn of_trace(folder: &Path, trace: &Table, row: &[Value]) -> Frame {
    let number = |name: &str| trace.number(row, name);
    let frame = number("frame").unwrap_or(0.0) as u64;
    Frame {
        frame,
        time_s: number("time_s").unwrap_or(0.0),
        picture: there(folder, picture("", frame)),
        gaze: number("gaze_x").zip(number("gaze_y")).map(|(x, y)| [x, y]),
        pupil_mm: number("pupil_mm"),
        adapting_cd_m2: number("adapting_cd_m2"),
    }
}

/// The cases of a sweep's folder, from `sweep.csv` and the pictures of each case. `keys`: those that it varies.
///
/// # Errors
/// A table that cannot be read.
pub(crate) fn of_sweep(folder: &Path, keys: &[String]) -> Result<Vec<Case>> {
    let Table { columns, rows } = Table::read(&folder.join("sweep.csv"), "case")?;
    let mut tables: Vec<Table> = Vec::new();
    for row in rows {
        match tables.last_mut() {
            Some(table) if table.rows[0][0] == row[0] => table.rows.push(row),
            _ => tables.push(Table { columns: columns.clone(), rows: vec![row] }),
        }
    }
    Ok(tables.into_iter().map(|probes| of_case(folder, keys, probes)).collect())
}

fn of_case(folder: &Path, keys: &[String], probes: Table) -> Case {
    let first = &probes.rows[0];
    let inside = format!("case.{:04}/", first[0].as_f64().unwrap_or(0.0) as u64);
    let written =
        |key: &String| Some(format!("{key} = {}", words(first.get(probes.column(key)?)?)));
    let name: Vec<String> = keys.iter().filter_map(written).collect();
    let mut frames: Vec<Frame> = Vec::new();
    for row in &probes.rows {
        let time_s = probes.number(row, "duration_s").unwrap_or(0.0);
        if frames.last().is_none_or(|last| last.time_s != time_s) {
            let frame = frames.len() as u64 + 1;
            let picture = there(folder, picture(&inside, frame));
            frames.push(Frame { frame, time_s, picture, ..Frame::default() });
        }
    }
    Case { name: name.join(", "), before: before(folder, &inside, &frames), frames, probes }
}

/// A cell as it stands in its file.
fn words(cell: &Value) -> String {
    let number = cell.as_f64().map(|number| number.to_string());
    number.or_else(|| cell.as_str().map(str::to_owned)).unwrap_or_default()
}

/// The picture from before bleaching, or else the first.
fn before(folder: &Path, inside: &str, frames: &[Frame]) -> Option<String> {
    there(folder, format!("{inside}display.start.png")).or_else(|| frames.first()?.picture.clone())
}

fn picture(inside: &str, frame: u64) -> String {
    format!("{inside}display.{frame:04}.png")
}

fn there(folder: &Path, name: String) -> Option<String> {
    folder.join(&name).is_file().then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    #[test]
    fn a_run_shows_the_pictures_that_are_there_and_where_the_eye_looked() {
        let folder = folder(&[
            (
                "trace.csv",
                "frame,time_s,gaze_x,gaze_y,pupil_mm\n1001,0.5,0.25,0.75,3\n1002,1,0.5,0.5,2\n",
            ),
            ("probes.csv", "frame,time_s,probe,p_L\n1001,0.5,sun,0.9\n1002,1,sun,0.8\n"),
            ("display.1002.png", ""),
        ]);
        let case = of_run(folder.path()).unwrap();
        assert_eq!(case.frames[0].picture, None);
        assert_eq!(case.frames[0].gaze, Some([0.25, 0.75]));
        assert_eq!(case.frames[1].picture.as_deref(), Some("display.1002.png"));
        assert_eq!((case.frames[1].frame, case.frames[1].pupil_mm), (1002, Some(2.0)));
        assert_eq!(case.probes.rows.len(), 2);
    }

    #[test]
    fn before_is_the_picture_from_the_start_or_else_the_first() {
        let run = [
            ("trace.csv", "frame,time_s\n1,1\n"),
            ("probes.csv", "frame,probe\n1,a\n"),
            ("display.0001.png", ""),
        ];
        assert_eq!(
            of_run(folder(&run).path()).unwrap().before.as_deref(),
            Some("display.0001.png")
        );
        let started = [&run[..], &[("display.start.png", "")]].concat();
        assert_eq!(
            of_run(folder(&started).path()).unwrap().before.as_deref(),
            Some("display.start.png")
        );
    }

    #[test]
    fn a_sweep_is_a_case_for_each_set_of_keys_with_a_frame_for_each_duration() {
        let folder = folder(&[
            (
                "sweep.csv",
                "case,duration_s,observer.age,probe,p_L\n0,1,20,a,0.9\n0,1,20,b,0.9\n0,2,20,a,0.8\n0,2,20,b,0.8\n\
                 1,1,60,a,0.9\n1,1,60,b,0.9\n1,2,60,a,0.8\n1,2,60,b,0.8\n",
            ),
            ("case.0001/display.0002.png", ""),
        ]);
        let cases = of_sweep(folder.path(), &["observer.age".into()]).unwrap();
        assert_eq!(
            cases.iter().map(|case| case.name.as_str()).collect::<Vec<_>>(),
            ["observer.age = 20", "observer.age = 60"]
        );
        assert_eq!(
            cases[1].frames.iter().map(|frame| frame.time_s).collect::<Vec<_>>(),
            [1.0, 2.0]
        );
        assert_eq!(cases[1].frames[1].picture.as_deref(), Some("case.0001/display.0002.png"));
        assert_eq!(cases[0].before, None);
    }
}
