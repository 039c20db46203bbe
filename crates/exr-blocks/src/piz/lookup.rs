//! The table of the values that occur in a block. It is sent as a bitmap, without zero bytes at its
//! ends; zero itself always counts as occurring.

use crate::Damaged;

/// Bytes of a bitmap over all 16-bit values.
const BITMAP: usize = 1 << 13;

/// Values by their rank.
pub(super) struct Lookup {
    values: Box<[u16; 1 << 16]>,
    /// The rank of the largest value.
    pub largest: u16,
}

impl Lookup {
    /// Reads the bitmap; what follows it is returned too.
    pub(crate) fn read(bytes: &[u8]) -> Result<(Lookup, &[u8]), Damaged> {
        let (ends, bytes) =
            bytes.split_first_chunk::<4>().ok_or(Damaged("a block without a table of values"))?;
        let first = usize::from(u16::from_le_bytes([ends[0], ends[1]]));
        let last = usize::from(u16::from_le_bytes([ends[2], ends[3]]));
        if first >= BITMAP || last >= BITMAP {
            return Err(Damaged("a table of values beyond 16 bits"));
        }
        let length = (last + 1).saturating_sub(first);
        let (bitmap, rest) =
            bytes.split_at_checked(length).ok_or(Damaged("a table of values that is cut short"))?;
        Ok((Lookup::of(first, bitmap), rest))
    }

    fn of(first: usize, bitmap: &[u8]) -> Lookup {
        let mut values: Box<[u16; 1 << 16]> =
            vec![0; 1 << 16].try_into().unwrap_or_else(|_| unreachable!());
        let mut rank = 0;
        for (byte, &bits) in bitmap.iter().enumerate() {
            let mut bits = if first + byte == 0 { bits & !1 } else { bits };
            while bits != 0 {
                rank += 1;
                values[rank] = (8 * (first + byte)) as u16 + bits.trailing_zeros() as u16;
                bits &= bits - 1;
            }
        }
        Lookup { values, largest: rank as u16 }
    }

    /// Writes the values of ranks, little-endian.
    pub(crate) fn values(&self, ranks: &[u16], out: &mut [u8]) {
        for (&rank, out) in ranks.iter().zip(out.as_chunks_mut().0) {
            *out = self.values[usize::from(rank)].to_le_bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_the_values_that_occur_and_of_zero() {
        let (lookup, rest) = Lookup::read(&[1, 0, 2, 0, 0b101, 0x80, 77]).unwrap();
        assert_eq!((lookup.largest, rest), (3, &[77][..]));
        let mut out = [0; 10];
        lookup.values(&[0, 1, 2, 3, 4], &mut out);
        assert_eq!(out.as_chunks().0, [0u16, 8, 10, 23, 0].map(u16::to_le_bytes));
    }

    #[test]
    fn a_bitmap_beyond_its_bounds_is_damaged() {
        for bytes in
            [&[][..], &[0, 0, 0], &[0, 32, 0, 0, 1], &[0, 0, 0, 32, 1], &[0, 0, 3, 0, 1, 1, 1]]
        {
            assert!(Lookup::read(bytes).is_err(), "{bytes:?}");
        }
    }
}
