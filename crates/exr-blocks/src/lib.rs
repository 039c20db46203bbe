//! Codecs of OpenEXR blocks (PIZ decoded, ZIP encoded), and headers as bytes.
//!
//! * [`piz`]: PIZ blocks decoded, several times as fast as by the `exr` crate, bit for bit
//!   the same.
//! * [`zip`]: ZIP and ZIPS blocks encoded by a deflate for differences of neighbours and nothing
//!   else, many times as fast as a general one; any inflate reads them.
//! * [`header`]: headers attribute by attribute, as bytes, to be passed on.
//! * [`chunks`]: files put together of headers and encoded chunks.
//!
//! A block is what one chunk of a file holds: consecutive rows, each channel after channel in the
//! order of their names, little-endian. Blocks are independent of each other, so that a caller may
//! do many at once; nothing here starts a thread. No input makes these functions panic or allocate
//! more than the block that was declared and fixed tables.

pub mod chunks;
mod damaged;
mod deflate;
pub mod header;
mod huffman;
pub mod piz;
pub mod zip;

pub use damaged::Damaged;

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
