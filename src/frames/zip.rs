//! The ZIP code of OpenEXR: bytes of even and of odd place apart, differences of neighbours, deflate.
//!
//! Technical Introduction to OpenEXR, "Data Compression". Deflate codes single bytes only (Huffman, no matches):
//! after the differences there is little left to match, and it is several times faster.

use zlib_rs::{DeflateConfig, ReturnCode, Strategy, compress_bound, compress_slice};

/// Compresses one block; the block itself where that is not smaller, as the format asks.
pub(super) fn compressed(block: Vec<u8>) -> Vec<u8> {
    let differences = differences(&block);
    let mut packed = vec![0; compress_bound(differences.len())];
    let config = DeflateConfig { level: 6, strategy: Strategy::HuffmanOnly, ..DeflateConfig::default() };
    let (written, code) = compress_slice(&mut packed, &differences, config);
    let length = written.len();
    if code != ReturnCode::Ok || length >= block.len() {
        return block;
    }
    packed.truncate(length);
    packed
}

/// Even bytes, then odd bytes, each less its left neighbour plus 128 (modulo 256); the first stays.
fn differences(block: &[u8]) -> Vec<u8> {
    let pairs = block.as_chunks::<2>();
    let mut apart = Vec::with_capacity(block.len());
    apart.extend(pairs.0.iter().map(|pair| pair[0]));
    apart.extend(pairs.1);
    apart.extend(pairs.0.iter().map(|pair| pair[1]));
    let mut differences = Vec::with_capacity(block.len());
    differences.extend(apart.first());
    differences.extend(apart.windows(2).map(|pair| pair[1].wrapping_sub(pair[0]).wrapping_add(128)));
    differences
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_parted_and_differenced() {
        assert_eq!(differences(&[10, 1, 12, 3, 11]), [10, 130, 127, 118, 130]);
        assert_eq!(differences(&[]), Vec::<u8>::new());
    }

    #[test]
    fn a_block_that_does_not_shrink_stays_as_it_is() {
        assert_eq!(compressed(vec![7]), [7]);
        assert!(compressed(vec![7; 1000]).len() < 200);
    }
}
