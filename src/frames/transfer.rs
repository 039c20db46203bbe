//! Transfer curves of displays: signals to linear light.
//!
//! A signal lies in 0..1. What a curve makes of it is relative to the display's peak, and times
//! [`Transfer::white`] it is cd/m2.
//!
//! * sRGB: IEC 61966-2-1.
//! * BT.1886: ITU-R BT.1886 with a black of zero, V^2.4; what a film of BT.709 or BT.2020 is shown
//!   by, and not the inverse of the camera's curve.
//! * PQ: SMPTE ST 2084, 10000 (max(E^(1/m2) - c1, 0) / (c2 - c3 E^(1/m2)))^(1/m1) cd/m2; absolute.
//! * HLG: ITU-R BT.2100-2, the inverse of its OETF and then its OOTF, Y^(gamma - 1) on all three.

use std::fmt::{Display, Formatter};

use crate::colour::Primaries;
use crate::units::Nits;

/// How signals stand for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    Srgb,
    Linear,
    /// Light is the signal to this power.
    Power(f64),
    Pq,
    /// With the peak of the display, cd/m2; unknown: the mixing of the reference display.
    Hlg(Option<f64>),
}

/// The peak of HLG's reference display, cd/m2 (BT.2100-2, note 5e).
const REFERENCE_PEAK: f64 = 1000.0;

impl Transfer {
    pub(crate) const BT1886: Transfer = Transfer::Power(2.4);

    /// Luminance of (1, 1, 1), where the curve itself says: PQ is absolute, its light in cd/m2.
    pub(crate) fn white(self) -> Option<Nits> {
        match self {
            Transfer::Pq => Some(Nits(1.0)),
            Transfer::Hlg(peak) => peak.map(Nits),
            _ => None,
        }
    }

    /// Light of one channel's signal; for HLG the light of the scene, before [`Transfer::shown`].
    pub(crate) fn light(self, signal: f64) -> f64 {
        let signal = signal.max(0.0);
        match self {
            Transfer::Srgb if signal <= 0.04045 => signal / 12.92,
            Transfer::Srgb => ((signal + 0.055) / 1.055).powf(2.4),
            Transfer::Linear => signal,
            Transfer::Power(power) => signal.powf(power),
            Transfer::Pq => pq(signal),
            Transfer::Hlg(_) => hlg(signal),
        }
    }

    /// The light that a display shows for the light of three channels. Only HLG mixes them: its
    /// OOTF raises their luminance (in BT.2020) to a power that depends on the display's peak.
    pub(crate) fn shown(self, rgb: [f32; 3]) -> [f32; 3] {
        let Transfer::Hlg(peak) = self else { return rgb };
        let y = 0.2627 * rgb[0] + 0.6780 * rgb[1] + 0.0593 * rgb[2];
        // Below 177 cd/m2 the power is negative, and black is black all the same.
        let power = system_gamma(peak.unwrap_or(REFERENCE_PEAK)) as f32 - 1.0;
        let gain = if y > 0.0 { y.powf(power) } else { 0.0 };
        rgb.map(|light| light * gain)
    }
}

impl Display for Transfer {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Transfer::Srgb => f.write_str("the sRGB curve"),
            Transfer::Linear => f.write_str("no curve, linear"),
            &Transfer::BT1886 => f.write_str("BT.1886 (the power 2.4)"),
            Transfer::Power(power) => write!(f, "the power {power:.3}"),
            Transfer::Pq => f.write_str("the PQ curve"),
            Transfer::Hlg(Some(peak)) => write!(f, "the HLG curve for a peak of {peak} cd/m2"),
            Transfer::Hlg(None) => f.write_str("the HLG curve"),
        }
    }
}

/// The primaries of a code of ITU-T H.273, table 2. The problem, if there is one, is a message.
pub(super) fn coded_primaries(code: u8) -> Result<Primaries, String> {
    match code {
        1 => Ok(Primaries::REC709),
        5 => Ok(Primaries::BT601_625),
        6 | 7 => Ok(Primaries::BT601_525),
        9 => Ok(Primaries::BT2020),
        11 => Ok(Primaries::P3_DCI),
        12 => Ok(Primaries::P3_D65),
        _ => Err(format!(
            "has primaries of the code {code} of H.273; read are 1, 5, 6, 7, 9, 11, 12"
        )),
    }
}

/// The curve of a code of ITU-T H.273, table 3. A camera's curve (BT.709, BT.2020) is not inverted:
/// its picture is shown by BT.1886.
pub(super) fn coded_transfer(code: u8, peak: Option<f64>) -> Result<Transfer, String> {
    match code {
        1 | 6 | 14 | 15 => Ok(Transfer::BT1886),
        4 => Ok(Transfer::Power(2.2)),
        5 => Ok(Transfer::Power(2.8)),
        8 => Ok(Transfer::Linear),
        13 => Ok(Transfer::Srgb),
        16 => Ok(Transfer::Pq),
        18 => Ok(Transfer::Hlg(peak)),
        _ => Err(format!(
            "has a transfer curve of the code {code} of H.273; read are 1, 4 to 6, 8, 13 to 16, 18"
        )),
    }
}

