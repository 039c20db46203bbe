//! Words of 16 bits in a Huffman code, and runs of the last one. The largest symbol stands for "the
//! last word, so many times more", and 8 bits that tell how many.

use super::bits::Bits;
use super::code::{Code, LOOKED_UP, UNTOLD, lengths};
use crate::Damaged;

/// Symbols: 16-bit words, and the one for runs.
const SYMBOLS: usize = (1 << 16) + 1;
/// Decodes words in order.
pub(super) struct Words<'a> {
    bits: Bits<'a>,
    /// How many bits belong to the words.
    end: usize,
    code: Code,
    last: Option<u16>,
    /// How many more of the last word are due.
    due: usize,
}

impl<'a> Words<'a> {
    /// Reads the code: sizes, the lengths of code words, then the words.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Words<'a>, Damaged> {
        let head = bytes.as_chunks().0.first_chunk().ok_or(Damaged("a block without words"))?;
        let [length, first, last, _, end, _] = head.map(|bytes| u32::from_le_bytes(bytes) as usize);
        let body = bytes[4..]
            .get(..length)
            .and_then(|bytes| bytes.get(20..))
            .ok_or(Damaged("words cut short"))?;
        if first > last || last >= SYMBOLS {
            return Err(Damaged("a code for symbols beyond 16 bits"));
        }
        let (lengths, table) = lengths(body, last - first + 1)?;
        let body = &body[table..];
        if end > 8 * body.len() {
            return Err(Damaged("words cut short"));
        }
        Ok(Words {
            bits: Bits { bytes: body, at: 0 },
            end,
            code: Code::new(first, &lengths)?,
            last: None,
            due: 0,
        })
    }

    /// Decodes as many words as `out` holds.
    pub(crate) fn fill(&mut self, out: &mut [u16]) -> Result<(), Damaged> {
        let mut filled = self.repeat(out);
        while filled < out.len() {
            filled += self.short_ones(&mut out[filled..]);
            if filled < out.len() {
                filled += self.any_one(&mut out[filled..])?;
            }
        }
        self.last = out.last().copied().or(self.last);
        if self.bits.at > self.end { Err(Damaged("words cut short")) } else { Ok(()) }
    }

    /// Decodes while code words are short. Four of them fit the bits that are at hand.
    #[inline(always)]
    fn short_ones(&mut self, out: &mut [u16]) -> usize {
        let (table, mut bits) = (&self.code.table, self.bits);
        let mut filled = 0;
        'all: for four in out.as_chunks_mut::<4>().0 {
            let mut ahead = bits.ahead();
            for (i, word) in four.iter_mut().enumerate() {
                let entry = table[(ahead >> (64 - LOOKED_UP)) as usize];
                if entry >= UNTOLD {
                    filled += i;
                    break 'all;
                }
                *word = (entry >> 8) as u16;
                ahead <<= entry & 63;
                bits.at += (entry & 63) as usize;
            }
            filled += 4;
        }
        self.bits = bits;
        if filled > 0 {
            self.last = Some(out[filled - 1]);
        }
        filled
    }

    /// Decodes one code word of any length, or a run.
    #[inline(always)]
    fn any_one(&mut self, out: &mut [u16]) -> Result<usize, Damaged> {
        let symbol = self.code.symbol(self.bits.all_ahead(), &mut self.bits.at);
        if symbol != self.code.run {
            out[0] = symbol as u16;
            self.last = Some(out[0]);
            return Ok(1);
        }
        self.due = self.bits.take(8) as usize;
        if self.last.is_none() {
            return Err(Damaged("a run of no word"));
        }
        if self.bits.at > self.end {
            return Err(Damaged("words cut short"));
        }
        Ok(self.repeat(out))
    }

    /// Writes what is due of a run.
    fn repeat(&mut self, out: &mut [u16]) -> usize {
        let now = self.due.min(out.len());
        out[..now].fill(self.last.unwrap_or(0));
        self.due -= now;
        now
    }

    /// Checks that nothing is left.
    pub(crate) fn end(self) -> Result<(), Damaged> {
        if self.bits.at == self.end && self.due == 0 {
            Ok(())
        } else {
            Err(Damaged("more words than samples"))
        }
    }
}
