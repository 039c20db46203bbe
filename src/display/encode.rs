//! sRGB, 8 bit.
//!
//! ```text
//! v <= 0.0031308: 12.92 v        else 1.055 v^(1/2.4) - 0.055        (IEC 61966-2-1:1999)
//! ```
//!
//! The nearest of 256 codes, exactly: the upper half of a number's bits leads to the code of the
//! lowest number with the same half, and at most one step from code to code lies between it and the
//! next.

use std::sync::LazyLock;

/// Codes by the upper half of an f32's bits, and where each code begins.
pub(super) struct Srgb {
    codes: Vec<u8>,
    begins: [f32; 257],
}

/// Below this, 2^-13, the code is 0.
const LEAST: f32 = 1.0 / 8192.0;

/// The tables, made once.
pub(super) fn srgb() -> &'static Srgb {
    static SRGB: LazyLock<Srgb> = LazyLock::new(Srgb::new);
    &SRGB
}

impl Srgb {
    fn new() -> Self {
        let mut begins = [f32::INFINITY; 257];
        begins[0] = 0.0;
        for (code, begin) in begins.iter_mut().enumerate().take(256).skip(1) {
            *begin = least_at_or_above(decoded((code as f64 - 0.5) / 255.0));
        }
        let lows =
            (LEAST.to_bits() >> 16..=1f32.to_bits() >> 16).map(|half| f32::from_bits(half << 16));
        let codes =
            lows.map(|low| (begins.partition_point(|&begin| begin <= low) - 1) as u8).collect();
        Srgb { codes, begins }
    }

    /// The codes nearest to linear values; values outside 0..=1 take the nearest that is inside.
    #[inline(always)]
    #[expect(clippy::manual_clamp, reason = "clamp would let NaN pass")]
    pub fn code_each<const N: usize>(&self, linear: &[f32; N]) -> [u8; N] {
        let (mut inside, mut codes) = ([0.0; N], [0; N]);
        for (inside, linear) in inside.iter_mut().zip(linear) {
            *inside = linear.max(LEAST).min(1.0);
        }
        for (code, v) in codes.iter_mut().zip(inside) {
            *code = self.codes[((v.to_bits() >> 16) - (LEAST.to_bits() >> 16)) as usize];
        }
        let mut next = [0.0; N];
        for (next, code) in next.iter_mut().zip(codes) {
            *next = self.begins[usize::from(code) + 1];
        }
        for ((code, v), next) in codes.iter_mut().zip(inside).zip(next) {
            *code += u8::from(v >= next);
        }
        codes
    }
}

/// The linear value of an encoded one.
fn decoded(v: f64) -> f64 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// The least f32 that is not below a positive value.
fn least_at_or_above(v: f64) -> f32 {
    let near = v as f32;
    if f64::from(near) < v { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(v: f64) -> f64 {
        if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
    }

    fn code(v: f32) -> u8 {
        srgb().code_each(&[v])[0]
    }

    #[test]
    fn every_code_is_the_nearest_one() {
        for bits in (0..=1f32.to_bits()).step_by(1009) {
            let v = f32::from_bits(bits);
            let off = 255.0 * encoded(f64::from(v)) - f64::from(code(v));
            assert!(off.abs() <= 0.500_01, "{v} is {off} codes off");
        }
    }

    #[test]
    fn no_value_at_the_edge_of_a_code_is_passed_over() {
        for code in 1..=255u8 {
            let begin = least_at_or_above(decoded((f64::from(code) - 0.5) / 255.0));
            assert_eq!(srgb().code_each(&[begin.next_down(), begin]), [code - 1, code]);
        }
    }

    #[test]
    fn values_beyond_the_code_take_its_ends() {
        let ends = [f32::MIN, -0.0, f32::NAN, 1.0, 1.5, f32::MAX].map(code);
        assert_eq!(ends, [0, 0, 0, 255, 255, 255]);
    }
}
