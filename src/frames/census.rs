//! What is wrong with samples - NaN, infinite, negative - and the two policies that mend it.

use half::f16;
use half::slice::HalfFloatSliceExt;

use crate::frames::options::{Negative, NonFinite, ReadOptions};
use crate::light::{Sample, Tally};

/// The first sample of a frame that is no number of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wild {
    plane: usize,
    x: usize,
    y: usize,
    value: f32,
}

/// What a stretch of samples holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Census {
    pub(crate) tally: Tally,
    largest: f32,
    first: Option<Wild>,
}

impl Census {
    /// Counts samples of one plane from column `x` of row `y` on, then mends them.
    pub(super) fn admit<T: Sample>(
        &mut self,
        samples: &mut [T],
        plane: usize,
        at: (usize, usize),
        mending: Mending,
    ) {
        self.count(samples, plane, at.0, at.1);
        if mending.measured {
            self.measure(samples);
        }
        mending.mend(samples);
    }

    /// Counts samples of one plane from column `x` of row `y` on.
    pub(super) fn count<T: Sample>(&mut self, samples: &[T], plane: usize, x: usize, y: usize) {
        let (mut wild, mut negative) = (false, 0u32);
        for sample in samples {
            wild |= !sample.is_finite();
            negative += u32::from(sample.is_negative());
        }
        if wild {
            self.count_one_by_one(samples, Wild { plane, x, y, value: 0.0 });
        } else {
            self.tally.negative += u64::from(negative);
        }
    }

    fn count_one_by_one<T: Sample>(&mut self, samples: &[T], start: Wild) {
        for (i, sample) in samples.iter().enumerate() {
            let value = sample.value();
            self.tally.nan += u64::from(value.is_nan());
            self.tally.infinite += u64::from(value.is_infinite());
            self.tally.negative += u64::from(value < 0.0);
            if !sample.is_finite() && self.first.is_none() {
                self.first = Some(Wild { x: start.x + i, value, ..start });
            }
        }
    }

    /// Keeps the largest finite value, for the policy that needs it.
    pub(super) fn measure<T: Sample>(&mut self, samples: &[T]) {
        for sample in samples {
            let value = sample.value();
            if value.is_finite() && value > self.largest {
                self.largest = value;
            }
        }
    }

    /// Both together; the first wild sample is the one that stands higher, then in the earlier
    /// plane.
    pub(super) fn plus(self, other: Census) -> Census {
        let order = |wild: &Wild| (wild.y, wild.plane, wild.x);
        Census {
            tally: self.tally.plus(other.tally),
            largest: self.largest.max(other.largest),
            first: self.first.into_iter().chain(other.first).min_by_key(order),
        }
    }
}

/// How samples are mended on the way in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mending {
    negative: Negative,
    /// What stands for infinity, once the frame's largest value is known.
    infinity: Option<f32>,
    /// Whether the largest finite value is looked for, against the day that it must stand for
    /// infinity.
    measured: bool,
}

impl Mending {
    /// The first reading under these options.
    pub(super) fn first(options: &ReadOptions) -> Mending {
        let measured = options.non_finite == NonFinite::Clamp;
        Mending { negative: options.negative, infinity: None, measured }
    }

    /// The second reading, after a census that found what the policy lets pass.
    pub(super) fn second(self, census: &Census) -> Mending {
        Mending { infinity: Some(census.largest), measured: false, ..self }
    }

    /// Mends samples that were counted.
    pub(super) fn mend<T: Sample>(self, samples: &mut [T]) {
        if let Some(infinity) = self.infinity {
            for sample in samples.iter_mut().filter(|sample| !sample.is_finite()) {
                let up = sample.value() == f32::INFINITY;
                *sample = if up { T::from_value(infinity) } else { T::default() };
            }
        }
        if self.negative == Negative::Clamp {
            for sample in samples {
                *sample = if sample.is_negative() { T::default() } else { *sample };
            }
        }
    }
}

/// Whether a frame with this census is to be read again with its infinities mended; the problem
/// where it is refused.
pub(super) fn verdict(
    census: &Census,
    policy: NonFinite,
    channel: impl Fn(usize) -> String,
) -> Result<bool, String> {
    match (census.first, policy) {
        (None, _) => Ok(false),
        (Some(_), NonFinite::Clamp) => Ok(true),
        (Some(Wild { plane, x, y, value }), NonFinite::Error) => Err(format!(
            "channel {} is {value} at pixel ({x}, {y}) ({} NaN and {} infinite samples in all); \
             non_finite = \"clamp\" lets it pass",
            channel(plane),
            census.tally.nan,
            census.tally.infinite
        )),
    }
}

/// Halves to floats, by the processor's own conversion where it has one.
pub(super) fn widen(halves: &[f16], floats: &mut [f32]) {
    halves.convert_to_f32_slice(floats);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flaw_is_counted_once_in_either_width() {
        let values = [1.0, -2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, -f32::NAN];
        let halves: Vec<f16> = values.iter().map(|&v| f16::from_f32(v)).collect();
        let tally = Tally { nan: 2, infinite: 2, negative: 2, clipped: 0 };
        let (mut of_floats, mut of_halves) = (Census::default(), Census::default());
        of_floats.count(&values, 1, 10, 3);
        of_halves.count(&halves, 1, 10, 3);
        assert_eq!((of_floats.tally, of_halves.tally), (tally, tally));
        assert_eq!(of_halves.first.map(|wild| (wild.plane, wild.x, wild.y)), Some((1, 12, 3)));
    }

    #[test]
    fn infinity_becomes_the_largest_value_and_the_rest_dark() {
        let mut values = [1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0];
        Mending { negative: Negative::Clamp, infinity: Some(7.0), measured: false }
            .mend(&mut values);
        assert_eq!(values, [1.0, 0.0, 7.0, 0.0, 0.0]);
        Mending { negative: Negative::Keep, infinity: None, measured: false }.mend(&mut values);
        assert_eq!(values[2], 7.0);
    }
}
