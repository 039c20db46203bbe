//! sRGB, 8 bit.
//!
//! ```text
//! v <= 0.0031308: 12.92 v        else 1.055 v^(1/2.4) - 0.055        (IEC 61966-2-1:1999)
//! ```
//!
//! The nearest of 256 codes, exactly. A polynomial, which compilers vectorise, comes within 1.4e-4
//! of the code; where that lies within [`DOUBT`] of the middle between two codes, a table decides:
//! the upper half of a number's bits leads to the code of the lowest number with the same half, and
//! at most one step from code to code lies between it and the next.

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
    pub(crate) fn code_each<const N: usize>(&self, linear: &[f32; N]) -> [u8; N] {
        let (mut inside, mut codes, mut doubt) = ([0.0; N], [0; N], 0);
        for ((inside, linear), code) in inside.iter_mut().zip(linear).zip(&mut codes) {
            *inside = linear.max(LEAST).min(1.0);
            let exact = raised(*inside);
            let whole = exact + WHOLE;
            doubt |= u32::from((exact - (whole - WHOLE)).abs() > 0.5 - DOUBT);
            *code = whole.to_bits() as u8;
        }
        if doubt != 0 {
            for (code, v) in codes.iter_mut().zip(inside) {
                *code = self.code(v);
            }
        }
        codes
    }

    /// The code of a value in [`LEAST`]..=1, by the table.
    #[inline(always)]
    fn code(&self, v: f32) -> u8 {
        let code = self.codes[((v.to_bits() >> 16) - (LEAST.to_bits() >> 16)) as usize];
        code + u8::from(v >= self.begins[usize::from(code) + 1])
    }
}

/// Codes nearer than this to the middle between two are looked up.
const DOUBT: f32 = 1.0 / 2048.0;

/// Added to a small number, it leaves the nearest whole one in the lowest bits.
const WHOLE: f32 = (3 << 22) as f32;

/// 255 times the encoded value, of a value in [`LEAST`]..=1. With v = 2^e m, v^(5/12) =
/// 2^i 2^(r/12) m^(5/12) where 5 e = 12 i + r: polynomials of m in 1..2 (relative error 1.7e-7) and
/// of r/12 - 1/2 (7.5e-8), fitted for the least error.
#[inline(always)]
fn raised(v: f32) -> f32 {
    let bits = v.to_bits();
    let m = f32::from_bits((bits & 0x7f_ffff) | 0x3f80_0000);
    let fifth = 5 * ((bits >> 23) as i32 - 127);
    // Down to the next multiple of twelve: right from -80 to 0.
    let twelfth = (fifth * 21_845) >> 18;
    let t = (fifth - 12 * twelfth) as f32 * (1.0 / 12.0) - 0.5;
    let power = horner(&MANTISSA, m) * horner(&EXPONENT, t);
    let scale = f32::from_bits(((twelfth + 127) << 23) as u32);
    let curved = power * scale * (255.0 * 1.055 * std::f32::consts::SQRT_2) - 255.0 * 0.055;
    if v <= 0.003_130_8 { 255.0 * 12.92 * v } else { curved }
}

/// m^(5/12), lowest power first.
const MANTISSA: [f32; 7] = [
    0.350_306_9,
    1.064_131_3,
    -0.687_737_05,
    0.390_423_36,
    -0.145_197_63,
    0.030_927_95,
    -0.002_854_702_8,
];

/// 2^t, lowest power first.
const EXPONENT: [f32; 6] =
    [1.000_000_1, 0.693_146_94, 0.240_221_2, 0.055_507_134, 0.009_675_541, 0.001_327_647_1];

#[inline(always)]
fn horner<const N: usize>(coefficients: &[f32; N], x: f32) -> f32 {
    let mut sum = 0.0;
    for i in (0..N).rev() {
        sum = sum * x + coefficients[i];
    }
    sum
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
    fn the_polynomial_is_as_near_as_the_head_of_the_module_says() {
        let bits = (LEAST.to_bits()..=1f32.to_bits()).step_by(61);
        let off = |v: f32| (f64::from(raised(v)) - 255.0 * encoded(f64::from(v))).abs();
        let worst = bits.map(f32::from_bits).map(off).fold(0.0, f64::max);
        assert!(worst < 1.5e-4, "{worst}");
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
