//! What the name of a channel says about its wavelength.
//!
//! The layout of Fichet, Pacanowski & Wilkie (2021, JCGT 10(3)) names a channel
//! `((S[0-3])|T).<number with a decimal comma><SI prefix>(m|Hz)`: S0 is radiance, S1 to S3 its
//! polarisation, T a reflectance. A frequency f stands for the wavelength c/f. Mitsuba 0.5 wrote
//! `400.00-410.00nm`, the limits of a band.

use crate::spectrum::Band;

/// Speed of light in vacuum, m/s (exact, SI).
const LIGHT_SPEED: f64 = 299_792_458.0;

/// Powers of ten of the SI prefixes in the order of the layout's expression; `da` stands before
/// `d`.
const PREFIXES: [(&str, i32); 16] = [
    ("Y", 24),
    ("Z", 21),
    ("E", 18),
    ("P", 15),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("da", 1),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("n", -9),
    ("p", -12),
];

/// The meaning of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// Radiance at a wavelength, nm.
    Radiance(f64),
    /// Stokes components S1 to S3.
    Polarisation,
    /// A reflectance or transmittance: not light.
    Reflective,
    /// Radiance between two wavelengths.
    Between(Band),
    /// Anything else.
    Other,
}

/// Reads the name of a channel, without its layer.
pub(super) fn meaning(name: &str) -> Meaning {
    match name.split_once('.') {
        Some((quantity, rest)) if matches!(quantity, "S0" | "S1" | "S2" | "S3" | "T") => {
            match (quantity, wavelength(rest)) {
                (_, None) => Meaning::Other,
                ("S0", Some(nm)) => Meaning::Radiance(nm),
                ("T", _) => Meaning::Reflective,
                _ => Meaning::Polarisation,
            }
        }
        _ => limits(name).map_or(Meaning::Other, Meaning::Between),
    }
}

/// The wavelength, nm, of `<number><prefix>(m|Hz)`.
fn wavelength(text: &str) -> Option<f64> {
    let split = number_length(text);
    let number: f64 = text[..split].replace(',', ".").parse().ok()?;
    let unit = &text[split..];
    let (prefix, is_length) = match unit.strip_suffix("Hz") {
        Some(prefix) => (prefix, false),
        None => (unit.strip_suffix('m')?, true),
    };
    let power = match prefix {
        "" => 0,
        _ => PREFIXES.iter().find(|(symbol, _)| *symbol == prefix)?.1,
    };
    let nm = if is_length {
        number * 10f64.powi(power + 9)
    } else {
        LIGHT_SPEED / (number * 10f64.powi(power)) * 1e9
    };
    // Powers of ten are inexact in binary: 0.7 um is to be 700 nm.
    let nm = (nm * 1e6).round() / 1e6;
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

/// How many bytes of `text` are `\d*,?\d*([Ee][+-]?\d+)?`.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b',') {
        end += 1;
        end += digits(end);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = bytes.get(end + 1 + sign..).map_or(0, |_| digits(end + 1 + sign));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// The band of `400.00-410.00nm`.
fn limits(name: &str) -> Option<Band> {
    let (low, high) = name.strip_suffix("nm")?.split_once('-')?;
    let plain = |text: &str| {
        text.bytes().all(|b| b.is_ascii_digit() || b == b'.').then(|| text.parse().ok())?
    };
    let (low, high): (f64, f64) = (plain(low)?, plain(high)?);
    (0.0 < low && low < high && high.is_finite()).then(|| Band {
        centre: (low + high) / 2.0,
        low,
        high,
    })
}

/// The number that stands for `{nm}` or `{index}` in `name`, under a pattern split into what stands
/// before and after it. Both decimal signs are read.
pub(super) fn number_in(name: &str, before: &str, after: &str) -> Option<f64> {
    let text = name.strip_prefix(before)?.strip_suffix(after)?;
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b == b'.' || b == b',');
    let number: f64 = plain.then(|| text.replace(',', ".").parse().ok())??;
    number.is_finite().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_channel_name_panics_or_gives_a_wavelength_that_is_none(
            name in "(S[0-4]|T|)\\.?[0-9,.eE+-]{0,12}(Y|da|d|m|n|u|)(m|Hz|nm|)|\\PC{0,12}",
        ) {
            match meaning(&name) {
                Meaning::Radiance(nm) => prop_assert!(nm.is_finite() && nm > 0.0),
                Meaning::Between(band) => prop_assert!(0.0 < band.low && band.low < band.high),
                _ => {}
            }
            let _ = number_in(&name, "S", "nm");
        }
    }

    #[test]
    fn every_spelling_of_a_wavelength_is_the_same_wavelength() {
        for name in [
            "S0.550nm",
            "S0.550,0nm",
            "S0.550,000000nm",
            "S0.0,55um",
            "S0.5,5E-7m",
            "S0.55e1nm",
            "S0.,55um",
        ] {
            assert_eq!(meaning(name), Meaning::Radiance(550.0), "{name}");
        }
        for name in ["S0.545,077196THz", "S0.5,45077196E14Hz", "S0.0,545077196PHz"] {
            let Meaning::Radiance(nm) = meaning(name) else { panic!("{name}") };
            assert!((nm - 550.0).abs() < 1e-5, "{name}: {nm}");
        }
    }

    #[test]
    fn a_lone_e_is_the_prefix_exa_and_not_an_exponent() {
        assert_eq!(meaning("S0.1Em"), Meaning::Radiance(1e27));
        assert_eq!(meaning("S0.1E2nm"), Meaning::Radiance(100.0));
    }

    #[test]
    fn names_outside_the_layout_say_nothing() {
        for name in [
            "", "R", "S0", "S0.", "S0.nm", "S0.,nm", "S4.400nm", "S0.400", "S0.400xm", "S0.0nm",
            "S0.4.5nm",
        ] {
            assert_eq!(meaning(name), Meaning::Other, "{name}");
        }
        for name in ["S0.0Hz", "410-400nm", "-400nm", "S0.1E999nm", "S0.400nm ", "é.400nm", "S0.é"]
        {
            assert_eq!(meaning(name), Meaning::Other, "{name}");
        }
    }

    #[test]
    fn stokes_reflectance_and_limits_are_told_apart() {
        assert_eq!(meaning("S2.400nm"), Meaning::Polarisation);
        assert_eq!(meaning("T.400nm"), Meaning::Reflective);
        let band = Band { centre: 405.0, low: 400.0, high: 410.0 };
        assert_eq!(meaning("400.00-410.00nm"), Meaning::Between(band));
    }
}
