//! A canonical Huffman code with words of up to 58 bits.
//!
//! Only the lengths of the code words are sent. Longer ones are numerically lower (zeros behind
//! them), those of one length rise with their symbols.

use super::bits::Bits;
use crate::Damaged;

/// Lengths from here on stand for runs of symbols without a code word: 59 to 62 for 2 to 5 of them,
/// 63 for 6 and as many more as the next 8 bits tell.
const SHORT_RUN: usize = 59;
const LONG_RUN: usize = 63;
/// Longest code word, bits.
const LONGEST: usize = SHORT_RUN - 1;
/// Code words of up to so many bits are looked up at once. Sixteen kilobytes of table stay in the
/// nearest cache.
pub(super) const LOOKED_UP: usize = 12;
/// In the table: what the first bits do not tell the symbol of.
pub(super) const UNTOLD: u32 = u32::MAX << 8;

/// The lengths of so many symbols' code words, 0 for none, and how many bytes they took.
pub(super) fn lengths(bytes: &[u8], count: usize) -> Result<(Vec<u8>, usize), Damaged> {
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
pub(super) struct Code {
    /// By the next [`LOOKED_UP`] bits: the symbol and the length of its code word, in the low byte;
    /// or [`UNTOLD`] and the least length that begins so.
    pub table: Box<[u32; 1 << LOOKED_UP]>,
    /// The lowest code word of each length, from the top of 64 bits.
    lowest: [u64; LONGEST + 1],
    /// Where the symbols of each length begin.
    first: [usize; LONGEST + 1],
    /// Symbols by length, rising.
    symbols: Vec<u32>,
    /// The symbol for runs.
    pub run: u32,
}

impl Code {
    /// The code of the symbols from `first` on with code words of these lengths. They must fill all
    /// bits, as Huffman's do.
    pub(crate) fn new(first: usize, lengths: &[u8]) -> Result<Code, Damaged> {
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
    pub(crate) fn symbol(&self, ahead: u64, at: &mut usize) -> u32 {
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
