//! What a run tells while it goes on, and how it is asked to stop. The library itself never prints.

/// Somebody who watches a run. Called from the run's own threads.
pub trait Watch: Sync {
    /// `done` of `total` frames are written.
    fn frames(&self, done: usize, total: usize) {
        let _ = (done, total);
    }

    /// Something the user should know of at once.
    fn warn(&self, message: &str) {
        let _ = message;
    }

    /// Whether the run should stop after the frame in hand.
    fn interrupted(&self) -> bool {
        false
    }

    /// The run has heeded the interruption and is writing what it leaves: give it a moment.
    fn leaving(&self) {}
}

/// Nobody.
pub struct Unwatched;

impl Watch for Unwatched {}
