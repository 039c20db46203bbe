//! What an OpenEXR header says that is worth telling a reader.

use std::collections::BTreeMap;

use exr::meta::attribute::{AttributeValue, IntegerBounds, SampleType, Text};
use exr::meta::header::Header;
use serde::Serialize;

use crate::text::shown;

/// Longer attribute texts are cut, characters.
const LONGEST_TEXT: usize = 200;

/// A name or text of a file: UTF-8 where it is that, else Latin-1.
pub(super) fn text(text: &Text) -> String {
    let bytes = text.as_slice();
    let latin = || bytes.iter().map(|&byte| char::from(byte)).collect();
    std::str::from_utf8(bytes).map_or_else(|_| latin(), str::to_owned)
}

/// Windows are left, top, right, bottom, the last two included.
#[derive(Clone, Debug, Serialize)]
pub struct ExrDescription {
    pub(crate) data_window: [i64; 4],
    pub(crate) display_window: [i64; 4],
    pub(crate) compression: String,
    pub channels: Vec<Channel>,
    /// Attributes beyond those that every file has.
    pub attributes: BTreeMap<String, String>,
}

#[derive(Clone, Debug, Serialize)]
pub struct Channel {
    pub name: String,
    /// `half`, `float` or `uint`.
    pub(crate) stored: &'static str,
}

/// Describes one part.
pub(super) fn described(header: &Header) -> ExrDescription {
    let channel = |channel: &exr::meta::attribute::ChannelDescription| Channel {
        name: shown(&text(&channel.name)),
        stored: match channel.sample_type {
            SampleType::F16 => "half",
            SampleType::F32 => "float",
            SampleType::U32 => "uint",
        },
    };
    let attributes = header.all_named_attributes().filter_map(|(name, value)| {
        let name = shown(&String::from_utf8_lossy(name));
        Some((name, shown(&value_text(&value)?)))
            .filter(|(name, _)| !MANDATORY.contains(&name.as_str()))
    });
    ExrDescription {
        data_window: window(header.data_window()),
        display_window: window(header.shared_attributes.display_window),
        compression: header.compression.to_string().replace(" compression", ""),
        channels: header.channels.list.iter().map(channel).collect(),
        attributes: attributes.collect(),
    }
}

/// Numbers and texts that every file has.
const MANDATORY: [&str; 5] = [
    "chunkCount",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "maxSamplesPerPixel",
];

fn window(bounds: IntegerBounds) -> [i64; 4] {
    let (x, y) = (i64::from(bounds.position.0), i64::from(bounds.position.1));
    [x, y, x + bounds.size.0 as i64 - 1, y + bounds.size.1 as i64 - 1]
}

/// Texts and numbers as text; nothing for structures.
fn value_text(value: &AttributeValue) -> Option<String> {
    Some(match value {
        AttributeValue::Text(words) => text(words).chars().take(LONGEST_TEXT).collect(),
        AttributeValue::F32(number) => number.to_string(),
        AttributeValue::F64(number) => number.to_string(),
        AttributeValue::I32(number) => number.to_string(),
        AttributeValue::Rational((over, under)) => format!("{over}/{under}"),
        AttributeValue::FloatVec2(pair) => format!("{} {}", pair.0, pair.1),
        AttributeValue::Chromaticities(c) => [c.red, c.green, c.blue, c.white]
            .map(|point| format!("{} {}", point.0, point.1))
            .join(", "),
        _ => return None,
    })
}
