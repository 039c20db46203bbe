//! The headers of a plate: those of its source, attribute by attribute, but for what follows from
//! how the picture's part is now stored.

use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{LineOrder, Text};
use exr::meta::header::Header;
use exr_blocks::header::{Attribute, Headers, LONG_NAMES, TILED, attributes};

use crate::frames::Kind;
use crate::frames::exr_picture::ExrPicture;
use crate::frames::plate_channels::Carried;
use crate::frames::written::{About, Compression, tell};

/// Attributes that follow from how the part is stored, and the one that is ours.
const OURS: [&[u8]; 6] =
    [b"channels", b"compression", b"lineOrder", b"type", b"chunkCount", b"sungaze"];
/// Attributes that say what colours mean: ours where the source's colours were no colours.
const OF_COLOURS: [&[u8]; 2] = [PRIMARIES, b"whiteLuminance"];
/// Ours where the source's word on it was not taken.
const PRIMARIES: &[u8] = b"chromaticities";
/// Longest name of a file that does not announce longer ones, bytes.
const SHORT_NAME: usize = 31;

/// The header of the picture's part as it will be stored, in scan lines.
pub(super) fn part_header(
    picture: &ExrPicture,
    channels: &[Carried],
    compression: Compression,
    about: &About,
) -> Header {
    let source = &picture.file.meta.headers[picture.part];
    let list = channels.iter().map(|channel| channel.description.clone()).collect();
    let size = Vec2(source.layer_size.width(), source.layer_size.height());
    let mut header = Header::new(Text::default(), size, list).with_encoding(
        compression.in_file(),
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    header.own_attributes.layer_position = source.own_attributes.layer_position;
    header.shared_attributes.display_window = source.shared_attributes.display_window;
    tell(&mut header, about);
    header
}

/// The headers of all parts.
pub(super) fn headers(picture: &ExrPicture, mut source: Headers, part: &Header) -> Headers {
    let mut bytes = Vec::new();
    let written = part.write(&mut bytes);
    let ours = attributes(&mut &bytes[..]);
    debug_assert!(written.is_ok() && ours.is_ok(), "a header of ours is sound");
    let replaced: &[&[u8]] = match picture.choice.kind {
        Kind::Spectral(_) => &OF_COLOURS,
        Kind::Rgb(_) if picture.primaries_are_given() => &[PRIMARIES],
        Kind::Rgb(_) => &[],
    };
    let attributes = &mut source.parts[picture.part];
    *attributes = merged(std::mem::take(attributes), ours.unwrap_or_default(), replaced);
    source.flags &= !TILED;
    if source.parts.iter().flatten().any(is_long) || channel_is_long(part) {
        source.flags |= LONG_NAMES;
    }
    source
}

/// The attributes of the source in their order, but for [`OURS`] and `more`; then those that it
/// lacks.
fn merged(source: Vec<Attribute>, ours: Vec<Attribute>, more: &[&[u8]]) -> Vec<Attribute> {
    let replaced = |name: &[u8]| OURS.contains(&name) || more.contains(&name);
    let kept = source.into_iter().filter(|attribute| attribute.name != b"tiles");
    let mut merged: Vec<Attribute> = kept
        .map(|attribute| {
            let mine = ours.iter().find(|mine| mine.name == attribute.name);
            mine.filter(|_| replaced(&attribute.name)).cloned().unwrap_or(attribute)
        })
        .collect();
    let new = ours.into_iter().filter(|mine| !merged.iter().any(|old| old.name == mine.name));
    let new: Vec<Attribute> = new.collect();
    merged.extend(new);
    merged
}

fn is_long(attribute: &Attribute) -> bool {
    attribute.name.len().max(attribute.kind.len()) > SHORT_NAME
}

fn channel_is_long(part: &Header) -> bool {
    part.channels.list.iter().any(|channel| channel.name.as_slice().len() > SHORT_NAME)
}
