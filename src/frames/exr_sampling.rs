//! Subsampled channels: blocks brought to full size, and colour out of luminance and chroma.
//!
//! A picture in channels Y, RY and BY holds Y of every pixel, and RY = (R - Y)/Y and BY = (B - Y)/Y
//! of every second one on either axis (Technical Introduction to OpenEXR, "Luminance/Chroma
//! Images"). Samples stand at the columns and rows that the sampling divides; between them chroma
//! is linear.

use std::ops::Range;

use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds};
use exr::meta::header::Header;

/// Whether any channel of a part has fewer samples than pixels.
pub(super) fn is_subsampled(header: &Header) -> bool {
    header.channels.list.iter().any(|channel| channel.sampling.area() != 1)
}

/// Bytes of a block whose subsampled channels are stored as such. `rows` are those of the file.
pub(super) fn stored_bytes(header: &Header, width: usize, rows: Range<i32>) -> usize {
    let in_row = |channel: &&ChannelDescription, y: i32| has_row(channel, y);
    let bytes = |y: i32| {
        let channels = header.channels.list.iter().filter(|channel| in_row(channel, y));
        channels.map(|channel| row_bytes(channel, width)).sum::<usize>()
    };
    rows.map(bytes).sum()
}

fn has_row(channel: &ChannelDescription, y: i32) -> bool {
    y.rem_euclid(channel.sampling.y() as i32) == 0
}

fn row_bytes(channel: &ChannelDescription, width: usize) -> usize {
    width / channel.sampling.x() * channel.sample_type.bytes_per_sample()
}

/// A decompressed block with a sample of every channel for every pixel: each column without one
/// has that of the column before, rows without any stay zero.
pub(super) fn expanded(header: &Header, stored: &[u8], width: usize, rows: Range<i32>) -> Vec<u8> {
    let mut block = vec![0; width * rows.len() * header.channels.bytes_per_pixel];
    let (mut stored, mut out) = (stored, &mut block[..]);
    for y in rows {
        for channel in &header.channels.list {
            let size = channel.sample_type.bytes_per_sample();
            let (row, rest) = std::mem::take(&mut out).split_at_mut(width * size);
            out = rest;
            if !has_row(channel, y) {
                continue;
            }
            let (samples, rest) = stored.split_at(row_bytes(channel, width));
            stored = rest;
            let each = row.chunks_mut(size * channel.sampling.x()).zip(samples.chunks(size));
            each.for_each(|(columns, sample)| {
                columns.chunks_mut(size).for_each(|column| column.copy_from_slice(sample));
            });
        }
    }
    block
}

/// Makes one plane of a picture linear between the samples that it has.
pub(super) fn interpolate(
    planes: &mut [f32],
    window: IntegerBounds,
    (plane, count): (usize, usize),
    channel: &ChannelDescription,
) {
    let (width, height) = (window.size.width(), window.size.height());
    let (Vec2(step_x, step_y), at) = (channel.sampling, window.position);
    let row = |y: usize| (y * count + plane) * width..(y * count + plane + 1) * width;
    let sampled = |y: usize| (at.y() + y as i32).rem_euclid(step_y as i32) as usize;
    for y in (0..height).filter(|&y| sampled(y) == 0) {
        along(&mut planes[row(y)], at.x(), step_x);
    }
    for y in (0..height).filter(|&y| sampled(y) != 0) {
        let (above, below) = (y.checked_sub(sampled(y)), y + step_y - sampled(y));
        let below = Some(below).filter(|&below| below < height);
        let Some((from, to)) = above.or(below).zip(below.or(above)) else { continue };
        let share = sampled(y) as f32 / step_y as f32;
        for x in 0..width {
            let (a, b) = (planes[row(from).start + x], planes[row(to).start + x]);
            planes[row(y).start + x] = a + (b - a) * share;
        }
    }
}

/// The same along one row, whose columns without a sample have that of the column before.
fn along(row: &mut [f32], first: i32, step: usize) {
    for x in 0..row.len() {
        let beyond = (first + x as i32).rem_euclid(step as i32) as usize;
        let next = x + step - beyond;
        if beyond > 0 && next < row.len() {
            let before = row[x.saturating_sub(beyond)];
            row[x] = before + (row[next] - before) * (beyond as f32 / step as f32);
        }
    }
}

/// Turns Y, RY, BY of one row into red, green and blue. `weights` make Y of these.
pub(super) fn to_rgb(row: &mut [f32], weights: [f64; 3]) {
    let width = row.len() / 3;
    let (y, chroma) = row.split_at_mut(width);
    let (ry, by) = chroma.split_at_mut(width);
    let [of_red, of_green, of_blue] = weights.map(|weight| weight as f32);
    for ((y, ry), by) in y.iter_mut().zip(ry).zip(by) {
        let (red, blue) = ((*ry + 1.0) * *y, (*by + 1.0) * *y);
        let green = (*y - red * of_red - blue * of_blue) / of_green;
        (*y, *ry, *by) = (red, green, blue);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_linear_between_its_samples() {
        let mut row = [4.0, 4.0, 8.0, 8.0, 2.0];
        along(&mut row, 0, 2);
        assert_eq!(row, [4.0, 6.0, 8.0, 5.0, 2.0]);
        let mut odd = [3.0, 4.0, 4.0, 8.0, 8.0];
        along(&mut odd, -1, 2);
        assert_eq!(odd, [3.5, 4.0, 6.0, 8.0, 8.0]);
    }

    #[test]
    fn grey_has_no_chroma() {
        let mut row = [0.5, 2.0, 0.0, 0.0, 0.0, 0.0];
        to_rgb(&mut row, [0.25, 0.5, 0.25]);
        assert_eq!(row, [0.5, 2.0, 0.5, 2.0, 0.5, 2.0]);
    }
}
