//! Files put together of headers and of chunks that are encoded already, by this program or by the
//! one that wrote another file.
//!
//! OpenEXR File Layout, "Chunk Offset Table" and "Chunks".

use std::io::{self, Read, Seek, SeekFrom, Write};

use crate::Damaged;
use crate::header::{Headers, MULTIPART};

/// What the chunks of a part are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    pub tiled: bool,
    pub deep: bool,
}

impl Layout {
    /// Bytes that say where a chunk belongs, and those of its sizes.
    fn heads(self) -> (usize, usize) {
        (if self.tiled { 16 } else { 4 }, if self.deep { 24 } else { 4 })
    }
}

/// Writes a file.
pub struct Writer<W> {
    sink: W,
    multipart: bool,
    tables_at: u64,
    /// How many bytes were written.
    at: u64,
    counts: Vec<usize>,
    offsets: Vec<Vec<u64>>,
}

impl<W: Write + Seek> Writer<W> {
    /// Writes the headers and leaves room for the tables of as many chunks as each part has.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn begin(mut sink: W, headers: &Headers, counts: Vec<usize>) -> io::Result<Self> {
        let mut start = Vec::new();
        headers.write(&mut start)?;
        let tables_at = start.len() as u64;
        start.resize(start.len() + 8 * counts.iter().sum::<usize>(), 0);
        sink.write_all(&start)?;
        let offsets = vec![Vec::new(); counts.len()];
        let multipart = headers.flags & MULTIPART != 0;
        Ok(Writer { sink, multipart, tables_at, at: start.len() as u64, counts, offsets })
    }

    /// Appends a block of scan lines from row `y` on as the next chunk of a part.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn scan_lines(&mut self, part: usize, y: i32, block: &[u8]) -> io::Result<()> {
        let number = self.multipart.then_some(part as i32);
        let head = number.into_iter().chain([y, block.len() as i32]);
        let head: Vec<u8> = head.flat_map(i32::to_le_bytes).collect();
        self.offsets[part].push(self.at);
        self.at += (head.len() + block.len()) as u64;
        self.sink.write_all(&head)?;
        self.sink.write_all(block)
    }

    /// Copies the chunk at `offset` of another file of several parts as the next chunk of the part
    /// that has the same number there.
    ///
    /// # Errors
    /// Those of both files; [`Damaged`] where there is no such chunk.
    pub fn copy<R: Read + Seek>(
        &mut self,
        part: usize,
        layout: Layout,
        from: &mut R,
        offset: u64,
    ) -> io::Result<()> {
        let (place, sizes) = layout.heads();
        let mut head = vec![0; 4 + place + sizes];
        from.seek(SeekFrom::Start(offset))?;
        from.read_exact(&mut head)?;
        let size =
            packed_size(&head[4 + place..]).filter(|_| head[..4] == (part as i32).to_le_bytes());
        let size = size.ok_or_else(|| damaged("a chunk is not where its table says"))?;
        self.offsets[part].push(self.at);
        self.at += head.len() as u64 + size;
        self.sink.write_all(&head)?;
        if io::copy(&mut from.take(size), &mut self.sink)? == size {
            Ok(())
        } else {
            Err(damaged("a chunk is cut short"))
        }
    }

    /// Writes the tables.
    ///
    /// # Errors
    /// Those of the sink; [`Damaged`] where a part has not got its chunks.
    pub fn end(mut self) -> io::Result<()> {
        if self.offsets.iter().map(Vec::len).ne(self.counts) {
            return Err(damaged("a part has not got as many chunks as were announced"));
        }
        let table: Vec<u8> =
            self.offsets.iter().flatten().flat_map(|at| at.to_le_bytes()).collect();
        self.sink.seek(SeekFrom::Start(self.tables_at))?;
        self.sink.write_all(&table)
    }
}

/// The bytes behind a chunk's head: its one size, or those of a deep chunk's table and samples.
fn packed_size(sizes: &[u8]) -> Option<u64> {
    match *sizes.as_chunks::<8>().0 {
        [table, samples, _] => u64::from_le_bytes(table).checked_add(u64::from_le_bytes(samples)),
        _ => u64::try_from(i32::from_le_bytes(*sizes.first_chunk()?)).ok(),
    }
}

fn damaged(what: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, Damaged(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::{Attribute, DEEP};
    use std::io::Cursor;

    const DEEP_TILES: Layout = Layout { tiled: true, deep: true };

    fn headers() -> Headers {
        let part = |name: &str| vec![Attribute::new("name", "string", name)];
        Headers { flags: MULTIPART | DEEP, parts: vec![part("a"), part("b")] }
    }

    /// A file whose part 1 is one chunk of deep tiles with five bytes.
    fn source() -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let mut writer = Writer::begin(&mut file, &headers(), vec![1, 1]).unwrap();
        writer.scan_lines(0, 7, b"block").unwrap();
        let sizes: Vec<u8> = [2u64, 3, 99].iter().flat_map(|size| size.to_le_bytes()).collect();
        let chunk = [&1i32.to_le_bytes()[..], &[0; 16], &sizes, b"tsssbeyond"].concat();
        writer.copy(1, DEEP_TILES, &mut Cursor::new(chunk), 0).unwrap();
        writer.end().unwrap();
        file.into_inner()
    }

    #[test]
    fn chunks_stand_where_the_tables_say() {
        let file = source();
        let mut rest = &file[..];
        assert_eq!(Headers::read(&mut rest).unwrap(), headers());
        let offset = |i: usize| u64::from_le_bytes(*rest[8 * i..].first_chunk().unwrap()) as usize;
        assert_eq!(&file[offset(0)..offset(1)], b"\0\0\0\0\x07\0\0\0\x05\0\0\0block");
        assert_eq!(&file[file.len() - 5..], b"tsssb");
        assert_eq!(file.len() - offset(1), 4 + 16 + 24 + 5);
    }

    #[test]
    fn a_chunk_that_is_not_there_or_cut_short_is_damaged() {
        let file = source();
        let copied = |part: usize, layout: Layout, file: &[u8]| {
            let mut copy = Cursor::new(Vec::new());
            let mut writer = Writer::begin(&mut copy, &headers(), vec![0, 1]).unwrap();
            let at = file.len() as u64 - 49;
            writer.copy(part, layout, &mut Cursor::new(file), at).and_then(|()| writer.end())
        };
        assert!(copied(1, DEEP_TILES, &file).is_ok());
        assert!(copied(0, DEEP_TILES, &file).is_err());
        for length in file.len() - 48..file.len() {
            let mut writer =
                Writer::begin(Cursor::new(Vec::new()), &headers(), vec![0, 1]).unwrap();
            let at = file.len() as u64 - 49;
            assert!(writer.copy(1, DEEP_TILES, &mut Cursor::new(&file[..length]), at).is_err());
        }
    }

    #[test]
    fn a_part_without_its_chunks_is_not_finished() {
        let writer = Writer::begin(Cursor::new(Vec::new()), &headers(), vec![1, 0]).unwrap();
        assert!(writer.end().is_err());
    }
}
