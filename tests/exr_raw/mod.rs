//! OpenEXR files put together byte by byte, to hold what no library writes.

// Each test takes what it needs.
#![allow(dead_code)]

use exr_blocks::header::{Attribute, Headers, MULTIPART};

/// A channel: name, 1 for half or 2 for float, sampling.
pub(crate) type Channel<'a> = (&'a str, i32, [i32; 2]);

pub(crate) fn ints(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The attributes that every part has. `window` is left, top, right, bottom.
pub(crate) fn part(channels: &[Channel], compression: u8, window: [i32; 4]) -> Vec<Attribute> {
    let mut sorted = channels.to_vec();
    sorted.sort();
    let channel = |(name, kind, sampling): &Channel| {
        [name.as_bytes(), b"\0", &ints(&[*kind, 0]), &ints(sampling)].concat()
    };
    let list = [sorted.iter().flat_map(channel).collect(), vec![0]].concat();
    vec![
        Attribute::new("channels", "chlist", list),
        Attribute::new("compression", "compression", [compression]),
        Attribute::new("dataWindow", "box2i", ints(&window)),
        Attribute::new("displayWindow", "box2i", ints(&window)),
        Attribute::new("lineOrder", "lineOrder", [0]),
        Attribute::new("pixelAspectRatio", "float", floats(&[1.0])),
        Attribute::new("screenWindowCenter", "v2f", floats(&[0.0, 0.0])),
        Attribute::new("screenWindowWidth", "float", floats(&[1.0])),
    ]
}

/// A chunk of scan lines from row `y` on.
pub(crate) fn chunk(y: i32, bytes: &[u8]) -> Vec<u8> {
    [ints(&[y, bytes.len() as i32]), bytes.to_vec()].concat()
}

/// A file of parts with their chunks; in a file of several, each gets its part's number.
pub(crate) fn file(flags: u32, parts: Vec<(Vec<Attribute>, Vec<Vec<u8>>)>) -> Vec<u8> {
    let flags = if parts.len() > 1 { flags | MULTIPART } else { flags };
    let (parts, chunks): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    let mut bytes = Vec::new();
    Headers { flags, parts }.write(&mut bytes).unwrap();
    let mut at = bytes.len() + 8 * chunks.iter().map(Vec::len).sum::<usize>();
    let (mut table, mut body) = (Vec::new(), Vec::new());
    for (number, chunks) in (0i32..).zip(&chunks) {
        for chunk in chunks {
            let number = if flags & MULTIPART == 0 { vec![] } else { ints(&[number]) };
            table.extend((at as u64).to_le_bytes());
            at += number.len() + chunk.len();
            body.extend([number, chunk.clone()].concat());
        }
    }
    [bytes, table, body].concat()
}

/// An uncompressed file of float channels, each of one value, 4 x 3 pixels, with more attributes.
pub(crate) fn constant(channels: &[(&str, f32)], more: Vec<Attribute>) -> Vec<u8> {
    let mut sorted = channels.to_vec();
    sorted.sort_by_key(|channel| channel.0);
    let list: Vec<Channel> = sorted.iter().map(|(name, _)| (*name, 2, [1, 1])).collect();
    let row: Vec<f32> = sorted.iter().flat_map(|(_, value)| [*value; 4]).collect();
    let chunks = (0..3).map(|y| chunk(y, &floats(&row))).collect();
    file(0, vec![([part(&list, 0, [0, 0, 3, 2]), more].concat(), chunks)])
}

/// A picture of one colour with luminance from 1 to 2 in Y, and RY and BY of every second pixel.
pub(crate) fn luminance_and_chroma(compression: u8, lines: i32, window: [i32; 4]) -> Vec<u8> {
    let [left, top, right, bottom] = window;
    let channels = [("BY", 2, [2, 2]), ("RY", 2, [2, 2]), ("Y", 2, [1, 1])];
    let width = (right - left + 1) as usize;
    let row = |y: i32| {
        let chroma = |value: f32| if y % 2 == 0 { vec![value; width / 2] } else { vec![] };
        let y: Vec<f32> = (0..width).map(|x| 1.0 + (x as f32 + y as f32) / 64.0).collect();
        floats(&[chroma(-0.5), chroma(0.25), y].concat())
    };
    let block = |first: i32| {
        let rows = first..(first + lines).min(bottom + 1);
        let bytes: Vec<u8> = rows.flat_map(row).collect();
        chunk(first, &if compression == 0 { bytes } else { exr_blocks::zip::compressed(bytes) })
    };
    let blocks = (top..=bottom).step_by(lines as usize).map(block).collect();
    file(0, vec![(part(&channels, compression, window), blocks)])
}
