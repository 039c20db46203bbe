//! Where the eye looks, frame by frame.

use std::path::Path;

use crate::config::Config;
use crate::config::settings::Aim;
use crate::error::{Error, Result};
use crate::light::Window;

/// Where the eye looks over a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Gaze {
    /// Fractions of width and height.
    At([f64; 2]),
    Brightest,
    BrightestEach,
    Path(GazePath),
}

/// Points in time or by frame, rising: straight lines between them, the ends go on.
#[derive(Clone, Debug, PartialEq)]
pub struct GazePath {
    /// Points stand at numbers of frames instead of times, s.
    by_frame: bool,
    /// Places are pixels, their centres at integers, instead of fractions of width and height.
    in_pixels: bool,
    /// Each point is held from the one before until its own time.
    held: bool,
    pub points: Vec<(f64, [f64; 2])>,
}

/// The moment for which a gaze is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// The middle of a frame, s.
    pub(crate) time: f64,
    /// Its number.
    pub(crate) frame: u32,
}

/// The headers of a gaze path, what its points stand at and what its places are.
const HEADERS: [(&str, bool, bool); 4] = [
    ("time_s,x,y", false, false),
    ("frame,x,y", true, false),
    ("time_s,x_px,y_px", false, true),
    ("frame,x_px,y_px", true, true),
];

impl Gaze {
    /// The gaze of `[gaze]`.
    ///
    /// # Errors
    /// The path cannot be read, or its rows are not in order.
    pub(crate) fn of(config: &Config) -> Result<Gaze> {
        let keys = &config.settings.gaze;
        if let Some(path) = &keys.path {
            let path = GazePath::from_file(&config.path(path))
                .map_err(|e| config.wrong("gaze.path", e.to_string()))?;
            let held = config.settings.time.follows_the_gaze();
            if held && path.by_frame {
                let problem = "\"gaze.path\" needs a path with time_s";
                return Err(config.wrong("time.times_s", problem));
            }
            return Ok(Gaze::Path(GazePath { held, ..path }));
        }
        Ok(match keys.at {
            Aim::At(at) => Gaze::At(at),
            Aim::Brightest => Gaze::Brightest,
            Aim::BrightestEach => Gaze::BrightestEach,
        })
    }

    /// The point looked at in pixels of the frame. `brightest`: the centroid of the frame's brightest region;
    /// `first`: where the first look went.
    pub(crate) fn pixel(
        &self,
        at: Moment,
        brightest: impl FnOnce() -> [f64; 2],
        window: Window,
        first: Option<[f64; 2]>,
    ) -> [f64; 2] {
        match self {
            Gaze::At(at) => window.pixel(*at),
            Gaze::Brightest => first.unwrap_or_else(brightest),
            Gaze::BrightestEach => brightest(),
            Gaze::Path(path) if path.in_pixels => window.in_frame(path.place(at)),
            Gaze::Path(path) => window.pixel(path.place(at)),
        }
    }

    /// Whether it stays where it first goes.
    pub(crate) fn is_held(&self) -> bool {
        match self {
            Gaze::At(_) | Gaze::Brightest => true,
            Gaze::BrightestEach | Gaze::Path(_) => false,
        }
    }

    /// The points in time of a path, fractions of the picture where it has those; none where there
    /// is no such path.
    pub(crate) fn rows(self) -> Vec<(f64, [f64; 2])> {
        match self {
            Gaze::Path(path) if !path.by_frame => path.points,
            _ => Vec::new(),
        }
    }
}

impl GazePath {
    fn from_file(path: &Path) -> Result<GazePath> {
        let text = std::fs::read_to_string(path).map_err(Error::io(path, "read"))?;
        GazePath::from_rows(text.trim_start_matches('\u{feff}'))
            .map_err(|problem| Error::file(path, problem))
    }

    /// A path from rows under one of the headers that are accepted.
    ///
    /// # Errors
    /// A header or a row is wrong; the problem names its line.
    pub fn from_rows(text: &str) -> Result<GazePath, String> {
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let header = lines.next().map(|(_, line)| line.trim()).unwrap_or_default();
        let Some(&(_, by_frame, in_pixels)) = HEADERS.iter().find(|known| known.0 == header) else {
            let known = HEADERS.map(|known| known.0).join(" | ");
            return Err(format!("found the header {header:?}; accepted: {known}"));
        };
        let mut path = GazePath { by_frame, in_pixels, held: false, points: Vec::new() };
        for (i, line) in lines {
            path.push(line).map_err(|problem| format!("line {}: {problem}", i + 1))?;
        }
        if path.points.is_empty() {
            return Err(format!("holds no point; accepted: rows of {header}"));
        }
        Ok(path)
    }

