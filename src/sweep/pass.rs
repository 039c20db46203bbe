//! One pass through time for all durations of a case: frames, cut where somebody looks.

use crate::config::Config;
use crate::config::settings::Time;
use crate::error::Result;
use crate::run::Scene;
use crate::run::schedule::Step;
use crate::units::Seconds;

/// The light of one file held over [start, end), and the cell that looks at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub file: usize,
    pub start: f64,
    pub end: f64,
    pub cell: Option<usize>,
}

impl Span {
    /// How long the light is held; 0 for a look at the start.
    pub fn length(&self) -> Seconds {
        Seconds(self.end - self.start)
    }
}

/// Two times nearer than this share of them are one: a duration that is a frame's end looks at that frame.
const SAME: f64 = 1e-9;

/// The spans of a case. A still is held from each duration to the next, or in the frames of `[time]` if that says
/// anything; a sequence in its frames, up to the last duration.
pub fn spans(config: &Config, scene: &Scene, durations: &[f64]) -> Result<Vec<Span>> {
    let last = durations.last().copied().unwrap_or(0.0);
    let mut steps = scene.steps.clone();
    if scene.footage.len() == 1 {
        if config.settings.time == Time::default() {
            steps.truncate(1);
        }
        if let Some(step) = steps.last_mut() {
            step.duration = step.duration.max(last - step.start);
        }
    }
    let end = steps.last().map_or(0.0, Step::end);
    if last > end * (1.0 + SAME) {
        let problem = format!("found {last}, but the frames end at {end} s");
        return Err(config.wrong("sweep.durations_s", problem));
    }
    Ok(cut(&steps, durations))
}

/// Cuts frames at the durations; what comes after the last is left out.
fn cut(steps: &[Step], durations: &[f64]) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut looks = durations.iter().copied().enumerate().peekable();
    if let (Some(step), Some((cell, _))) = (steps.first(), looks.next_if(|&(_, d)| d == 0.0)) {
        spans.push(Span { file: step.file, start: 0.0, end: 0.0, cell: Some(cell) });
    }
    for step in steps {
        let mut start = step.start;
        while let Some((cell, end)) = looks.next_if(|&(_, d)| d <= step.end() * (1.0 + SAME)) {
            spans.push(Span { file: step.file, start, end, cell: Some(cell) });
            start = end;
        }
        if looks.peek().is_none() {
            break;
        }
        if start < step.end() * (1.0 - SAME) {
            spans.push(Span { file: step.file, start, end: step.end(), cell: None });
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(count: u32, each: f64) -> Vec<Step> {
        let step = |i: u32| Step { number: i + 1, file: i as usize, start: f64::from(i) * each, duration: each };
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
    fn a_duration_that_is_a_frames_end_but_for_rounding_looks_at_that_frame() {
        let spans = cut(&frames(48, 1.0 / 24.0), &[1.0, 2.0]);
        let looks: Vec<_> = spans.iter().filter(|s| s.cell.is_some()).map(|s| s.file).collect();
        assert_eq!(looks, [23, 47]);
        assert_eq!(spans.len(), 48);
        assert!(spans.iter().all(|s| s.end > s.start));
    }
}
