//! Which file is looked at when: from `[time]` and the frames that are there to a list of looks.

use crate::config::Config;
use crate::config::settings::{Time, Times};
use crate::error::Result;
use crate::run::gaze::Gaze;

/// One frame of the run: the light of `file`, held over [start, end), s. The end is the time of its
/// state and percept; it is kept as it was given, since a start and a length do not always add up to
/// it again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) number: u32,
    pub(crate) file: usize,
    pub(crate) start: f64,
    pub(crate) end: f64,
}

impl Step {
    /// How long the light is held, s.
    pub(crate) fn duration(&self) -> f64 {
        self.end - self.start
    }

    /// Its middle, s.
    pub(crate) fn middle(&self) -> f64 {
        self.start + 0.5 * self.duration()
    }
}

/// Frames of a still, where `[time]` is silent: the end of the first and of the last, s, and how
/// many. Each lasts 8.3 % longer than the one before, so that most of them show the greening of a
/// low sun, which is over in ten seconds.
const STILL: (f64, f64, usize) = (1.0 / 24.0, 60.0, 60);
/// The root of (g^60 - 1)/(g - 1) = 60 / (1/24).
const GROWTH: f64 = 1.0831775737980034;
/// Frames a second, where neither `[time]` nor the file says.
const FPS: f64 = 24.0;

/// The frames of a still that is stared at, numbered from 1.
pub(crate) fn of_still(config: &Config) -> Result<Vec<Step>> {
    let time = &config.settings.time;
    let edges = match time {
        Time { times_s: Some(Times::Listed(times)), .. } => edges_of_times(config, times)?,
        Time { duration_s: Some(duration), .. } => {
            even_edges(config, *duration, interval(time, FPS))?
        }
        Time { fps: Some(_), .. } | Time { interval_s: Some(_), .. } => {
            even_edges(config, STILL.1, interval(time, FPS))?
        }
        _ => growing_edges(),
    };
    Ok(steps(&edges, (1..).map(|number| (number, 0))))
}

/// The frames of a uniform field: one for each of its lights, in turns, that `[time]` may cut finer.
/// `edges`: their starts and the end of the last, s; none for one light that stays.
pub(crate) fn of_field(config: &Config, edges: &[f64], lights: usize) -> Result<Vec<Step>> {
    let time = &config.settings.time;
    if edges.is_empty() {
        return of_still(config);
    }
    let cut = time.fps.map(|fps| 1.0 / fps).or(time.interval_s);
    let mut parts: Vec<(f64, usize)> = Vec::new();
    for (i, edge) in edges.windows(2).enumerate() {
        let length = edge[1] - edge[0];
        let pieces = even_edges(config, length, cut.unwrap_or(length))?;
        let starts = &pieces[..pieces.len() - 1];
        parts.extend(starts.iter().map(|start| (edge[0] + start, i % lights)));
    }
    let ends = parts.iter().map(|part| part.0).chain(edges.last().copied());
    let frames = (1..).zip(parts.iter().map(|part| part.1));
    Ok(steps(&ends.collect::<Vec<_>>(), frames))
}

/// The frames of a sequence: `numbers` and the file that shows each, with the rate that the files
/// tell, or the times of a film.
pub(crate) fn of_sequence(
    config: &Config,
    numbers: &[u32],
    shows: &[usize],
    file_fps: Option<f64>,
    film: Option<&[f64]>,
) -> Result<Vec<Step>> {
    let time = &config.settings.time;
    if time.duration_s.is_some() {
        return Err(config.wrong(
            "time.duration_s",
            "belongs to a still; a sequence lasts as long as its frames",
        ));
    }
    let is_silent = time.fps.is_none() && time.interval_s.is_none();
    let edges = match (time.listed(), film.filter(|_| is_silent)) {
        (Some(times), _) => edges_of_frames(config, times, numbers.len())?,
        (None, Some(times)) => edges_of_film(times, shows),
        (None, None) => edges_of_numbers(numbers, interval(time, file_fps.unwrap_or(FPS))),
    };
    Ok(steps(&edges, numbers.iter().copied().zip(shows.iter().copied())))
}

