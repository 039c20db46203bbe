//! Words of 16 bits in a canonical Huffman code with words of up to 58 bits, and runs of the last
//! one.
//!
//! Only the lengths of the code words are sent. Longer ones are numerically lower (zeros behind
//! them), those of one length rise with their symbols. The largest symbol stands for "the last
//! word, so many times more", and 8 bits that tell how many.

use crate::Damaged;

/// Symbols: 16-bit words, and the one for runs.
const SYMBOLS: usize = (1 << 16) + 1;
/// Lengths from here on stand for runs of symbols without a code word: 59 to 62 for 2 to 5 of them,
/// 63 for 6 and as many more as the next 8 bits tell.
const SHORT_RUN: usize = 59;
const LONG_RUN: usize = 63;
/// Longest code word, bits.
const LONGEST: usize = SHORT_RUN - 1;
/// Code words of up to so many bits are looked up at once. Sixteen kilobytes of table stay in the
/// nearest cache.
const LOOKED_UP: usize = 12;
/// In the table: what the first bits do not tell the symbol of.
const UNTOLD: u32 = u32::MAX << 8;

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
    pub fn open(bytes: &'a [u8]) -> Result<Words<'a>, Damaged> {
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
    pub fn fill(&mut self, out: &mut [u16]) -> Result<(), Damaged> {
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
    pub fn end(self) -> Result<(), Damaged> {
        if self.bits.at == self.end && self.due == 0 {
            Ok(())
        } else {
            Err(Damaged("more words than samples"))
        }
    }
}

/// Bytes read bit by bit, the highest first. Behind the last one there are zeros.
#[derive(Clone, Copy)]
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    /// The next 57 bits or more, from the top.
    #[inline(always)]
    fn ahead(&self) -> u64 {
        let bytes = self.bytes.get(self.at >> 3..).unwrap_or(&[]);
        let eight = bytes
            .first_chunk()
            .map_or_else(|| last_bytes(bytes), |eight| u64::from_be_bytes(*eight));
        eight << (self.at & 7)
    }

    /// The next 64 bits.
    #[inline(always)]
    fn all_ahead(&self) -> u64 {
        let ninth = self.bytes.get((self.at >> 3) + 8).copied().unwrap_or(0);
        self.ahead() | u64::from(ninth) >> (8 - (self.at & 7))
    }

    fn take(&mut self, count: usize) -> u64 {
        let bits = self.ahead() >> (64 - count);
        self.at += count;
        bits
    }
}

#[cold]
fn last_bytes(bytes: &[u8]) -> u64 {
    let mut eight = [0; 8];
    eight[..bytes.len()].copy_from_slice(bytes);
    u64::from_be_bytes(eight)
}

/// The lengths of so many symbols' code words, 0 for none, and how many bytes they took.
fn lengths(bytes: &[u8], count: usize) -> Result<(Vec<u8>, usize), Damaged> {
    let mut bits = Bits { bytes, at: 0 };
    let mut lengths = Vec::with_capacity(count);
    while lengths.len() < count && bits.at <= 8 * bytes.len() {
        match bits.take(6) as usize {
            length @ ..SHORT_RUN => lengths.push(length as u8),
            LONG_RUN => {
                let more = bits.take(8) as usize;
                lengths.resize(lengths.len() + LONG_RUN - SHORT_RUN + 2 + more, 0);
            }
            run => lengths.resize(lengths.len() + run - SHORT_RUN + 2, 0),
        }
    }
    let taken = bits.at.div_ceil(8);
    if taken > bytes.len() || lengths.len() != count {
        return Err(Damaged("a code that is cut short or too long"));
    }
    Ok((lengths, taken))
}

/// A canonical code.
struct Code {
    /// By the next [`LOOKED_UP`] bits: the symbol and the length of its code word, in the low byte;
    /// or [`UNTOLD`] and the least length that begins so.
    table: Box<[u32; 1 << LOOKED_UP]>,
    /// The lowest code word of each length, from the top of 64 bits.
    lowest: [u64; LONGEST + 1],
    /// Where the symbols of each length begin.
    first: [usize; LONGEST + 1],
    /// Symbols by length, rising.
    symbols: Vec<u32>,
    run: u32,
}

impl Code {
    /// The code of the symbols from `first` on with code words of these lengths. They must fill all
    /// bits, as Huffman's do.
    fn new(first: usize, lengths: &[u8]) -> Result<Code, Damaged> {
        let mut counts = [0usize; LONGEST + 1];
        lengths.iter().for_each(|&length| counts[usize::from(length)] += 1);
        counts[0] = 0;
        let mut code = Code {
            table: vec![0; 1 << LOOKED_UP].try_into().unwrap_or_else(|_| unreachable!()),
            lowest: [u64::MAX; LONGEST + 1],
            first: [0; LONGEST + 1],
            symbols: vec![0; counts.iter().sum()],
            run: (first + lengths.len() - 1) as u32,
        };
        let mut filled = 0u128;
        for length in (1..=LONGEST).rev() {
            code.lowest[length] = u64::try_from(filled).unwrap_or(u64::MAX);
            filled += (counts[length] as u128) << (64 - length);
            code.first[length] = counts[..length].iter().sum();
        }
        if filled != 1 << 64 {
            return Err(Damaged("a code that no Huffman tree has"));
        }
        code.sort(first, lengths);
        code.look_up(&counts);
        Ok(code)
    }

    fn sort(&mut self, first: usize, lengths: &[u8]) {
        let mut next = self.first;
        for (symbol, &length) in (first as u32..).zip(lengths).filter(|(_, length)| **length > 0) {
            let place = &mut next[usize::from(length)];
            self.symbols[*place] = symbol;
            *place += 1;
        }
    }

    fn look_up(&mut self, counts: &[usize; LONGEST + 1]) {
        let long = self.lowest[LOOKED_UP] >> (64 - LOOKED_UP);
        for (i, entry) in self.table[..long as usize].iter_mut().enumerate() {
            let highest = (i as u64 + 1) << (64 - LOOKED_UP);
            let least = (LOOKED_UP + 1..=LONGEST).find(|&length| highest > self.lowest[length]);
            *entry = UNTOLD | least.unwrap_or(LONGEST) as u32;
        }
        let mut at = long as usize;
        for length in (1..=LOOKED_UP).rev() {
            for &symbol in &self.symbols[self.first[length]..][..counts[length]] {
                let symbol = if symbol == self.run { UNTOLD } else { symbol << 8 };
                self.table[at..][..1 << (LOOKED_UP - length)].fill(symbol | length as u32);
                at += 1 << (LOOKED_UP - length);
            }
        }
    }

    /// The symbol whose code word stands at the top of `ahead`; `at` moves behind it.
    #[inline(always)]
    fn symbol(&self, ahead: u64, at: &mut usize) -> u32 {
        let entry = self.table[(ahead >> (64 - LOOKED_UP)) as usize];
        let mut length = (entry & 63) as usize;
        while length < LONGEST && ahead < self.lowest[length] {
            length += 1;
        }
        *at += length;
        let place = self.first[length] + ((ahead - self.lowest[length]) >> (64 - length)) as usize;
        self.symbols[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_words_are_numbered_from_the_longest() {
        // Lengths 2, 1, 3, 3 of 5 to 8: 01, 1, 000, 001; 8 is the run.
        let code = Code::new(5, &[2, 1, 3, 3]).unwrap();
        let symbol = |bits: u64, length: usize| {
            let mut at = 0;
            let symbol = code.symbol(bits << (64 - length), &mut at);
            assert_eq!(at, length);
            symbol
        };
        assert_eq!([symbol(1, 2), symbol(1, 1), symbol(0, 3), symbol(1, 3)], [5, 6, 7, 8]);
    }

    #[test]
    fn long_code_words_are_found_by_their_length() {
        // One word of each length up to 57, two of 58: a comb.
        let mut lengths: Vec<u8> = (1..=58).collect();
        lengths.push(58);
        let code = Code::new(0, &lengths).unwrap();
        for length in 1..58u32 {
            let (mut at, below) = (0, u64::MAX >> 1 >> length);
            assert_eq!(code.symbol(1 << (64 - length) | below, &mut at), length - 1);
            assert_eq!(at, length as usize);
        }
        assert_eq!(code.symbol(0, &mut 0), 57);
        assert_eq!(code.symbol(1 << 6, &mut 0), 58);
    }

    #[test]
    fn codes_that_leave_bits_over_or_take_too_many_are_damaged() {
        for lengths in [&[1][..], &[1, 2], &[1, 1, 1], &[0, 0], &[58; 4]] {
            assert!(Code::new(0, lengths).is_err(), "{lengths:?}");
        }
    }

    #[test]
    fn lengths_come_in_runs_of_zeros_too() {
        // 6 bits each: 5, 61 (4 zeros), 63 and 8 bits (6 + 2 zeros), 1.
        let bits = "000101 111101 111111 00000010 000001".replace(' ', "");
        let bytes: Vec<u8> =
            (0..4).map(|i| u8::from_str_radix(&bits[8 * i..8 * i + 8], 2).unwrap()).collect();
        let mut expected = vec![5];
        expected.extend([0; 12]);
        expected.push(1);
        assert_eq!(lengths(&bytes, 14), Ok((expected, 4)));
        assert!(lengths(&bytes, 13).is_ok_and(|(_, taken)| taken == 4));
        assert!(lengths(&bytes, 10).is_err() && lengths(&bytes, 16).is_err());
    }
}
