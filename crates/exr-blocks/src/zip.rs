//! The ZIP code of OpenEXR: bytes of even and of odd place apart, differences of neighbours,
//! deflate.
//!
//! Technical Introduction to OpenEXR, "Data Compression".

use crate::deflate::{LONGEST_SEGMENT, deflated};

/// Compresses one block; the block itself where that is not smaller, as the format asks.
pub fn compressed(block: Vec<u8>) -> Vec<u8> {
    // Low and high bytes of halves have little in common: no segment holds both.
    let half = block.len().div_ceil(2);
    let segments = half.div_ceil(LONGEST_SEGMENT).max(1);
    let packed = deflated(&differences(&block), half.div_ceil(segments));
    if packed.len() < block.len() { packed } else { block }
}

/// Even bytes, then odd bytes, each less its left neighbour plus 128 (modulo 256); the first stays.
fn differences(block: &[u8]) -> Vec<u8> {
    let (pairs, single) = block.as_chunks();
    let pairs = pairs.iter().copied().map(u16::from_le_bytes);
    let mut apart = Vec::with_capacity(block.len());
    apart.extend(pairs.clone().map(|pair| pair as u8));
    apart.extend(single);
    apart.extend(pairs.map(|pair| (pair >> 8) as u8));
    let neighbours = apart.iter().zip(apart.iter().skip(1));
    let mut differences = Vec::with_capacity(block.len());
    differences.extend(apart.first());
    differences.extend(neighbours.map(|(left, here)| here.wrapping_sub(*left).wrapping_add(128)));
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
