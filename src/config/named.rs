//! Words that keys accept for values of other rooms: `#[serde(with = "named")]`.
//!
//! Where a value holds numbers that other keys give, its word stands for it without them.

use serde::{Deserialize, Deserializer, Serializer, de::Error};

use crate::colour::Primaries;
use crate::display::{Ceiling, Tone};
use crate::frames::{Matrix, Overscan, Transfer};
use crate::kinetics::Law;
use crate::observer::lens::TABULATED_AGE;
use crate::observer::{Reading, Rule};
use crate::units::Millimetres;

/// A closed set of values with a word for each; the first is the default.
pub(super) trait Named: Copy + PartialEq + 'static {
    const NAMES: &[(&str, Self)];
}

/// The default of a key.
pub(super) fn first<T: Named>() -> T {
    T::NAMES[0].1
}

pub(super) fn deserialize<'de, T: Named, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    let refused = |found: String| {
        let accepted: Vec<_> = T::NAMES.iter().map(|(name, _)| *name).collect();
        D::Error::custom(format!("{found}accepted: {}", accepted.join(", ")))
    };
    let word = String::deserialize(from).map_err(|_| refused(String::new()))?;
    let found = T::NAMES.iter().find(|(name, _)| *name == word);
    found.map(|(_, value)| *value).ok_or_else(|| refused(format!("found {word:?}; ")))
}

pub(super) fn serialize<T: Named, S: Serializer>(value: &T, out: S) -> Result<S::Ok, S::Error> {
    let named = T::NAMES.iter().find(|(_, other)| value == other);
    out.serialize_str(named.map_or("", |(name, _)| name))
}

/// `input.primaries`: of RGB whose file does not say them, or says others.
impl Named for Option<Primaries> {
    const NAMES: &[(&str, Self)] = &[
        ("auto", None),
        ("bt709", Some(Primaries::REC709)),
        ("bt601-525", Some(Primaries::BT601_525)),
        ("bt601-625", Some(Primaries::BT601_625)),
        ("bt2020", Some(Primaries::BT2020)),
        ("p3-d65", Some(Primaries::P3_D65)),
        ("p3-dci", Some(Primaries::P3_DCI)),
        ("acescg", Some(Primaries::ACESCG)),
        ("aces2065-1", Some(Primaries::ACES)),
    ];
}

/// `input.transfer`: the curve to decode by, whatever the file says.
impl Named for Option<Transfer> {
    const NAMES: &[(&str, Self)] = &[
        ("auto", None),
        ("pq", Some(Transfer::Pq)),
        ("hlg", Some(Transfer::Hlg(None))),
        ("bt1886", Some(Transfer::BT1886)),
        ("srgb", Some(Transfer::Srgb)),
        ("linear", Some(Transfer::Linear)),
    ];
}

/// `input.matrix`: of a film's YUV.
impl Named for Option<Matrix> {
    const NAMES: &[(&str, Self)] = &[
        ("auto", None),
        ("bt601", Some(Matrix::BT601)),
        ("bt709", Some(Matrix::BT709)),
        ("bt2020-ncl", Some(Matrix::BT2020)),
    ];
}

/// `input.code_range`: whether a film's codes have full range.
impl Named for Option<bool> {
    const NAMES: &[(&str, Self)] =
        &[("auto", None), ("limited", Some(false)), ("full", Some(true))];
}

/// `observer.pupil`.
impl Named for Rule {
    const NAMES: &[(&str, Self)] = &[
        ("watson-yellott", Rule::WatsonYellott { age: TABULATED_AGE, eyes: 2 }),
        ("moon-spencer", Rule::MoonSpencer),
        ("moon-spencer-as-printed", Rule::MoonSpencerAsPrinted),
        ("de-groot-gebhard", Rule::DeGrootGebhard),
        ("de-groot-gebhard-as-printed", Rule::DeGrootGebhardAsPrinted),
        ("fixed", Rule::Fixed(Millimetres(0.0))),
    ];
}

/// `observer.stiles_crawford`.
impl Named for Reading {
    const NAMES: &[(&str, Self)] = &[
        ("pupil", Reading::Pupil),
        ("paper", Reading::Paper { mm_per_degree: 0.0 }),
        ("off", Reading::Off),
    ];
}

/// `observer.kinetics`.
impl Named for Law {
    const NAMES: &[(&str, Self)] = &Law::NAMES;
}

/// `display.tone`.
impl Named for Tone {
    const NAMES: &[(&str, Self)] =
        &[("ward", Tone::Ward(Ceiling::Human)), ("exposure", Tone::Exposure { ev: 0.0 })];
}

/// `output.keep`: what of a file is kept beside its picture.
impl Named for Overscan {
    const NAMES: &[(&str, Self)] = &[("all", Overscan::OfFirst), ("none", Overscan::None)];
}
