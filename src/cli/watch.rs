//! Progress and messages on stderr.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use sungaze::run::Watch;

use super::{say, stop};

/// Plain progress lines come this far apart.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Somebody at a terminal, or a log file.
pub(crate) struct Terminal {
    quiet: bool,
    bar: Option<ProgressBar>,
    begun: Instant,
    /// Milliseconds after `begun` at which the last plain line was written.
    last_line: AtomicU64,
}

impl Terminal {
    /// A bar on a terminal, plain lines elsewhere, nothing if `quiet`.
    pub(crate) fn new(quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let style =
                ProgressStyle::with_template("{bar:30} frame {pos}/{len}  {per_sec}  {eta} left");
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Terminal { quiet, bar, begun: Instant::now(), last_line: AtomicU64::new(0) }
    }

    /// Clears the bar.
    pub(crate) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn line(&self, done: usize, total: usize) {
        let now = self.begun.elapsed();
        let last = Duration::from_millis(self.last_line.load(Ordering::Relaxed));
        if done == total || now - last >= LINE_EVERY {
            self.last_line.store(now.as_millis() as u64, Ordering::Relaxed);
            let rate = done as f64 / now.as_secs_f64();
            let left = (total - done) as f64 / rate;
            say::message(&format!("frame {done}/{total}  {rate:.1}/s  {left:.0} s left"));
        }
    }
}

impl Watch for Terminal {
    fn frames(&self, done: usize, total: usize) {
        match &self.bar {
            Some(bar) => {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
            }
            None if !self.quiet => self.line(done, total),
            None => {}
        }
    }

    fn warn(&self, message: &str) {
        let print = || say::message(&format!("sungaze: {message}"));
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    fn interrupted(&self) -> bool {
        stop::asked()
    }

    fn leaving(&self) {
        stop::leaving();
    }
}
