//! Bytes read bit by bit.

/// Bytes read bit by bit, the highest first. Behind the last one there are zeros.
#[derive(Clone, Copy)]
pub(super) struct Bits<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
}

impl Bits<'_> {
    /// The next 57 bits or more, from the top.
    #[inline(always)]
    pub(crate) fn ahead(&self) -> u64 {
        let bytes = self.bytes.get(self.at >> 3..).unwrap_or(&[]);
        let eight = bytes
            .first_chunk()
            .map_or_else(|| last_bytes(bytes), |eight| u64::from_be_bytes(*eight));
        eight << (self.at & 7)
    }

    /// The next 64 bits.
    #[inline(always)]
    pub(crate) fn all_ahead(&self) -> u64 {
        let ninth = self.bytes.get((self.at >> 3) + 8).copied().unwrap_or(0);
        self.ahead() | u64::from(ninth) >> (8 - (self.at & 7))
    }

    pub(crate) fn take(&mut self, count: usize) -> u64 {
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
