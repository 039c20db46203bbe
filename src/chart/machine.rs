//! What timings were taken on, and how.

use std::time::Instant;

/// The processor's own name where the system tells it, else the architecture and system.
pub(super) fn name() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    told.unwrap_or_else(|| format!("{} {}", std::env::consts::ARCH, std::env::consts::OS))
}

/// Runs of which the median is taken.
const RUNS: usize = 5;

/// A run lasts at least this long, so that the clock's grain does not show.
const SHORTEST_RUN_NS: f64 = 4e5;

/// Nanoseconds that `work` takes: warm, the median of several runs on one thread.
pub(super) fn nanoseconds(mut work: impl FnMut()) -> f64 {
    let mut run = |times: u32| {
        let start = Instant::now();
        (0..times).for_each(|_| work());
        start.elapsed().as_nanos() as f64 / f64::from(times)
    };
    let warm = run(1).max(1.0);
    let times = (SHORTEST_RUN_NS / warm).clamp(1.0, 1e6) as u32;
    let mut runs: Vec<f64> = (0..RUNS).map(|_| run(times)).collect();
    runs.sort_by(f64::total_cmp);
    runs[RUNS / 2]
}