    fn push(&mut self, line: &str) -> Result<(), String> {
        let cells: Vec<f64> = line.split(',').map_while(|cell| cell.trim().parse().ok()).collect();
        let whole = |v: f64| v >= 0.0 && v.fract() == 0.0 && v <= f64::from(u32::MAX);
        let within = |v: f64| if self.in_pixels { v.is_finite() } else { (0.0..=1.0).contains(&v) };
        let stands = |v: f64| if self.by_frame { whole(v) } else { v.is_finite() };
        let [at, x, y] = match cells[..] {
            [at, x, y] if stands(at) && within(x) && within(y) => [at, x, y],
            _ => {
                let at = if self.by_frame { "a frame's number" } else { "a time in s" };
                let place = if self.in_pixels {
                    "two coordinates in pixels"
                } else {
                    "two fractions of the picture, 0 to 1"
                };
                return Err(format!("found {line:?}; accepted: {at} and {place}"));
            }
        };
        if self.points.last().is_some_and(|&(before, _)| before >= at) {
            let what = if self.by_frame { "frame" } else { "time" };
            return Err(format!("{what} {at} does not rise"));
        }
        self.points.push((at, [x, y]));
        Ok(())
    }

    /// The place at a moment, in the path's own unit.
    fn place(&self, moment: Moment) -> [f64; 2] {
        let at = if self.by_frame { f64::from(moment.frame) } else { moment.time };
        if self.held {
            let point = self.points.partition_point(|&(time, _)| time < at * (1.0 - 1e-12));
            return self
                .points
                .get(point)
                .or(self.points.last())
                .map_or([0.5, 0.5], |&(_, place)| place);
        }
        let next = self.points.partition_point(|&(t, _)| t <= at);
        match (next.checked_sub(1).map(|i| self.points[i]), self.points.get(next)) {
            (Some((t0, a)), Some(&(t1, b))) => {
                [0, 1].map(|i| a[i] + (b[i] - a[i]) * (at - t0) / (t1 - t0))
            }
            (Some((_, place)), None) | (None, Some(&(_, place))) => place,
            (None, None) => [0.5, 0.5],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(path: &GazePath, time: f64, frame: u32) -> [f64; 2] {
        path.place(Moment { time, frame })
    }

    #[test]
    fn a_path_is_straight_between_its_points_and_rests_at_its_ends() {
        let rows = "time_s,x,y\n0,0.5,0.5\n2,0.5,0.5\n# a comment\n3,0.9,0.1\n";
        let path = GazePath::from_rows(rows).unwrap();
        assert_eq!(place(&path, -1.0, 9), [0.5, 0.5]);
        assert_eq!(place(&path, 2.5, 9), [0.7, 0.3]);
        assert_eq!(place(&path, 9.0, 9), [0.9, 0.1]);
    }

    #[test]
    fn a_path_by_frame_gives_each_frame_its_row_and_pixels_are_taken_as_they_are() {
        let path = GazePath::from_rows("frame,x_px,y_px\n1001,10,20\n1003,12,-5\n").unwrap();
        assert_eq!(place(&path, 77.0, 1001), [10.0, 20.0]);
        assert_eq!(place(&path, 77.0, 1002), [11.0, 7.5]);
        assert_eq!(place(&path, 77.0, 1003), [12.0, -5.0]);
    }

    #[test]
    fn a_row_is_held_until_its_own_time_whatever_the_last_bits_of_a_frames_end() {
        let rows = "time_s,x,y\n0.1,0.1,0.1\n0.3,0.3,0.3\n0.4,0.4,0.4\n";
        let path = GazePath { held: true, ..GazePath::from_rows(rows).unwrap() };
        for (time, at) in
            [(0.0, 0.1), (0.1, 0.1), (0.2, 0.3), (0.1 + 0.2, 0.3), (0.4, 0.4), (9.0, 0.4)]
        {
            assert_eq!(place(&path, time, 1), [at; 2], "{time}");
        }
    }

    #[test]
    fn a_wrong_path_is_refused_with_its_line() {
        for (text, told) in [
            ("", "header"),
            ("time,x,y\n", "frame,x_px,y_px"),
            ("time_s,x,y\n", "no point"),
            ("time_s,x,y\n0,0.5\n", "line 2"),
            ("time_s,x,y\n0,0.5,0.5\n0,0.6,0.5\n", "line 3"),
            ("time_s,x,y\n0,0.5,1.5\n", "line 2"),
            ("time_s,x,y\n0,NaN,0.5\n", "line 2"),
            ("frame,x,y\n0.5,0.5,0.5\n", "line 2"),
            ("time_s,x_px,y_px\n0,inf,0.5\n", "line 2"),
        ] {
            let problem = GazePath::from_rows(text).unwrap_err();
            assert!(problem.contains(told), "{text:?}: {problem}");
        }
    }
}
