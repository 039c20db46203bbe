//! Half floats to single ones and back, whole runs at once. Rounding is to nearest, ties to even,
//! on every path.

use half::f16;
use half::slice::HalfFloatSliceExt;

/// The least float that rounds to an infinite half.
const OVERFLOWS: f32 = 65520.0;

/// Halves -> floats, exact.
pub fn widen(from: &[f16], to: &mut [f32]) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("f16c") {
        // SAFETY: the processor has just said that it knows these instructions.
        return unsafe { f16c::widen(from, to) };
    }
    from.convert_to_f32_slice(to);
}

/// Floats -> halves. Whether any became infinite.
pub fn narrow(from: &[f32], to: &mut [f16]) -> bool {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("f16c") && is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has just said that it knows these instructions.
        return unsafe { f16c::narrow(from, to) };
    }
    to.convert_from_f32_slice(from);
    from.iter().fold(false, |any, v| any | (v.abs() >= OVERFLOWS))
}

#[cfg(target_arch = "x86_64")]
mod f16c {
    use super::super::{TILE, ask_for};
    use half::f16;
    use std::arch::x86_64::{
        __m128i, _MM_FROUND_TO_NEAREST_INT, _mm_and_si128, _mm_cmpeq_epi16, _mm_loadu_si128,
        _mm_movemask_epi8, _mm_or_si128, _mm_set1_epi16, _mm_setzero_si128, _mm_storeu_si128,
        _mm256_cvtph_ps, _mm256_cvtps_ph, _mm256_loadu_ps, _mm256_storeu_ps,
    };

    /// # Safety
    /// The processor must know F16C.
    #[target_feature(enable = "avx,f16c")]
    pub unsafe fn widen(from: &[f16], to: &mut [f32]) {
        let ((from, from_rest), (to, to_rest)) = (from.as_chunks::<8>(), to.as_chunks_mut::<8>());
        for (from, to) in from.iter().zip(to) {
            ask_for(from.as_ptr().wrapping_add(TILE));
            // SAFETY: both are arrays of eight; the loads and stores need no alignment.
            unsafe {
                let halves = _mm_loadu_si128(from.as_ptr().cast::<__m128i>());
                _mm256_storeu_ps(to.as_mut_ptr(), _mm256_cvtph_ps(halves));
            }
        }
        for (from, to) in from_rest.iter().zip(to_rest) {
            *to = from.to_f32();
        }
    }

    /// # Safety
    /// The processor must know F16C and AVX2.
    #[target_feature(enable = "avx2,f16c")]
    pub unsafe fn narrow(from: &[f32], to: &mut [f16]) -> bool {
        let ((from, from_rest), (to, to_rest)) = (from.as_chunks::<8>(), to.as_chunks_mut::<8>());
        let (magnitude, infinite) = (_mm_set1_epi16(0x7fff), _mm_set1_epi16(0x7c00));
        let mut overflown = _mm_setzero_si128();
        for (from, to) in from.iter().zip(to) {
            // SAFETY: both are arrays of eight; the loads and stores need no alignment.
            unsafe {
                let halves =
                    _mm256_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(_mm256_loadu_ps(from.as_ptr()));
                _mm_storeu_si128(to.as_mut_ptr().cast::<__m128i>(), halves);
                overflown = _mm_or_si128(
                    overflown,
                    _mm_cmpeq_epi16(_mm_and_si128(halves, magnitude), infinite),
                );
            }
        }
        for (from, to) in from_rest.iter().zip(&mut *to_rest) {
            *to = f16::from_f32(*from);
        }
        _mm_movemask_epi8(overflown) != 0 || to_rest.iter().any(|half| half.is_infinite())
    }
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
