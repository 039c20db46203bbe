//! `output.video`: the display pictures as a film, made by ffmpeg where it is on the PATH.
//!
//! Pictures go in through ffmpeg's concat list, each with its own duration, so that uneven times
//! are kept: the film has the run's own frame rate where that is even, and shows each picture for
//! its time at 24 frames a second where it is not.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::error::{Error, Result};
use crate::frames::atomic::write_text;
use crate::run::schedule::{Step, rate};

/// Name of the list of pictures, in the run's folder; removed when the film is made.
const LIST: &str = "video.ffconcat";

/// Frames a second of a film whose pictures last for different times.
const UNEVEN_RATE: f64 = 24.0;

/// Makes the film `name` in the folder. Where ffmpeg is not there, the list is left and the command
/// to run returned.
pub fn make(folder: &Path, name: &str, steps: &[Step]) -> Result<Option<String>> {
    let path = folder.join(LIST);
    write_text(&path, &list(steps))?;
    let film = folder.join(name);
    let arguments =
        arguments(name, rate(steps).unwrap_or(UNEVEN_RATE), steps.last().map_or(0.0, Step::end));
    let mut command = Command::new("ffmpeg");
    command
        .args(&arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let output = match command.output() {
        Ok(output) => output,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Ok(Some(format!("cd {} && ffmpeg {}", folder.display(), quoted(&arguments))));
        }
        Err(error) => return Err(Error::io(film, "make")(error)),
    };
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        let last = told.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no message");
        return Err(Error::file(film, format!("ffmpeg could not make it: {last}")));
    }
    std::fs::remove_file(&path).map_err(Error::io(&path, "remove"))?;
    Ok(None)
}

/// The pictures with their durations, in a time base of 1 ms. The last is named twice: ffmpeg gives
/// a duration only to what is followed.
fn list(steps: &[Step]) -> String {
    let picture =
        |step: &Step| format!("file display.{:04}.png\noption framerate 1000\n", step.number);
    let shown =
        steps.iter().map(|step| format!("{}duration {:.6}\n", picture(step), step.duration));
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
            .map(|(&duration, number)| Step { number, file: 0, start: 0.0, duration })
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
