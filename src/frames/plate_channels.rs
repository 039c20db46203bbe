//! The channels of a plate's picture part: those that are carried, and the colours that are new.

use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType, Text};
use half::f16;

use crate::frames::Kind;
use crate::frames::exr_description::text;
use crate::frames::exr_picture::ExrPicture;
use crate::frames::exr_rows::{Place, Rows};
use crate::light::Planes;

/// A channel as it is written.
pub(super) struct Carried {
    pub(crate) description: ChannelDescription,
    /// Where the source has its samples.
    source: Option<Place>,
    /// The plane that replaces them.
    plane: Option<usize>,
}

/// The channels of the part, in the order of their names. Where the picture is not made of red,
/// green and blue (bands, luminance and chroma, one grey channel), these take the place of what it
/// is made of. Other channels that are subsampled are left out.
pub(super) fn channels(picture: &ExrPicture) -> Vec<Carried> {
    let header = &picture.file.meta.headers[picture.part];
    let choice = &picture.choice;
    let of_three = matches!(choice.kind, Kind::Rgb(_)) && !choice.chroma;
    let in_place = of_three && choice.channels[0] != choice.channels[1];
    let new: Vec<String> = ["R", "G", "B"].map(|name| format!("{}{name}", picture.prefix)).into();
    let all_half =
        choice.channels.iter().all(|&i| header.channels.list[i].sample_type == SampleType::F16);
    let kind = if of_three && all_half { SampleType::F16 } else { SampleType::F32 };
    let mut carried = Vec::new();
    for (index, channel) in header.channels.list.iter().enumerate() {
        let plane = choice.channels.iter().position(|&chosen| chosen == index);
        let place = Place::of(&header.channels, index);
        let replaced = !in_place && (plane.is_some() || new.contains(&text(&channel.name)));
        if replaced || channel.sampling != Vec2(1, 1) {
            continue;
        }
        let mut description = channel.clone();
        if plane.is_some() {
            description.sample_type = kind;
        }
        carried.push(Carried { description, source: Some(place), plane });
    }
    if !in_place {
        let grey = of_three.then(|| Place::of(&header.channels, choice.channels[0]));
        carried.extend(new.iter().enumerate().map(|(plane, name)| {
            let name = Text::from_slice_unchecked(name.as_bytes());
            let description = ChannelDescription::named(name, kind);
            Carried { description, source: grey, plane: Some(plane) }
        }));
    }
    carried.sort_by(|a, b| a.description.name.cmp(&b.description.name));
    carried
}

impl Carried {
    /// Cuts this channel's samples off the front of a row.
    pub(super) fn take<'a>(&self, row: &mut &'a mut [u8], width: usize) -> &'a mut [u8] {
        let bytes = width * self.description.sample_type.bytes_per_sample();
        let (mine, rest) = std::mem::take(row).split_at_mut(bytes);
        *row = rest;
        mine
    }

    /// Copies the samples of the source.
    pub(super) fn carry(&self, rows: &Rows, i: usize, out: &mut [u8], room: &mut Vec<f32>) {
        let Some(place) = self.source else { return };
        let kind = self.description.sample_type;
        if kind == place.kind {
            return rows.copy(i, place, out);
        }
        room.resize(out.len() / kind.bytes_per_sample(), 0.0);
        rows.fetch(i, place, room);
        store(room, kind, out);
    }
}

/// The new colours of a plate.
pub(super) struct Colours<'a> {
    pub(crate) planes: &'a Planes,
    /// The pixels of the file that they are of.
    pub(crate) window: IntegerBounds,
    /// The factor from the plate's numbers to theirs.
    pub(crate) gain: f32,
}

impl Colours<'_> {
    /// Whether nothing else is wanted for the pixels of `data`.
    pub(super) fn are_all_of(&self, channels: &[Carried], data: IntegerBounds) -> bool {
        channels.iter().all(|channel| channel.plane.is_some()) && self.window.contains(data)
    }

    /// Puts the colours over a row of a channel that begins at the pixel `corner` of the file.
    pub(super) fn fill(
        &self,
        channel: &Carried,
        corner: (i32, i32),
        out: &mut [u8],
        room: &mut Vec<f32>,
    ) {
        let Some(plane) = channel.plane else { return };
        let apart = |a: i32, b: i32| i64::from(a) - i64::from(b);
        let y = apart(corner.1, self.window.position.y());
        let size = channel.description.sample_type.bytes_per_sample();
        let (shift, width) = (apart(corner.0, self.window.position.x()), (out.len() / size) as i64);
        let columns = shift.max(0)..(shift + width).min(self.planes.width as i64);
        if columns.is_empty() || !(0..self.planes.height as i64).contains(&y) {
            return;
        }
        let out = &mut out[(columns.start - shift) as usize * size..];
        let columns = columns.start as usize..columns.end as usize;
        let mut light = vec![0.0; columns.len()];
        room.resize(columns.len(), 0.0);
        light.copy_from_slice(self.planes.run(plane, y as usize, columns, room));
        if self.gain != 1.0 {
            light.iter_mut().for_each(|value| *value /= self.gain);
        }
        store(&light, channel.description.sample_type, out);
    }
}

/// Writes floats as samples of a kind, little-endian; halves no larger than the largest finite one.
fn store(values: &[f32], kind: SampleType, out: &mut [u8]) {
    let largest = f16::MAX.to_f32();
    match kind {
        SampleType::F16 => {
            for (value, out) in values.iter().zip(out.as_chunks_mut().0) {
                *out = f16::from_f32(value.clamp(-largest, largest)).to_le_bytes();
            }
        }
        SampleType::F32 | SampleType::U32 => {
            for (value, out) in values.iter().zip(out.as_chunks_mut().0) {
                *out = value.to_le_bytes();
            }
        }
    }
}
