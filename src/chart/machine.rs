//! What timings were taken on, and how.

use std::time::Instant;

pub(super) use crate::run::report::processor as name;

/// Runs of which the median is taken. They are spread over the whole measurement, so that another
/// program's burst falls upon few runs of any one method.
pub(super) const RUNS: usize = 9;

/// A run lasts at least this long, so that the clock's grain does not show.
const SHORTEST_RUN_NS: f64 = 1e5;

/// Nanoseconds that `work` takes in one run, warm, on this thread.
pub(super) fn nanoseconds(mut work: impl FnMut()) -> f64 {
    let mut run = |times: u32| {
        let start = Instant::now();
        (0..times).for_each(|_| work());
        start.elapsed().as_nanos() as f64 / f64::from(times)
    };
    let warm = run(1).max(1.0);
    run((SHORTEST_RUN_NS / warm).clamp(1.0, 1e6) as u32)
}

/// The median.
pub(super) fn median(mut runs: Vec<f64>) -> f64 {
    runs.sort_by(f64::total_cmp);
    runs.get(runs.len() / 2).copied().unwrap_or(f64::NAN)
}
