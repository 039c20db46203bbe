//! Huffman codes in the form of deflate: words of bounded length, numbered by their lengths alone.
//!
//! Huffman 1952, "A method for the construction of minimum-redundancy codes"; RFC 1951, 3.2.2.

/// Up to 64 bits, the first to be sent lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Word {
    pub bits: u64,
    pub length: u32,
}

impl Word {
    pub(crate) fn new(bits: u64, length: u32) -> Word {
        Word { bits, length }
    }

    /// This word and another behind it.
    #[inline(always)]
    pub(crate) fn then(self, next: Word) -> Word {
        Word { bits: self.bits | next.bits << self.length, length: self.length + next.length }
    }
}

/// The code for symbols that occur so often, no word longer than `longest` bits (at most 15); what
/// does not occur has none. A symbol that is alone gets one bit. Counts sum to less than 2^23;
/// there are fewer than 512.
pub(crate) fn code<const N: usize>(counts: &[u32; N], longest: usize) -> [Word; N] {
    let mut rising: Vec<u32> =
        (0..N).filter(|&i| counts[i] > 0).map(|i| counts[i] << 9 | i as u32).collect();
    rising.sort_unstable();
    let weights: Vec<u32> = rising.iter().map(|symbol| symbol >> 9).collect();
    let of_length = bounded(of_each_length(&weights), longest);
    let lengths = (1..=longest)
        .rev()
        .flat_map(|length| std::iter::repeat_n(length as u32, of_length[length]));
    let mut words = [Word::default(); N];
    for (symbol, length) in rising.iter().zip(lengths) {
        words[(symbol & 0x1ff) as usize].length = length;
    }
    number(&mut words, &of_length);
    words
}

/// How many words of each length Huffman's tree has for rising weights. Its inner nodes arise in
/// rising order too, so that the two lightest nodes stand at the heads of two queues.
fn of_each_length(weights: &[u32]) -> [usize; 64] {
    let leaves = weights.len();
    let root = (2 * leaves).saturating_sub(2);
    let (mut weight, mut parent, mut depth) =
        (weights.to_vec(), vec![0; root + 1], vec![0; root + 1]);
    let (mut leaf, mut inner) = (0, leaves);
    for node in leaves.max(1)..=root {
        let mut both = 0;
        for _ in 0..2 {
            let from_leaves = leaf < leaves && (inner == node || weight[leaf] <= weight[inner]);
            let lightest = if from_leaves { &mut leaf } else { &mut inner };
            both += weight[*lightest];
            parent[*lightest] = node;
            *lightest += 1;
        }
        weight.push(both);
    }
    for node in (0..root).rev() {
        depth[node] = depth[parent[node]] + 1;
    }
    let mut of_length = [0; 64];
    depth.iter().take(leaves).for_each(|&depth: &usize| of_length[depth.max(1)] += 1);
    of_length
}

/// Shortens the words that are too long, then lengthens the longest of the others until all fit
/// (Kraft 1949: the sum of 2^-length is 1).
fn bounded(mut of_length: [usize; 64], longest: usize) -> [usize; 64] {
    of_length[longest] += of_length[longest + 1..].iter().sum::<usize>();
    of_length[longest + 1..].fill(0);
    let taken: usize = (1..=longest).map(|length| of_length[length] << (longest - length)).sum();
    for _ in 1 << longest..taken {
        let Some(length) = (1..longest).rev().find(|&length| of_length[length] > 0) else { break };
        of_length[longest] -= 1;
        of_length[length] -= 1;
        of_length[length + 1] += 2;
    }
    of_length
}

/// Numbers words in the order of their lengths, then of their symbols. Deflate sends the highest
/// bit first.
fn number(words: &mut [Word], of_length: &[usize; 64]) {
    let mut next = [0u16; 16];
    for length in 2..16 {
        next[length] = (next[length - 1] + of_length[length - 1] as u16) << 1;
    }
    for word in words.iter_mut().filter(|word| word.length > 0) {
        let next = &mut next[word.length as usize];
        word.bits = u64::from(next.reverse_bits() >> (16 - word.length));
        *next += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Sum of 2^-length, in units of 2^-15.
    fn kraft(words: &[Word]) -> u32 {
        words.iter().filter(|word| word.length > 0).map(|word| 1 << (15 - word.length)).sum()
    }

    #[test]
    fn the_example_of_rfc_1951_comes_out_as_printed() {
        // Lengths 3, 3, 3, 3, 3, 2, 4, 4 for A to H; F is 00, A 010, G 1110, H 1111.
        let words = code(&[4, 4, 4, 4, 4, 8, 2, 2], 15);
        assert_eq!(words.map(|word| word.length), [3, 3, 3, 3, 3, 2, 4, 4]);
        assert_eq!(
            [words[5], words[0], words[6], words[7]].map(|word| word.bits),
            [0, 0b010, 0b0111, 0b1111]
        );
    }

    #[test]
    fn fibonacci_counts_are_kept_to_the_bound() {
        let mut counts = [1u32; 28];
        (2..28).for_each(|i| counts[i] = counts[i - 1] + counts[i - 2]);
        assert_eq!(of_each_length(&counts)[27], 2);
        let words = code(&counts, 14);
        assert_eq!(words.iter().map(|word| word.length).max(), Some(14));
        assert_eq!(kraft(&words), 1 << 15);
        assert!(words.is_sorted_by(|rarer, commoner| rarer.length >= commoner.length));
    }

    #[test]
    fn one_symbol_takes_one_bit_and_none_takes_none() {
        assert_eq!(code(&[0, 7, 0], 7), [Word::default(), Word::new(0, 1), Word::default()]);
        assert_eq!(code(&[0; 3], 7), [Word::default(); 3]);
    }

    proptest! {
        #[test]
        fn every_code_is_full_and_no_word_begins_another(counts: [u16; 24], longest in 5usize..=15) {
            let counts = counts.map(|count| u32::from(count) >> (count & 15));
            let words = code(&counts, longest).into_iter();
            let words: Vec<Word> = words.filter(|word| word.length > 0).collect();
            prop_assume!(words.len() > 1);
            prop_assert_eq!(kraft(&words), 1 << 15);
            for (i, a) in words.iter().enumerate() {
                prop_assert!(a.length as usize <= longest);
                let start = |b: &Word| b.bits & ((1 << a.length) - 1);
                let begins = |b: &Word| b.length >= a.length && start(b) == a.bits;
                prop_assert!(words.iter().enumerate().all(|(j, b)| i == j || !begins(b)));
            }
        }
    }
}
