//! Half floats to single ones and back, whole runs at once, in integers that every processor has
//! vectors for, or by the processor itself where it takes sixteen. Rounding is to nearest, ties to
//! even.

use half::f16;
use pulp::{Arch, Simd, WithSimd};

/// The least magnitude of a float with the exponent 1, and of floats that are the least normal
/// half, too large for a half, and infinite.
const LEAST: u32 = 1 << 23;
const NORMAL: u32 = 113 << 23;
const OVER: u32 = 143 << 23;
const INFINITE: u32 = 255 << 23;

/// What the exponent of a float has more than that of a half.
const BIAS: u32 = 112 << 23;

/// Halves -> floats, exact. Both runs are of one length.
pub fn widen(from: &[f16], to: &mut [f32]) {
    assert_eq!(from.len(), to.len());
    #[cfg(target_arch = "x86_64")]
    if let Some(v4) = pulp::x86::V4::try_new() {
        return v4.vectorize(|| widen_sixteen(v4, from, to));
    }
    Arch::new().dispatch(|| widen_each(from, to));
}

#[inline(always)]
fn widen_each(from: &[f16], to: &mut [f32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = widened(from.to_bits());
    }
}

/// The same where a processor widens sixteen at once.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn widen_sixteen(v4: pulp::x86::V4, from: &[f16], to: &mut [f32]) {
    let ((from, from_rest), (to, to_rest)) = (from.as_chunks::<16>(), to.as_chunks_mut::<16>());
    for (to, from) in to.iter_mut().zip(from) {
        let halves = pulp::cast(from.map(f16::to_bits));
        *to = pulp::cast(v4.avx512f._mm512_cvtph_ps(halves));
    }
    widen_each(from_rest, to_rest);
}

#[inline(always)]
fn widened(half: u16) -> f32 {
    let bits = u32::from(half);
    let magnitude = (bits & 0x7fff) << 13;
    let special = if magnitude >= 31 << 23 { BIAS } else { 0 };
    let normal = magnitude + BIAS + special;
    let below = f32::from_bits(magnitude + NORMAL) - f32::from_bits(NORMAL);
    let magnitude = if magnitude < LEAST { below.to_bits() } else { normal };
    f32::from_bits(magnitude | (bits & 0x8000) << 16)
}

/// Floats -> halves. Returns whether any became infinite. Both runs are of one length.
pub(crate) fn narrow(from: &[f32], to: &mut [f16]) -> bool {
    assert_eq!(from.len(), to.len());
    #[cfg(target_arch = "x86_64")]
    if let Some(v4) = pulp::x86::V4::try_new() {
        return v4.vectorize(|| narrow_sixteen(v4, from, to));
    }
    Arch::new().dispatch(Narrow { from, to })
}

struct Narrow<'a> {
    from: &'a [f32],
    to: &'a mut [f16],
}

impl WithSimd for Narrow<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let mut infinite = 0u16;
        for (to, from) in self.to.iter_mut().zip(self.from) {
            let half = narrowed(*from);
            infinite |= u16::from(half & 0x7fff == 0x7c00);
            *to = f16::from_bits(half);
        }
        infinite != 0
    }
}

/// The same where a processor narrows sixteen at once. Its NaN keep what payload they can; ours
/// have none, on any processor.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn narrow_sixteen(v4: pulp::x86::V4, from: &[f32], to: &mut [f16]) -> bool {
    const NEAREST: i32 = 0;
    let ((from, from_rest), (to, to_rest)) = (from.as_chunks::<16>(), to.as_chunks_mut::<16>());
    let mut infinite = 0u16;
    for (to, from) in to.iter_mut().zip(from) {
        let floats = pulp::cast(*from);
        let halves: [u16; 16] = pulp::cast(v4.avx512f._mm512_cvtps_ph::<NEAREST>(floats));
        for (to, half) in to.iter_mut().zip(halves) {
            let magnitude = half & 0x7fff;
            infinite |= u16::from(magnitude == 0x7c00);
            let magnitude = if magnitude > 0x7c00 { 0x7e00 } else { magnitude };
            *to = f16::from_bits(half & 0x8000 | magnitude);
        }
    }
    let rest = Narrow { from: from_rest, to: to_rest };
    rest.with_simd(pulp::Scalar) | (infinite != 0)
}

#[inline(always)]
fn narrowed(float: f32) -> u16 {
    /// A float whose last place is that of the least half.
    const HALF: f32 = 0.5;
    let bits = float.to_bits();
    let magnitude = bits & 0x7fff_ffff;
    let beyond = if magnitude > INFINITE { 0x7e00 } else { 0x7c00 };
    let below = (f32::from_bits(magnitude) + HALF).to_bits().wrapping_sub(HALF.to_bits());
    let tie = 0xfff + (magnitude >> 13 & 1);
    let normal = magnitude.wrapping_sub(BIAS).wrapping_add(tie) >> 13;
    let within = if magnitude < NORMAL { below } else { normal };
    let half = if magnitude >= OVER { beyond } else { within };
    (half | bits >> 16 & 0x8000) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_goes_through_a_float_and_back_unchanged() {
        let halves: Vec<f16> = (0..=u16::MAX).map(f16::from_bits).filter(|h| !h.is_nan()).collect();
        let (mut floats, mut back) = (vec![0.0; halves.len()], vec![f16::ZERO; halves.len()]);
        widen(&halves, &mut floats);
        assert!(halves.iter().zip(&floats).all(|(h, f)| h.to_f32() == *f));
        assert!(narrow(&floats, &mut back));
        assert!(halves.iter().zip(&back).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn floats_between_all_halves_round_to_the_nearest_and_ties_to_even() {
        let between = |half: u16| {
            let [a, b] = [half, half + 1].map(|bits| f16::from_bits(bits).to_f32());
            let b = if b.is_finite() { b } else { 65536.0 };
            let middle = 0.5 * (a + b);
            [a, middle.next_down(), middle, middle.next_up(), b.next_down()]
        };
        let floats: Vec<f32> = (0..0x7c00).flat_map(between).flat_map(|v| [v, -v]).collect();
        let more = [f32::MAX, f32::INFINITY, f32::NAN, f32::MIN_POSITIVE, 1e-45, -0.0];
        let more =
            [&more[..], &[f32::from_bits(0x7f80_0001), f32::from_bits(0xffed_cba9)]].concat();
        let floats = [&floats[..], &more].concat();
        let mut halves = vec![f16::ZERO; floats.len()];
        narrow(&floats, &mut halves);
        for (float, half) in floats.iter().zip(halves) {
            let expected = f16::from_f32(*float);
            assert_eq!(half.is_nan(), expected.is_nan());
            assert!(half.is_nan() || half.to_bits() == expected.to_bits(), "{float:e}");
            assert_eq!(half.to_bits(), narrowed(*float), "on every processor");
        }
        let mut wide = [0.0; 2];
        widen(&[f16::NAN, f16::NEG_INFINITY], &mut wide);
        assert!(wide[0].is_nan() && wide[1] == f32::NEG_INFINITY);
    }

    #[test]
    fn what_overflows_is_told_and_rounding_is_to_the_nearest() {
        let mut halves = [f16::ZERO; 9];
        assert!(!narrow(&[65519.9; 9], &mut halves));
        assert_eq!(halves, [f16::MAX; 9]);
        assert!(narrow(&[0.0, 0.0, 0.0, -65520.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut halves));
        assert_eq!(halves[3], f16::NEG_INFINITY);
        assert!(!narrow(&[1.0 + 2f32.powi(-11); 9], &mut halves));
        assert_eq!(halves, [f16::ONE; 9]);
    }
}