/// How frames are looked at: one after the other, or by the gaze path. Then looks end at its rows,
/// are numbered from 1, and each is at the light of the frame that is there when it begins.
pub(crate) fn looks(config: &Config, frames: &[Step]) -> Result<Vec<Step>> {
    if !config.settings.time.follows_the_gaze() {
        return Ok(frames.to_vec());
    }
    let ends = Gaze::of(config)?.rows();
    if ends.first().is_some_and(|&(end, _)| end <= 0.0) {
        return Err(config.wrong("gaze.path", "its first frame ends at 0 s; accepted: later"));
    }
    let edges: Vec<f64> = std::iter::once(0.0).chain(ends.iter().map(|&(end, _)| end)).collect();
    let file = |start: f64| {
        let next = frames.partition_point(|frame| frame.start <= start);
        frames.get(next.max(1) - 1).map_or(0, |frame| frame.file)
    };
    Ok(steps(&edges, (1..).zip(edges.iter().map(|&start| file(start)))))
}

/// Frames a second, where all frames but a shortened last one are alike.
pub(crate) fn rate(steps: &[Step]) -> Option<f64> {
    let first = steps.first()?.duration();
    let alike = |step: &Step| (step.duration() / first - 1.0).abs() < 1e-6;
    steps.iter().rev().skip(usize::from(steps.len() > 1)).all(alike).then_some(1.0 / first)
}

fn interval(time: &Time, fps: f64) -> f64 {
    time.interval_s.unwrap_or_else(|| 1.0 / time.fps.unwrap_or(fps))
}

fn steps(edges: &[f64], frames: impl Iterator<Item = (u32, usize)>) -> Vec<Step> {
    let spans = edges.windows(2);
    spans
        .zip(frames)
        .map(|(e, (number, file))| Step { number, file, start: e[0], end: e[1] })
        .collect()
}

fn growing_edges() -> Vec<f64> {
    let (first, last, count) = STILL;
    let end = |i: usize| first * (GROWTH.powi(i as i32) - 1.0) / (GROWTH - 1.0);
    (0..count).map(end).chain([last]).collect()
}

/// Even frames up to a duration; the last is shortened.
fn even_edges(config: &Config, duration: f64, interval: f64) -> Result<Vec<f64>> {
    let count = (duration / interval * (1.0 - 1e-12)).ceil().max(1.0);
    if count > 1e7 {
        return Err(config
            .wrong("time", format!("asks for {count} frames; at most 10 000 000 are accepted")));
    }
    Ok((0..count as u32).map(|i| f64::from(i) * interval).chain([duration]).collect())
}

/// A still is looked at over these times: each is the start of a frame but the last, which ends it,
/// unless `duration_s` says when the last frame ends.
fn edges_of_times(config: &Config, times: &[f64]) -> Result<Vec<f64>> {
    let mut edges = times.to_vec();
    match config.settings.time.duration_s {
        Some(end) if edges.last().is_some_and(|&last| last < end) => edges.push(end),
        Some(end) => {
            let problem = format!("found {end}, which is not after the last of time.times_s");
            return Err(config.wrong("time.duration_s", problem));
        }
        None if edges.len() < 2 => {
            return Err(
                config.wrong("time.times_s", "a still needs a start and an end, or duration_s")
            );
        }
        None => {}
    }
    Ok(edges)
}

/// Starts, one a frame (the last frame lasts as long as the one before), or one more: the end.
fn edges_of_frames(config: &Config, times: &[f64], frames: usize) -> Result<Vec<f64>> {
    let (time, mut edges) = (&config.settings.time, times.to_vec());
    match times {
        _ if times.len() == frames + 1 => {}
        [.., before, last] if times.len() == frames => edges.push(last + (last - before)),
        [only] if frames == 1 => edges.push(only + 1.0 / FPS),
        _ => {
            let problem = format!(
                "found {} times for {frames} frames; accepted: {frames}, or {} with the end",
                times.len(),
                frames + 1
            );
            let listed = if time.frames_s.is_some() { "time.frames_s" } else { "time.times_s" };
            return Err(config.wrong(listed, problem));
        }
    }
    Ok(edges)
}

/// Each frame of a film is seen until the next one that is looked at; the last as long as it lasts.
fn edges_of_film(times: &[f64], shows: &[usize]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (shows.first(), shows.last()) else { return Vec::new() };
    let starts = shows.iter().map(|&frame| times[frame] - times[first]);
    starts.chain([times[last + 1] - times[first]]).collect()
}

