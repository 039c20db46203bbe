//! Headers of a file, attribute by attribute, in their order and as bytes: what a program that
//! passes them on needs, whatever they mean.
//!
//! OpenEXR File Layout, "Header" and "Version Field".

use std::io::{self, BufRead, Read, Write};

use crate::Damaged;

const MAGIC: u32 = 20_000_630;
/// The version, and the flags that may stand above it.
const VERSION: u32 = 2;
/// Flag of a file of one part in tiles.
pub const TILED: u32 = 0x200;
/// Flag of a file with names of more than 31 bytes.
pub const LONG_NAMES: u32 = 0x400;
/// Flag of a file with a deep part.
pub const DEEP: u32 = 0x800;
/// Flag of a file of several parts.
pub const MULTIPART: u32 = 0x1000;
/// Longest name of an attribute or a type, bytes.
const LONGEST_NAME: u64 = 255;

/// One attribute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attribute {
    pub name: Vec<u8>,
    /// The name of its type.
    pub kind: Vec<u8>,
    /// Its value as it stands in the file, without its size.
    pub value: Vec<u8>,
}

impl Attribute {
    /// An attribute of these names and bytes.
    pub fn new(name: &str, kind: &str, value: impl Into<Vec<u8>>) -> Attribute {
        Attribute { name: name.into(), kind: kind.into(), value: value.into() }
    }
}

/// The headers of all parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Headers {
    /// [`TILED`], [`LONG_NAMES`], [`DEEP`], [`MULTIPART`].
    pub flags: u32,
    pub parts: Vec<Vec<Attribute>>,
}

impl Headers {
    /// Reads from the first byte of a file up to its tables of offsets.
    ///
    /// # Errors
    /// Those of the reader, and [`io::ErrorKind::InvalidData`] with a [`Damaged`] inside.
    pub fn read(from: &mut impl BufRead) -> io::Result<Headers> {
        let [magic, version] = [number(from)?, number(from)?];
        if magic != MAGIC || version & 0xff != VERSION {
            return Err(damaged("no OpenEXR file of version 2"));
        }
        let flags = version & !0xff;
        let mut parts = Vec::new();
        loop {
            let part = attributes(from)?;
            let end = part.is_empty();
            if flags & MULTIPART == 0 || !end {
                parts.push(part);
            }
            if flags & MULTIPART == 0 || end {
                return Ok(Headers { flags, parts });
            }
        }
    }

    /// Writes what [`Headers::read`] reads.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        to.write_all(&MAGIC.to_le_bytes())?;
        to.write_all(&(VERSION | self.flags).to_le_bytes())?;
        for part in &self.parts {
            for Attribute { name, kind, value } in part {
                let size = u32::try_from(value.len()).map_err(io::Error::other)?;
                for bytes in [&name[..], b"\0", kind, b"\0", &size.to_le_bytes(), value] {
                    to.write_all(bytes)?;
                }
            }
            to.write_all(b"\0")?;
        }
        if self.flags & MULTIPART != 0 { to.write_all(b"\0") } else { Ok(()) }
    }
}

/// Reads the attributes of one part, up to the zero byte behind them.
pub fn attributes(from: &mut impl BufRead) -> io::Result<Vec<Attribute>> {
    let mut attributes = Vec::new();
    loop {
        let name = name(from)?;
        if name.is_empty() {
            return Ok(attributes);
        }
        let kind = self::name(from)?;
        let size = u64::from(number(from)?);
        let mut value = Vec::new();
        from.take(size).read_to_end(&mut value)?;
        if value.len() as u64 != size {
            return Err(damaged("an attribute that is cut short"));
        }
        attributes.push(Attribute { name, kind, value });
    }
}

fn name(from: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut name = Vec::new();
    from.take(LONGEST_NAME + 1).read_until(0, &mut name)?;
    if name.pop() == Some(0) { Ok(name) } else { Err(damaged("a name without an end")) }
}

fn number(from: &mut impl Read) -> io::Result<u32> {
    let mut bytes = [0; 4];
    from.read_exact(&mut bytes)?;
    Ok(u32::from_le_bytes(bytes))
}

fn damaged(what: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, Damaged(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn attribute() -> impl Strategy<Value = Attribute> {
        let name = || prop::collection::vec(1u8.., 1..40);
        (name(), name(), prop::collection::vec(any::<u8>(), 0..50))
            .prop_map(|(name, kind, value)| Attribute { name, kind, value })
    }

    proptest! {
        #[test]
        fn headers_come_back_in_order_and_to_the_byte(
            parts in prop::collection::vec(prop::collection::vec(attribute(), 1..5), 1..4),
        ) {
            let flags = if parts.len() > 1 { MULTIPART } else { 0 };
            let headers = Headers { flags, parts };
            let mut bytes = Vec::new();
            headers.write(&mut bytes).unwrap();
            prop_assert_eq!(Headers::read(&mut &bytes[..]).unwrap(), headers);
            for length in 0..bytes.len() {
                prop_assert!(Headers::read(&mut &bytes[..length]).is_err());
            }
        }

        #[test]
        fn no_bytes_are_fatal(
            bytes in prop::collection::vec(any::<u8>(), 0..200),
            flags in 0u32..16,
        ) {
            let start = [MAGIC.to_le_bytes(), (VERSION | flags << 9).to_le_bytes()].concat();
            let _ = Headers::read(&mut &[start, bytes].concat()[..]);
        }
    }
}
