//! One pass through time for all durations of a case: frames, cut where somebody looks.

use crate::config::Config;
use crate::config::settings::Time;
use crate::error::Result;
use crate::run::schedule::Step;
use crate::run::{Moment, Scene};
use crate::units::Seconds;

/// The light of one file held over [start, end), and the cell that looks at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(crate) file: usize,
    start: f64,
    pub(crate) end: f64,
    /// The frame that it is of.
    number: u32,
    pub(crate) cell: Option<usize>,
}

impl Span {
    /// The moment for which the gaze is asked: the span's middle, as that of a run's frame.
    pub(super) fn aim(&self) -> Moment {
        Moment { time: 0.5 * (self.start + self.end), frame: self.number }
    }

    /// How long the light is held; 0 for a look at the start.
    pub(super) fn length(&self) -> Seconds {
        Seconds(self.end - self.start)
    }
}

/// Two times nearer than this share of them are one: a duration that is a frame's end looks at that
/// frame.
const SAME: f64 = 1e-9;

/// The spans of a case. A still is held from each duration to the next, after the frames of
/// `[time]` if that says anything or a gaze moves over it; a sequence in its frames, up to the last
/// duration.
pub(super) fn spans(config: &Config, scene: &Scene, durations: &[f64]) -> Result<Vec<Span>> {
    let last = durations.last().copied().unwrap_or(0.0);
    let mut steps = scene.steps.clone();
    if scene.footage.len() == 1 {
        if config.settings.time == Time::default() && config.settings.gaze.path.is_none() {
            steps.clear();
        }
        hold(&mut steps, durations);
    }
    let end = steps.last().map_or(0.0, |step| step.end);
    if last > end * (1.0 + SAME) {
        let problem = format!("found {last}, but the frames end at {end} s");
        return Err(config.wrong("sweep.durations_s", problem));
    }
    Ok(cut(&steps, durations))
}

/// Holds a still on after its frames, to each later duration.
fn hold(steps: &mut Vec<Step>, durations: &[f64]) {
    for &duration in durations {
        let start = steps.last().map_or(0.0, |step| step.end);
        if duration > start * (1.0 + SAME) {
            steps.push(Step { number: steps.len() as u32 + 1, file: 0, start, end: duration });
        }
    }
}

/// Cuts frames at the durations; what comes after the last is left out.
fn cut(steps: &[Step], durations: &[f64]) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut looks = durations.iter().copied().enumerate().peekable();
    if let Some((cell, _)) = looks.next_if(|&(_, d)| d == 0.0) {
        let (file, number) = steps.first().map_or((0, 1), |step| (step.file, step.number));
        spans.push(Span { file, start: 0.0, end: 0.0, number, cell: Some(cell) });
    }
    for step in steps {
        let Step { file, number, mut start, end: last } = *step;
        while let Some((cell, end)) = looks.next_if(|&(_, d)| d <= last * (1.0 + SAME)) {
            spans.push(Span { file, start, end, number, cell: Some(cell) });
            start = end;
        }
        if looks.peek().is_none() {
            break;
        }
        if start < last * (1.0 - SAME) {
            spans.push(Span { file, start, end: last, number, cell: None });
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(count: u32, each: f64) -> Vec<Step> {
        let step = |i: u32| Step {
            number: i + 1,
            file: i as usize,
            start: f64::from(i) * each,
            end: f64::from(i + 1) * each,
        };
        (0..count).map(step).collect()
    }

    fn told(spans: &[Span]) -> Vec<(usize, f64, f64, Option<usize>)> {
        spans.iter().map(|s| (s.file, s.start, s.end, s.cell)).collect()
    }

    #[test]
    fn a_duration_inside_a_frame_cuts_it_and_what_follows_the_last_is_not_seen() {
        let spans = cut(&frames(4, 1.0), &[0.0, 0.5, 2.0, 2.25]);
        let expected = [
            (0, 0.0, 0.0, Some(0)),
            (0, 0.0, 0.5, Some(1)),
            (0, 0.5, 1.0, None),
            (1, 1.0, 2.0, Some(2)),
            (2, 2.0, 2.25, Some(3)),
        ];
        assert_eq!(told(&spans), expected);
    }

    #[test]
    fn a_still_is_held_on_after_its_frames_from_each_duration_to_the_next() {
        let mut steps = frames(2, 0.5);
        steps[1].file = 0;
        hold(&mut steps, &[0.0, 0.25, 1.0, 4.0, 9.0]);
        assert_eq!(steps.iter().map(|step| step.end).collect::<Vec<_>>(), [0.5, 1.0, 4.0, 9.0]);
        let alone = |durations: &[f64]| {
            let mut steps = Vec::new();
            hold(&mut steps, durations);
            cut(&steps, durations)
        };
        assert_eq!(told(&alone(&[0.0])), [(0, 0.0, 0.0, Some(0))]);
        assert_eq!(told(&alone(&[0.1, 7.0])), [(0, 0.0, 0.1, Some(0)), (0, 0.1, 7.0, Some(1))]);
    }

    #[test]
    fn a_duration_that_is_a_frames_end_but_for_rounding_looks_at_that_frame() {
        let spans = cut(&frames(48, 1.0 / 24.0), &[1.0, 2.0]);
        let looks: Vec<_> = spans.iter().filter(|s| s.cell.is_some()).map(|s| s.file).collect();
        assert_eq!(looks, [23, 47]);
        assert_eq!(spans.len(), 48);
        assert!(spans.iter().all(|s| s.end > s.start));
    }
}
