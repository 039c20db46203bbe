//! A deflate stream for pixels: single bytes in Huffman codes of their own for each segment, and
//! long runs of one byte.
//!
//! RFC 1950 (zlib), RFC 1951 (deflate). Other matches are not looked for: differences of neighbours
//! hold few, and looking for them takes most of a compressor's time. A segment that its code does
//! not shorten is stored.

use crate::huffman::{Word, code};

/// The longest segment that can be stored, bytes.
pub(crate) const LONGEST_SEGMENT: usize = 0xffff;
/// Bits of the longest word. Deflate allows 15; four of 14 fit 64 bits beside a begun byte.
const LONGEST_WORD: usize = 14;
/// A run goes on by so many bytes at a time, up to 256.
const STEP: usize = 16;
/// The symbol behind the 256 bytes: the end of a segment.
const END: usize = 256;
/// Symbols up to that of the longest run.
const SYMBOLS: usize = 285;
/// The order in which the lengths of the words for lengths are sent.
const ORDER: [usize; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

/// Compresses bytes, in segments of so many.
pub(crate) fn deflated(bytes: &[u8], segment: usize) -> Vec<u8> {
    let segment = segment.clamp(1, LONGEST_SEGMENT);
    let mut stream = Stream::with_room(bytes.len() + 5 * bytes.len().div_ceil(segment));
    // A window of 32 KiB, no dictionary, the fastest of four levels.
    stream.put(Word::new(0x0178, 16));
    bytes.chunks(segment).for_each(|bytes| stream.segment(bytes));
    // The last segment: empty, in deflate's fixed code.
    stream.put(Word::new(0b011, 10));
    stream.align();
    stream.put(Word::new(u64::from(simd_adler32::adler32(&bytes).swap_bytes()), 32));
    stream.bytes.truncate(stream.whole);
    stream.bytes
}

/// Bytes that are written bit by bit.
struct Stream {
    bytes: Vec<u8>,
    /// How many are complete.
    whole: usize,
    begun: Word,
}

impl Stream {
    /// Room for segments of so many bytes together, for what stands before and behind them, and to
    /// write a word.
    fn with_room(bytes: usize) -> Stream {
        Stream { bytes: vec![0; bytes + 2 + 2 + 4 + 8], whole: 0, begun: Word::default() }
    }

    /// Appends up to 57 bits.
    #[inline(always)]
    fn put(&mut self, word: Word) {
        let Word { bits, length } = self.begun.then(word);
        self.bytes[self.whole..][..8].copy_from_slice(&bits.to_le_bytes());
        self.whole += (length >> 3) as usize;
        self.begun = Word::new(bits >> (length & !7), length & 7);
    }

    /// Completes the begun byte with zeros.
    fn align(&mut self) {
        self.put(Word::new(0, self.begun.length.wrapping_neg() & 7));
    }

    fn segment(&mut self, bytes: &[u8]) {
        let pieces = pieces(bytes);
        let counts = counts(&pieces);
        let code = code(&counts, LONGEST_WORD);
        let header = header(&code);
        let bits = counts.iter().zip(&code).map(|(count, word)| count * word.length).sum::<u32>()
            + pieces.iter().filter_map(Piece::run).map(|(_, rest)| rest.length).sum::<u32>()
            + header.iter().map(|word| word.length).sum::<u32>();
        if bits < 8 * bytes.len() as u32 + 32 {
            header.into_iter().for_each(|word| self.put(word));
            pieces.iter().for_each(|piece| self.piece(piece, &code));
            self.put(code[END]);
        } else {
            self.stored(bytes);
        }
    }

    fn piece(&mut self, piece: &Piece, code: &[Word; SYMBOLS]) {
        let (fours, others) = piece.bytes.as_chunks();
        for four in fours {
            let [a, b, c, d] = four.map(|byte| code[usize::from(byte)]);
            self.put(a.then(b).then(c.then(d)));
        }
        others.iter().for_each(|byte| self.put(code[usize::from(*byte)]));
        if let Some((symbol, rest)) = piece.run() {
            self.put(code[symbol].then(rest));
        }
    }

    fn stored(&mut self, bytes: &[u8]) {
        self.put(Word::new(0b000, 3));
        self.align();
        let length = bytes.len() as u64;
        self.put(Word::new(length | (!length & 0xffff) << 16, 32));
        self.bytes[self.whole..][..bytes.len()].copy_from_slice(bytes);
        self.whole += bytes.len();
    }
}

/// Bytes as they are, then the last of them so many times more.
#[derive(Debug, PartialEq)]
struct Piece<'a> {
    bytes: &'a [u8],
    more: usize,
}

