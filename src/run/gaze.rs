//! Where the eye looks, frame by frame.

use std::path::Path;

use crate::config::Config;
use crate::config::settings::{Aim, Seek};
use crate::error::{Error, Result};

/// Where the eye looks over a run, in fractions of width and height.
#[derive(Clone, Debug, PartialEq)]
pub enum Gaze {
    At([f64; 2]),
    Brightest,
    BrightestEach,
    /// Points in time, rising: straight lines between them, the ends go on.
    Path(Vec<(f64, [f64; 2])>),
    /// Points in time, rising: each is held from the one before until its own time.
    Rows(Vec<(f64, [f64; 2])>),
}

impl Gaze {
    /// The gaze of `[gaze]`.
    pub fn of(config: &Config) -> Result<Gaze> {
        let keys = &config.settings.gaze;
        if let Some(path) = &keys.path {
            let gaze = Gaze::from_file(&config.path(path))
                .map_err(|e| config.wrong("gaze.path", e.to_string()))?;
            let held = config.settings.time.follows_the_gaze();
            return Ok(if held { Gaze::Rows(gaze.rows()) } else { gaze });
        }
        Ok(match keys.at {
            Aim::At(at) => Gaze::At(at),
            Aim::Seek(Seek::Brightest) => Gaze::Brightest,
            Aim::Seek(Seek::BrightestEach) => Gaze::BrightestEach,
        })
    }

    fn from_file(path: &Path) -> Result<Gaze> {
        let text = std::fs::read_to_string(path).map_err(Error::io(path, "read"))?;
        Gaze::from_rows(text.trim_start_matches('\u{feff}'))
            .map_err(|problem| Error::file(path, problem))
    }

    /// A path from rows of `time_s,x,y` under that header; the problem names the line.
    pub fn from_rows(text: &str) -> Result<Gaze, String> {
        parse_path(text).map(Gaze::Path)
    }

    /// The point looked at in pixels, at `time`. `brightest`: the centroid of the frame's brightest
    /// region; `first`: where the first look went.
    pub fn pixel(
        &self,
        time: f64,
        brightest: impl FnOnce() -> [f64; 2],
        size: [usize; 2],
        first: Option<[f64; 2]>,
    ) -> [f64; 2] {
        let of_fraction = |at: [f64; 2]| [0, 1].map(|i| at[i] * size[i] as f64 - 0.5);
        match self {
            Gaze::At(at) => of_fraction(*at),
            Gaze::Brightest => first.unwrap_or_else(brightest),
            Gaze::BrightestEach => brightest(),
            Gaze::Path(points) => of_fraction(along(points, time)),
            Gaze::Rows(points) => of_fraction(held(points, time)),
        }
    }

    /// The points of a path; none where there is no path.
    pub fn rows(self) -> Vec<(f64, [f64; 2])> {
        match self {
            Gaze::Path(points) | Gaze::Rows(points) => points,
            _ => Vec::new(),
        }
    }

    /// Where the first look goes, in pixels.
    pub fn at_first(&self, brightest: impl FnOnce() -> [f64; 2], size: [usize; 2]) -> [f64; 2] {
        self.pixel(0.0, brightest, size, None)
    }
}

/// The point of a path at a time.
fn along(points: &[(f64, [f64; 2])], time: f64) -> [f64; 2] {
    let next = points.partition_point(|&(t, _)| t <= time);
    match (next.checked_sub(1).map(|i| points[i]), points.get(next)) {
        (Some((t0, a)), Some(&(t1, b))) => {
            [0, 1].map(|i| a[i] + (b[i] - a[i]) * (time - t0) / (t1 - t0))
        }
        (Some((_, at)), None) | (None, Some(&(_, at))) => at,
        (None, None) => [0.5, 0.5],
    }
}

/// The first point at or after a time, but for rounding.
fn held(points: &[(f64, [f64; 2])], time: f64) -> [f64; 2] {
    let at = points.partition_point(|&(t, _)| t < time * (1.0 - 1e-12));
    points.get(at).or(points.last()).map_or([0.5, 0.5], |&(_, at)| at)
}

/// Reads `time_s,x,y` rows.
fn parse_path(text: &str) -> Result<Vec<(f64, [f64; 2])>, String> {
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let header = lines.next().map(|(_, line)| line.trim().to_owned()).unwrap_or_default();
    if header != "time_s,x,y" {
        return Err(format!("found the header {header:?}; accepted: time_s,x,y"));
    }
    let mut points: Vec<(f64, [f64; 2])> = Vec::new();
    for (i, line) in lines {
        let cells: Vec<f64> = line.split(',').map_while(|cell| cell.trim().parse().ok()).collect();
        let sound = |c: &&[f64]| c[0].is_finite() && c[1..].iter().all(|v| (0.0..=1.0).contains(v));
        let Some(&[time, x, y]) =
            Some(&cells[..]).filter(|c| c.len() == 3 && sound(c)).and_then(|c| c.first_chunk())
        else {
            return Err(format!(
                "line {}: found {line:?}; accepted: a time in s and two fractions of the picture, 0 to 1",
                i + 1
            ));
        };
        if points.last().is_some_and(|&(before, _)| before >= time) {
            return Err(format!("line {}: time {time} does not rise", i + 1));
        }
        points.push((time, [x, y]));
    }
    if points.is_empty() {
        Err("holds no point; accepted: rows of time_s,x,y".into())
    } else {
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_straight_between_its_points_and_rests_at_its_ends() {
        let points =
            parse_path("time_s,x,y\n0,0.5,0.5\n2,0.5,0.5\n# a comment\n3,0.9,0.1\n").unwrap();
        assert_eq!(along(&points, -1.0), [0.5, 0.5]);
        assert_eq!(along(&points, 2.5), [0.7, 0.3]);
        assert_eq!(along(&points, 9.0), [0.9, 0.1]);
    }

    #[test]
    fn a_row_is_held_until_its_own_time_whatever_the_last_bits_of_a_frames_end() {
        let points = [(0.1, [0.1; 2]), (0.3, [0.3; 2]), (0.4, [0.4; 2])];
        for (time, at) in
            [(0.0, 0.1), (0.1, 0.1), (0.2, 0.3), (0.1 + 0.2, 0.3), (0.4, 0.4), (9.0, 0.4)]
        {
            assert_eq!(held(&points, time), [at; 2], "{time}");
        }
    }

    #[test]
    fn a_wrong_path_is_refused_with_its_line() {
        for (text, told) in [
            ("", "header"),
            ("time_s,x,y\n", "no point"),
            ("time_s,x,y\n0,0.5\n", "line 2"),
            ("time_s,x,y\n0,0.5,0.5\n0,0.6,0.5\n", "line 3"),
            ("time_s,x,y\n0,0.5,1.5\n", "line 2"),
            ("time_s,x,y\n0,NaN,0.5\n", "line 2"),
        ] {
            let problem = parse_path(text).unwrap_err();
            assert!(problem.contains(told), "{text:?}: {problem}");
        }
    }
}
