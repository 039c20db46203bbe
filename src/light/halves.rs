//! Half floats to single ones and back, whole runs at once. Rounding is to nearest, ties to even,
//! on every path.

use half::f16;
use half::slice::HalfFloatSliceExt;

/// Halves -> floats, exact. Both runs are of one length.
pub fn widen(from: &[f16], to: &mut [f32]) {
    from.convert_to_f32_slice(to);
}

/// Floats -> halves. Returns whether any became infinite. Both runs are of one length.
pub fn narrow(from: &[f32], to: &mut [f16]) -> bool {
    to.convert_from_f32_slice(from);
    to.iter().fold(false, |any, half| any | (half.to_bits() & 0x7fff == 0x7c00))
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