/// Time follows frame numbers: frame n is at (n - first) intervals, whatever steps the numbers
/// take.
fn edges_of_numbers(numbers: &[u32], interval: f64) -> Vec<f64> {
    let Some(&first) = numbers.first() else { return Vec::new() };
    let at = |number: u32| f64::from(number - first) * interval;
    let mut edges: Vec<f64> = numbers.iter().map(|&n| at(n)).collect();
    let last_step = match numbers {
        [.., before, last] => f64::from(last - before) * interval,
        _ => interval,
    };
    edges.push(edges[edges.len() - 1] + last_step);
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(toml: &str) -> Config {
        Config::parse(toml, "test", "test", std::path::Path::new(""), &[]).unwrap()
    }

    fn ends(steps: &[Step]) -> Vec<f64> {
        steps.iter().map(|step| step.end).collect()
    }

    #[test]
    fn a_still_without_times_is_stared_at_for_a_minute_in_sixty_growing_frames() {
        let steps = of_still(&config("")).unwrap();
        assert_eq!(steps.len(), 60);
        assert_eq!((steps[0].number, steps[0].start, steps[0].end), (1, 0.0, 1.0 / 24.0));
        assert_eq!(steps[59].end, 60.0);
        let greening = steps.iter().filter(|step| (0.2..10.0).contains(&step.end)).count();
        assert!(greening > 30, "{greening} of 60 frames show the greening");
        assert!(steps.windows(2).all(|w| (w[0].end - w[1].start).abs() < 1e-12));
    }

    #[test]
    fn the_last_frame_of_a_still_is_shortened() {
        let steps = of_still(&config("time = { duration_s = 1.0, interval_s = 0.3 }")).unwrap();
        assert_eq!(steps.len(), 4);
        assert!((steps[3].duration() - 0.1).abs() < 1e-12);
        assert_eq!(of_still(&config("time = { duration_s = 2.0, fps = 24 }")).unwrap().len(), 48);
    }

    #[test]
    fn time_follows_frame_numbers_not_files() {
        let steps =
            of_sequence(&config("time = { fps = 10 }"), &[5, 6, 9], &[0, 0, 1], Some(25.0), None)
                .unwrap();
        assert_eq!(
            ends(&steps).iter().map(|e| (e * 10.0).round()).collect::<Vec<_>>(),
            [1.0, 4.0, 7.0]
        );
        let by_file = of_sequence(&config(""), &[5, 6], &[0, 1], Some(25.0), None).unwrap();
        assert_eq!(by_file[0].duration(), 0.04);
    }

    #[test]
    fn a_film_is_seen_at_its_own_times_unless_the_configuration_has_others() {
        let film = [0.0, 0.3, 0.4, 0.9, 1.0];
        let ends_of = |toml: &str, shows: &[usize]| {
            let numbers: Vec<u32> = shows.iter().map(|&frame| frame as u32 + 1).collect();
            ends(&of_sequence(&config(toml), &numbers, shows, Some(4.0), Some(&film)).unwrap())
        };
        assert_eq!(ends_of("", &[0, 1, 2, 3]), film[1..]);
        assert_eq!(ends_of("", &[1, 3]), [0.9 - 0.3, 1.0 - 0.3]);
        assert_eq!(ends_of("time = { fps = 2 }", &[1, 3]), [1.0, 2.0]);
    }

    #[test]
    fn times_are_starts_and_may_name_the_end() {
        let starts = of_sequence(
            &config("time = { times_s = [0, 0.5, 2] }"),
            &[1, 2, 3],
            &[0, 1, 2],
            None,
            None,
        )
        .unwrap();
        assert_eq!(ends(&starts), [0.5, 2.0, 3.5]);
        let ended =
            of_sequence(&config("time = { times_s = [0, 0.5, 2] }"), &[1, 2], &[0, 1], None, None)
                .unwrap();
        assert_eq!(ends(&ended), [0.5, 2.0]);
        assert!(
            of_sequence(&config("time = { times_s = [0, 1] }"), &[1, 2, 3], &[0, 1, 2], None, None)
                .is_err()
        );
    }
}
