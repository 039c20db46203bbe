//! `cargo bench --bench against_copy`: how much longer each case takes than a copy of as many
//! bytes. Case and copy take turns, so that both meet the same noise; a row is the median of both
//! and of their ratio.
//!
//! Arguments: megapixels (all five sizes by default) and words that a case's name must hold.

mod cases;

use std::time::{Duration, Instant};

/// Turns of each case and its copy.
const TURNS: usize = 31;
const SIZES: [f64; 5] = [0.1, 0.25, 1.0, 2.0, 8.0];

fn main() {
    let asked: Vec<f64> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a.parse::<f64>().is_err() && !a.starts_with('-'))
        .collect();
    let sizes = if asked.is_empty() { SIZES.to_vec() } else { asked };
    println!("| case | threads | megapixels | ms | copy, ms | ratio |\n|---|---|---|---|---|---|");
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let Ok(pool) = pool else { return };
        for &megapixels in &sizes {
            for (name, set_up) in cases::all(megapixels) {
                if !words.iter().all(|word| name.contains(word)) {
                    continue;
                }
                let mut case = set_up();
                if case.whole_machine && threads < rayon::current_num_threads() {
                    continue;
                }
                let mut copy = cases::copy(case.bytes);
                let (ours, copied, ratio) = pool.install(|| in_turns(&mut case.work, &mut copy));
                let [ours, copied] =
                    [ours, copied].map(|time| 1e3 * time.as_secs_f64() / case.frames as f64);
                println!(
                    "| {} | {threads} | {megapixels} | {ours:.3} | {copied:.3} | {ratio:.2} |",
                    case.name
                );
            }
        }
    }
}

/// Median times of both and the median of their ratios.
fn in_turns(work: &mut dyn FnMut(), copy: &mut dyn FnMut()) -> (Duration, Duration, f64) {
    let timed = |work: &mut dyn FnMut()| {
        let begun = Instant::now();
        work();
        begun.elapsed()
    };
    timed(work);
    timed(copy);
    let turns: Vec<(Duration, Duration)> = (0..TURNS).map(|_| (timed(work), timed(copy))).collect();
    let mut ours: Vec<Duration> = turns.iter().map(|turn| turn.0).collect();
    let mut copies: Vec<Duration> = turns.iter().map(|turn| turn.1).collect();
    let mut ratios: Vec<f64> =
        turns.iter().map(|(a, b)| a.as_secs_f64() / b.as_secs_f64()).collect();
    ours.sort();
    copies.sort();
    ratios.sort_by(f64::total_cmp);
    (ours[TURNS / 2], copies[TURNS / 2], ratios[TURNS / 2])
}
