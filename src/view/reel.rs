//! Which frame is in front of the eye when: a still always, a sequence by its own times.

use crate::run::schedule::Step;

/// The frames of a sequence in time; none for a still.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Reel {
    frames: Vec<Step>,
}

impl Reel {
    /// The reel of footage that is looked at in these steps. `still`: it has one frame, for as long as anyone looks.
    pub(crate) fn new(steps: &[Step], still: bool) -> Self {
        Reel { frames: if still { Vec::new() } else { steps.to_vec() } }
    }

    /// Whether the same frame is there for ever.
    pub(crate) fn is_still(&self) -> bool {
        self.frames.is_empty()
    }

    /// The file in front of the eye from `start` on.
    pub(crate) fn file(&self, start: f64) -> usize {
        let next = self.frames.partition_point(|frame| frame.start <= start);
        self.frames.get(next.max(1) - 1).map_or(0, |frame| frame.file)
    }

    /// When a look from `start` on that is to last until `end` must end at the latest, for the next frame; `None`
    /// where the sequence is over.
    pub(crate) fn until(&self, start: f64, end: f64) -> Option<f64> {
        let Some(last) = self.frames.last() else { return Some(end) };
        let next = self.frames.iter().map(|frame| frame.start).find(|&edge| edge > start);
        Some(end.min(next.unwrap_or(last.end))).filter(|&end| end > start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reel() -> Reel {
        let step = |i: usize| Step {
            number: i as u32,
            file: i,
            start: i as f64 * 0.5,
            end: (i + 1) as f64 * 0.5,
        };
        Reel::new(&[step(0), step(1), step(2)], false)
    }

    #[test]
    fn a_look_ends_with_its_frame_and_there_is_none_after_the_last() {
        assert_eq!(reel().until(0.0, 0.25), Some(0.25));
        assert_eq!(reel().until(0.25, 3.0), Some(0.5));
        assert_eq!(reel().until(1.25, 9.0), Some(1.5));
        assert_eq!(reel().until(1.5, 9.0), None);
        assert_eq!([0.0, 0.49, 0.5, 1.4, 7.0].map(|t| reel().file(t)), [0, 0, 1, 2, 2]);
    }

    #[test]
    fn a_still_is_there_for_ever() {
        let still = Reel::new(&[], true);
        assert_eq!((still.until(5.0, 1e9), still.file(1e9)), (Some(1e9), 0));
    }
}
