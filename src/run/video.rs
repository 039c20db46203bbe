//! `output.video`: the display pictures as a film, made by ffmpeg where it is on the PATH.
//!
//! Pictures go in through ffmpeg's concat list, each with its own duration, so that uneven times
//! are kept: the film has the run's own frame rate where that is even, and shows each picture for
//! its time at 24 frames a second where it is not.

use std::io::{ErrorKind, Read, Seek};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::error::{Error, Result};
use crate::frames::atomic;
use crate::run::schedule::{Step, rate};
use crate::run::watch::Watch;

/// Name of the list of pictures, in the run's folder; removed when the film is made.
pub(crate) const LIST: &str = "video.ffconcat";

/// How often a run that waits for ffmpeg asks whether it should stop.
const OFTEN: Duration = Duration::from_millis(20);

/// Frames a second of a film whose pictures last for different times.
const UNEVEN_RATE: f64 = 24.0;

/// Makes the film `name` in the folder: whole, or not at all. Where ffmpeg is not there, the list is
/// left and the command to run returned.
///
/// # Errors
/// ffmpeg failed, or the run was asked to stop.
pub(crate) fn make(
    folder: &Path,
    name: &str,
    steps: &[Step],
    watch: &dyn Watch,
) -> Result<Option<String>> {
    let (path, film) = (folder.join(LIST), folder.join(name));
    atomic::write_text(&path, &list(steps))?;
    let ending = film.extension().unwrap_or_default().to_string_lossy();
    let beside = atomic::beside(folder, &format!(".tmp.{ending}"));
    let beside = beside.map_err(Error::io(&film, "write"))?.into_temp_path();
    let rate = rate(steps).unwrap_or(UNEVEN_RATE);
    let arguments = |to: &str| arguments(to, rate, steps.last().map_or(0.0, |step| step.end));
    let unfinished = beside.file_name().unwrap_or_default().to_string_lossy();
    match ffmpeg(folder, &arguments(&unfinished), watch)? {
        Ffmpeg::Absent => {
            let command = quoted(&arguments(name));
            return Ok(Some(format!("cd {} && ffmpeg {command}", folder.display())));
        }
        Ffmpeg::Failed(problem) => {
            return Err(Error::file(film, format!("ffmpeg could not make it: {problem}")));
        }
        Ffmpeg::Done => {}
    }
    atomic::sync_all(&[beside.to_path_buf()])?;
    beside.persist(&film).map_err(|refused| Error::io(&film, "write")(refused.error))?;
    std::fs::remove_file(&path).map_err(Error::io(&path, "remove"))?;
    Ok(None)
}

/// How ffmpeg ended.
enum Ffmpeg {
    Done,
    /// It is not on the PATH.
    Absent,
    /// Its last words.
    Failed(String),
}

/// Runs ffmpeg in a folder until it is done or the run is asked to stop.
fn ffmpeg(folder: &Path, arguments: &[String], watch: &dyn Watch) -> Result<Ffmpeg> {
    let failed = |doing| Error::io("ffmpeg", doing);
    let mut told = tempfile::tempfile().map_err(failed("write what it says of"))?;
    let words = told.try_clone().map_err(failed("write what it says of"))?;
    let mut command = Command::new("ffmpeg");
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null());
    let mut child = match command.stderr(words).spawn() {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Ffmpeg::Absent),
        spawned => spawned.map_err(failed("start"))?,
    };
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed("wait for"))? {
            break status;
        }
        if watch.interrupted() {
            // Whether or not it is still there, it writes to a file that goes away.
            let _ = child.kill();
            let _ = child.wait();
            return Err(Error::Interrupted { resumable: true });
        }
        std::thread::sleep(OFTEN);
    };
    if status.success() {
        return Ok(Ffmpeg::Done);
    }
    let mut bytes = Vec::new();
    told.rewind().and_then(|()| told.read_to_end(&mut bytes)).map_err(failed("hear"))?;
    let words = String::from_utf8_lossy(&bytes);
    let last = words.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no message");
    Ok(Ffmpeg::Failed(last.escape_debug().to_string()))
}

/// The pictures with their durations, in a time base of 1 ms. The last is named twice: ffmpeg gives
/// a duration only to what is followed.
fn list(steps: &[Step]) -> String {
    let picture =
        |step: &Step| format!("file display.{:04}.png\noption framerate 1000\n", step.number);
    let shown =
        steps.iter().map(|step| format!("{}duration {:.6}\n", picture(step), step.duration()));
    let end = steps.last().map(picture).unwrap_or_default();
    format!("ffconcat version 1.0\n{}{end}duration 1\n", shown.collect::<String>())
}

fn arguments(film: &str, rate: f64, total: f64) -> Vec<String> {
    // Sides are made even, as 4:2:0 needs them; the colours are converted to, and marked as,
    // BT.709.
    let filter = format!(
        "fps={rate:.6},pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"
    );
    let marks = [
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "bt709",
        "-color_range",
        "tv",
    ];
    let mut all: Vec<String> =
        ["-y", "-f", "concat", "-safe", "0", "-i", LIST, "-vf", &filter].map(String::from).into();
    all.extend(["-t".to_owned(), format!("{total:.6}")]);
    all.extend(["-c:v", "libx264", "-crf", "16", "-preset", "medium"].map(String::from));
    all.extend(marks.map(String::from));
    all.push(film.to_owned());
    all
}

fn quoted(arguments: &[String]) -> String {
    let plain = |a: &String| a.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_.:/".contains(&b));
    arguments
        .iter()
        .map(|a| if plain(a) { a.clone() } else { format!("'{a}'") })
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(durations: &[f64]) -> Vec<Step> {
        durations
            .iter()
            .zip(1..)
            .map(|(&end, number)| Step { number, file: 0, start: 0.0, end })
            .collect()
    }

    #[test]
    fn an_even_sequence_has_its_rate_and_an_uneven_one_keeps_its_times() {
        assert!((rate(&steps(&[0.04, 0.04, 0.01])).unwrap() - 25.0).abs() < 1e-9);
        assert_eq!(rate(&steps(&[0.04, 0.5, 0.04])), None);
        let list = list(&steps(&[0.5, 2.0]));
        assert!(
            list.contains("file display.0001.png\noption framerate 1000\nduration 0.500000\n"),
            "{list}"
        );
        assert_eq!(list.matches("display.0002.png").count(), 2, "{list}");
    }
}
