//! PIZ: a table of the values that occur, a Haar wavelet over their numbers, Huffman codes over the
//! result.
//!
//! Technical Introduction to OpenEXR, "Data Compression"; `ImfPizCompressor.cpp`, `ImfWav.cpp` and
//! `ImfHuf.cpp` of OpenEXR, whose wire format this is.

mod bits;
mod code;
mod lookup;
mod wavelet;
mod words;

use std::ops::Range;

use crate::Damaged;
use lookup::Lookup;
use words::Words;

/// A channel of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Whether samples are 32 bits (float, uint) and not 16 (half).
    pub wide: bool,
    /// Columns and rows of the picture per column and row of the channel, at least 1.
    pub sampling: (usize, usize),
}

impl Channel {
    /// 16-bit words of one sample.
    fn words(&self) -> usize {
        1 + usize::from(self.wide)
    }

    /// Samples in one row of the channel.
    fn columns(&self, width: usize) -> usize {
        width / self.sampling.0
    }

    fn has_row(&self, y: i32) -> bool {
        y.rem_euclid(self.sampling.1 as i32) == 0
    }
}

/// Decodes a block of `width` columns and of the rows `rows`, counted as the file counts them
/// (subsampled channels have the rows that their sampling divides).
///
/// # Errors
/// [`Damaged`] where the bytes are no PIZ block of exactly these samples.
pub fn decoded(
    bytes: &[u8],
    channels: &[Channel],
    width: usize,
    rows: Range<i32>,
) -> Result<Vec<u8>, Damaged> {
    let (lookup, bytes) = Lookup::read(bytes)?;
    let mut words = Words::open(bytes)?;
    let mut cursors = row_starts(channels, width, rows.clone());
    let mut block = vec![0; cursors[rows.len()]];
    let mut plane = Vec::new();
    for channel in channels {
        let row_words = channel.columns(width) * channel.words();
        let seen = rows.clone().filter(|&y| channel.has_row(y)).count();
        plane.resize(row_words * seen, 0);
        words.fill(&mut plane)?;
        wavelet::undo(&mut plane, (channel.columns(width), seen), channel.wide, lookup.largest);
        let mut lines = plane.chunks_exact(row_words.max(1));
        for (_, cursor) in rows.clone().zip(&mut cursors).filter(|(y, _)| channel.has_row(*y)) {
            let out = &mut block[*cursor..][..2 * row_words];
            lines.next().into_iter().for_each(|line| lookup.values(line, out));
            *cursor += 2 * row_words;
        }
    }
    words.end()?;
    Ok(block)
}

/// Where each row begins in a decoded block, bytes, and where the last one ends.
fn row_starts(channels: &[Channel], width: usize, rows: Range<i32>) -> Vec<usize> {
    let mut starts = vec![0];
    for y in rows {
        let present = channels.iter().filter(|channel| channel.has_row(y));
        let bytes: usize =
            present.map(|channel| 2 * channel.words() * channel.columns(width)).sum();
        starts.push(starts[starts.len() - 1] + bytes);
    }
    starts
}
