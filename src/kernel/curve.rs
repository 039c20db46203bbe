//! A curve read from a table: the signals of a film to light.

use pulp::{Simd, WithSimd};

use super::vectorised;

/// Steps of a curve from 0 to 1.
pub(super) const STEPS: usize = 1 << 14;

/// Signals beyond this are taken for it: 254 of limited range is 1.087.
const HIGHEST: f32 = 1.125;

/// Room of a table: a power of two, so that a masked place is always in it.
const ROOM: usize = 2 * STEPS;

/// A curve from 0 to a little more than 1, linear between its steps.
pub(crate) struct Curve(Box<[f32; ROOM]>);

impl Curve {
    /// The curve that takes these values.
    pub(crate) fn of(value: impl Fn(f64) -> f64) -> Curve {
        let mut table = Box::new([0.0; ROOM]);
        let last = (HIGHEST * STEPS as f32) as usize + 1;
        for (i, out) in table[..=last].iter_mut().enumerate() {
            *out = value(i as f64 / STEPS as f64) as f32;
        }
        Curve(table)
    }

    /// Its values for a run of signals, in place. Says how many signals reached 1.
    pub(crate) fn apply(&self, signals: &mut [f32]) -> u64 {
        vectorised(Run { table: &self.0, signals })
    }
}

struct Run<'a> {
    table: &'a [f32; ROOM],
    signals: &'a mut [f32],
}

impl WithSimd for Run<'_> {
    type Output = u64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> u64 {
        let (chunks, rest) = self.signals.as_chunks_mut();
        let reached: u32 = chunks.iter_mut().map(|chunk| of_chunk(self.table, chunk)).sum();
        let mut last = [0.0; LANES];
        last[..rest.len()].copy_from_slice(rest);
        let reached = reached + of_chunk(self.table, &mut last);
        rest.copy_from_slice(&last[..rest.len()]);
        u64::from(reached)
    }
}

/// Signals that are looked up together.
const LANES: usize = 16;

#[inline(always)]
#[expect(clippy::manual_clamp, reason = "max and min make 0 of NaN, clamp does not")]
fn of_chunk(table: &[f32; ROOM], signals: &mut [f32; LANES]) -> u32 {
    let (mut steps, mut between) = ([0i32; LANES], [0.0; LANES]);
    let mut reached = 0;
    for ((signal, step), between) in signals.iter().zip(&mut steps).zip(&mut between) {
        reached += u32::from(*signal >= 1.0);
        let place = signal.max(0.0).min(HIGHEST) * STEPS as f32;
        // SAFETY: 0 to 1.125 times 2^14, and 0 for NaN.
        *step = unsafe { place.to_int_unchecked::<i32>() };
        *between = place - *step as f32;
    }
    let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
    for ((low, high), step) in low.iter_mut().zip(&mut high).zip(steps) {
        let at = step as usize;
        (*low, *high) = (table[at % ROOM], table[(at + 1) % ROOM]);
    }
    for (i, signal) in signals.iter_mut().enumerate() {
        *signal = low[i] + between[i] * (high[i] - low[i]);
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_same_bits_and_signals_outside_are_the_nearest_inside() {
        let curve = Curve::of(|signal| signal.powf(2.4));
        let signals: Vec<f32> = (-50..777).map(|i| i as f32 / 601.0).collect();
        let (mut best, mut plain) = (signals.clone(), signals.clone());
        let reached = curve.apply(&mut best);
        let run = Run { table: &curve.0, signals: &mut plain };
        assert_eq!(run.with_simd(pulp::Scalar), reached);
        assert_eq!(best, plain);
        assert_eq!(reached, signals.iter().filter(|signal| **signal >= 1.0).count() as u64);
        assert_eq!((best[0], best[826]), (0.0, best[50 + 677]));
    }
}