/// cd/m2 of a PQ signal.
fn pq(signal: f64) -> f64 {
    const M1: f64 = 2610.0 / 16384.0;
    const M2: f64 = 2523.0 / 4096.0 * 128.0;
    const C1: f64 = 3424.0 / 4096.0;
    const C2: f64 = 2413.0 / 4096.0 * 32.0;
    const C3: f64 = 2392.0 / 4096.0 * 32.0;
    let e = signal.min(1.0).powf(1.0 / M2);
    10_000.0 * ((e - C1).max(0.0) / (C2 - C3 * e)).powf(1.0 / M1)
}

/// Scene light, 0..1, of an HLG signal.
fn hlg(signal: f64) -> f64 {
    const A: f64 = 0.178_832_77;
    const B: f64 = 1.0 - 4.0 * A;
    const C: f64 = 0.559_910_73;
    if signal <= 0.5 { signal * signal / 3.0 } else { (((signal - C) / A).exp() + B) / 12.0 }
}

/// The system gamma of HLG for a display's peak in cd/m2: BT.2100-2, note 5f between 400 and 2000
/// cd/m2, and its extension outside.
fn system_gamma(peak: f64) -> f64 {
    if (400.0..=2000.0).contains(&peak) {
        1.2 + 0.42 * (peak / 1000.0).log10()
    } else {
        1.2 * 1.111f64.powf((peak / 1000.0).log2())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Curve;

    fn shown(transfer: Transfer, signal: [f64; 3]) -> [f64; 3] {
        let white = transfer.white().map_or(1.0, |white| white.0);
        let light = signal.map(|signal| transfer.light(signal) as f32);
        transfer.shown(light).map(|light| f64::from(light) * white)
    }

    fn near(found: f64, expected: f64, within: f64) {
        assert!((found / expected - 1.0).abs() < within, "{found}, should be {expected}");
    }

    /// Codes of 10 bits at full range; SMPTE ST 2084, annex, and BT.2408-7, table 1 (58 % for 203).
    #[test]
    fn pq_has_its_published_points() {
        let pq = |signal: f64| shown(Transfer::Pq, [signal; 3])[1];
        near(pq(0.5), 92.245_7, 1e-5);
        near(pq(1.0), 10_000.0, 1e-6);
        near(pq(0.5806), 203.0, 2e-3);
        near(pq(0.508_078), 100.0, 1e-4);
        near(pq(0.751_827), 1000.0, 1e-4);
        assert_eq!(pq(0.0), 0.0);
        assert_eq!(pq(-0.1), 0.0);
    }

    /// BT.2408-7: 75 % HLG is reference white, 203 cd/m2 on a display of 1000 cd/m2.
    #[test]
    fn hlg_has_its_reference_white_and_its_gamma_acts_on_luminance() {
        near(shown(Transfer::Hlg(Some(1000.0)), [0.75; 3])[0], 203.0, 3e-3);
        near(shown(Transfer::Hlg(Some(1000.0)), [1.0; 3])[0], 1000.0, 1e-5);
        near(shown(Transfer::Hlg(Some(4000.0)), [1.0; 3])[0], 4000.0, 1e-5);
        // E = 1, Y = .2627: red comes out at .2627^.2 of the peak, not at the peak.
        near(
            shown(Transfer::Hlg(Some(1000.0)), [1.0, 0.0, 0.0])[0],
            1000.0 * 0.2627f64.powf(0.2),
            1e-5,
        );
        assert_eq!(
            shown(Transfer::Hlg(Some(100.0)), [0.0; 3]),
            [0.0; 3],
            "dim displays show black"
        );
        near(hlg(0.5), 1.0 / 12.0, 1e-12);
        near(hlg(0.5 + 1e-9), 1.0 / 12.0, 1e-6);
    }

    #[test]
    fn a_table_keeps_to_its_curve() {
        for (transfer, within) in [(Transfer::Pq, 2e-6), (Transfer::BT1886, 2e-5)] {
            let table = Curve::of(|signal| transfer.light(signal));
            for i in 0..100_000 {
                let signal = (f64::from(i) + 0.5) / 99_000.0;
                let light = transfer.light(signal);
                let mut found = [signal as f32];
                table.apply(&mut found);
                if light > 1e-3 * transfer.light(1.0) || (transfer == Transfer::Pq && light > 0.1) {
                    // A signal of single precision is itself off by 6e-8, its light by more.
                    near(f64::from(found[0]), transfer.light(f64::from(signal as f32)), within);
                }
            }
        }
    }

    #[test]
    fn displays_of_old_have_their_powers() {
        near(Transfer::BT1886.light(0.5), 0.5f64.powf(2.4), 1e-15);
        near(Transfer::Srgb.light(0.5), 0.214_041, 1e-5);
        assert_eq!(Transfer::Srgb.light(1.0), 1.0);
        assert_eq!(Transfer::Linear.light(0.3), 0.3);
    }
}