impl Piece<'_> {
    /// The symbol for the length of the run, and the bits behind it: the rest of the length, then a
    /// zero for the only distance there is, 1.
    fn run(&self) -> Option<(usize, Word)> {
        let beyond = self.more.checked_sub(3)?;
        let rest = beyond.max(1).ilog2().saturating_sub(2);
        let symbol = END + 1 + 4 * rest as usize + (beyond >> rest);
        Some((symbol, Word::new((beyond & ((1 << rest) - 1)) as u64, rest + 1)))
    }
}

/// Cuts a segment where one byte goes on.
fn pieces(bytes: &[u8]) -> Vec<Piece<'_>> {
    let goes_on = |at: usize| {
        bytes[at - 1..].first_chunk::<{ STEP + 1 }>().is_some_and(|all| all[..STEP] == all[1..])
    };
    let mut pieces = Vec::new();
    let (mut begin, mut end) = (0, 1);
    while end < bytes.len() {
        let run = end;
        while goes_on(end) && end < run + 256 {
            end += STEP;
        }
        if end > run {
            pieces.push(Piece { bytes: &bytes[begin..run], more: end - run });
            begin = end;
        } else {
            end += STEP;
        }
    }
    pieces.push(Piece { bytes: &bytes[begin..], more: 0 });
    pieces
}

/// How often each symbol occurs. In four tables, lest a byte wait for the count of an equal one
/// before it.
fn counts(pieces: &[Piece]) -> [u32; SYMBOLS] {
    let mut tables = [[0; SYMBOLS]; 4];
    for piece in pieces {
        let (fours, others) = piece.bytes.as_chunks::<4>();
        for four in fours {
            for (table, byte) in tables.iter_mut().zip(four) {
                table[usize::from(*byte)] += 1;
            }
        }
        others.iter().for_each(|byte| tables[0][usize::from(*byte)] += 1);
        piece.run().into_iter().for_each(|(symbol, _)| tables[0][symbol] += 1);
    }
    tables[0][END] += 1;
    std::array::from_fn(|symbol| tables.iter().map(|table| table[symbol]).sum())
}

/// What stands before a coded segment: the lengths of its words and of the one distance's, 1,
/// themselves coded.
fn header(words: &[Word; SYMBOLS]) -> Vec<Word> {
    let lengths: Vec<u32> = words.iter().map(|word| word.length).chain([1]).collect();
    let repeats = repeats(&lengths);
    let mut counts = [0; 19];
    repeats.iter().for_each(|(symbol, _)| counts[*symbol] += 1);
    let code = code(&counts, 7);
    let sent =
        ORDER.iter().rposition(|&symbol| code[symbol].length > 0).map_or(4, |last| 4.max(last + 1));
    let mut header = vec![
        Word::new(0b100, 3),
        Word::new(SYMBOLS as u64 - 257, 10),
        Word::new(sent as u64 - 4, 4),
    ];
    header.extend(ORDER[..sent].iter().map(|&symbol| Word::new(u64::from(code[symbol].length), 3)));
    header.extend(repeats.into_iter().map(|(symbol, times)| code[symbol].then(times)));
    header
}

/// Lengths as deflate writes them: each itself, or 16 for the last one again, 17 and 18 for zeros,
/// and how many times.
fn repeats(lengths: &[u32]) -> Vec<(usize, Word)> {
    let mut repeats = Vec::with_capacity(lengths.len());
    for alike in lengths.chunk_by(|a, b| a == b) {
        let itself = (alike[0] as usize, Word::default());
        let mut left = alike.len();
        if alike[0] > 0 {
            repeats.push(itself);
            left -= 1;
        }
        while left >= 3 {
            let (symbol, least, most, bits) = match (alike[0], left) {
                (0, 11..) => (18, 11, 138, 7),
                (0, _) => (17, 3, 10, 3),
                _ => (16, 3, 6, 2),
            };
            let times = left.min(most);
            repeats.push((symbol, Word::new((times - least) as u64, bits)));
            left -= times;
        }
        repeats.extend(std::iter::repeat_n(itself, left));
    }
    repeats
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn inflated(stream: &[u8]) -> Vec<u8> {
        zune_inflate::DeflateDecoder::new(stream).decode_zlib().unwrap()
    }

    /// Compresses in segments of several lengths, compares what an inflater of other make reads,
    /// and returns the shortest stream's length.
    fn there_and_back(bytes: &[u8]) -> usize {
        let there = |segment| {
            let stream = deflated(bytes, segment);
            assert!(inflated(&stream) == bytes, "{} bytes in segments of {segment}", bytes.len());
            stream.len()
        };
        [LONGEST_SEGMENT, 1000, 257].into_iter().map(there).min().unwrap()
    }

    /// A linear congruential generator's upper bytes.
    fn noise(length: usize) -> Vec<u8> {
        let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        std::iter::successors(Some(1), next).map(|x| (x >> 24) as u8).take(length).collect()
    }

    #[test]
    fn short_and_plain_inputs_come_back() {
        for length in
            [0, 1, 2, 3, 4, 15, 16, 17, 18, 256, 257, 273, 274, 300, 1000, 1001, 65_535, 65_536]
        {
            there_and_back(&vec![7; length]);
            there_and_back(&(0..length).map(|i| (i % 2) as u8).collect::<Vec<_>>());
            there_and_back(&(0..length).map(|i| i as u8).collect::<Vec<_>>());
            there_and_back(&noise(length));
        }
    }

    #[test]
    fn a_constant_shrinks_two_hundredfold() {
        assert!(there_and_back(&[128; 90_000]) < 450);
    }

    #[test]
    fn noise_is_stored() {
        let noise = noise(200_000);
        let segments = noise.len().div_ceil(LONGEST_SEGMENT);
        assert!(deflated(&noise, LONGEST_SEGMENT).len() <= noise.len() + 5 * segments + 8);
        there_and_back(&noise);
    }

    #[test]
    fn words_that_would_be_too_long_come_back() {
        // Runs taken apart; with the end, that occurs once, Fibonacci counts give Huffman's tree a
        // branch of 21.
        let (mut count, mut next) = (1, 2);
        let mut bytes = Vec::new();
        for byte in 0..21 {
            bytes.extend(std::iter::repeat_n(byte, count));
            (count, next) = (next, count + next);
        }
        let apart: Vec<u8> = (0..bytes.len()).map(|i| bytes[i * 7919 % bytes.len()]).collect();
        let words = code(&counts(&pieces(&apart)), LONGEST_WORD);
        assert_eq!(words.iter().map(|word| word.length).max(), Some(14));
        there_and_back(&apart);
    }

    #[test]
    fn lengths_of_runs_have_the_symbols_of_rfc_1951() {
        let run = |more| Piece { bytes: &[], more }.run();
        assert_eq!(run(0), None);
        assert_eq!(run(3), Some((257, Word::new(0, 1))));
        assert_eq!(run(10), Some((264, Word::new(0, 1))));
        assert_eq!(run(16), Some((267, Word::new(1, 2))));
        assert_eq!(run(256), Some((284, Word::new(29, 6))));
    }

    proptest! {
        #[test]
        fn whatever_goes_in_comes_back(
            pairs in prop::collection::vec((any::<u8>(), 1usize..70), 0..200),
            narrow in 0u8..8,
        ) {
            let run = |&(byte, n): &(u8, usize)| std::iter::repeat_n(byte >> narrow, n);
            let bytes: Vec<u8> = pairs.iter().flat_map(run).collect();
            there_and_back(&bytes);
            there_and_back(&pairs.iter().map(|pair| pair.0 >> narrow).collect::<Vec<_>>());
        }
    }
}
