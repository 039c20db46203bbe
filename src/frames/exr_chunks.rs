//! Compressed blocks of an OpenEXR file: read in order, checked against the table of offsets,
//! decompressed.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use exr::block::chunk::TileCoordinates;
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr_blocks::{Damaged, piz};
use rayon::iter::{ParallelBridge, ParallelIterator};

use crate::error::{Error, Result};
use crate::frames::exr_file::{Part, cut_short, guarded};
use crate::frames::exr_rows::Rows;
use crate::frames::exr_sampling::{expanded, is_subsampled, stored_bytes};

impl Part<'_> {
    /// Decodes the rows that the window shows. `planes` holds `row_length` items for each row of
    /// the window; `visit` gets decoded rows, the items of just these, and room to
    /// work in. Results come in order of rows.
    pub(super) fn decode<T, R, V>(
        &self,
        planes: &mut [T],
        row_length: usize,
        visit: V,
    ) -> Result<Vec<R>>
    where
        T: Send,
        R: Send,
        V: Fn(&Rows, &mut [T], &mut Vec<f32>) -> R + Sync,
    {
        let (columns, rows) = self.seen();
        let shift = self.offset().1;
        if columns.is_empty() || rows.is_empty() {
            return Ok(Vec::new());
        }
        let lines = self.lines_per_unit();
        let units = rows.start / lines..rows.end.div_ceil(lines);
        let mut source = Chunks::open(self, units.clone())?;
        let top = (rows.start as i64 + shift) as usize;
        let mut rest = &mut planes[top * row_length..];
        let jobs = units.map(|unit| {
            let seen = rows.start.max(unit * lines)..rows.end.min((unit + 1) * lines);
            let (mine, others) = std::mem::take(&mut rest).split_at_mut(seen.len() * row_length);
            rest = others;
            (unit, seen, mine, source.unit(unit))
        });
        let mut results: Vec<(usize, Result<R>)> = jobs
            .par_bridge()
            .map_init(Vec::new, |room, (unit, seen, mine, chunks)| {
                let rows = chunks.and_then(|chunks| self.decompress(unit, seen, chunks));
                (unit, rows.map(|rows| visit(&rows, mine, room)))
            })
            .collect();
        results.sort_by_key(|(unit, _)| *unit);
        results.into_iter().map(|(_, result)| result).collect()
    }

    fn decompress(&self, unit: usize, seen: Range<usize>, chunks: Vec<Vec<u8>>) -> Result<Rows> {
        let decompress = |(i, bytes): (usize, Vec<u8>)| {
            let area = self.area(unit, i)?;
            let columns =
                area.position.x() as usize..area.position.x() as usize + area.size.width();
            Ok((columns, decompressed(self.header, bytes, area, &self.file.path)?))
        };
        Ok(Rows {
            blocks: chunks.into_iter().enumerate().map(decompress).collect::<Result<_>>()?,
            bytes_per_pixel: self.header.channels.bytes_per_pixel,
            first: unit * self.lines_per_unit(),
            seen,
            columns: self.seen().0,
            offset: self.offset(),
        })
    }

    /// The pixels of chunk `i` of a unit, from the data window's corner.
    fn area(&self, unit: usize, i: usize) -> Result<IntegerBounds> {
        let tile = TileCoordinates { tile_index: Vec2(i, unit), level_index: Vec2(0, 0) };
        guarded(&self.file.path, || self.header.get_absolute_block_pixel_coordinates(tile))
    }
}

/// The compressed chunks of a part, read in order.
pub(super) struct Chunks<'a> {
    part: &'a Part<'a>,
    reader: BufReader<File>,
    first_unit: usize,
    offsets: Vec<u64>,
}

impl<'a> Chunks<'a> {
    pub(super) fn open(part: &'a Part<'a>, units: Range<usize>) -> Result<Self> {
        let path = &part.file.path;
        let per_unit = part.chunks_per_unit();
        let before: usize =
            part.file.meta.headers[..part.index].iter().map(|header| header.chunk_count).sum();
        let start = part.file.tables_at + 8 * (before + units.start * per_unit) as u64;
        let count = units.len() * per_unit;
        if start + 8 * count as u64 > part.file.bytes {
            return Err(cut_short(path));
        }
        let mut reader =
            BufReader::with_capacity(1 << 18, File::open(path).map_err(Error::io(path, "read"))?);
        reader.seek(SeekFrom::Start(start)).map_err(Error::io(path, "read"))?;
        let mut table = vec![0; 8 * count];
        read_whole(&mut reader, &mut table, path)?;
        let offsets = table.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
        Ok(Chunks { part, reader, first_unit: units.start, offsets })
    }

    /// The compressed blocks of one unit of rows.
    pub(super) fn unit(&mut self, unit: usize) -> Result<Vec<Vec<u8>>> {
        (0..self.part.chunks_per_unit()).map(|i| self.chunk(unit, i)).collect()
    }

    /// Reads one chunk after checking that it says what its place in the table says.
    fn chunk(&mut self, unit: usize, i: usize) -> Result<Vec<u8>> {
        let part = self.part;
        let path = &part.file.path;
        let offset = self.offsets[(unit - self.first_unit) * part.chunks_per_unit() + i];
        if offset == 0 {
            return Err(Error::file(
                path,
                "is incomplete: its writer stopped before the last block",
            ));
        }
        if offset < part.file.tables_at || offset >= part.file.bytes {
            return Err(cut_short(path));
        }
        let here = self.reader.stream_position().map_err(Error::io(path, "read"))?;
        self.reader.seek_relative(offset as i64 - here as i64).map_err(Error::io(path, "read"))?;
        for expected in part.marks(unit, i) {
            if self.number()? != expected {
                return Err(Error::file(
                    path,
                    format!("is damaged: block {unit} is not where its table says"),
                ));
            }
        }
        let size = self.number()?;
        let limit = part.header.max_block_byte_size().min((part.file.bytes - offset) as usize);
        if size < 0 || size as usize > limit {
            return Err(Error::file(
                path,
                format!("is damaged or cut short: block {unit} claims {size} bytes"),
            ));
        }
        let mut bytes = vec![0; size as usize];
        read_whole(&mut self.reader, &mut bytes, path)?;
        Ok(bytes)
    }

    fn number(&mut self) -> Result<i32> {
        let mut bytes = [0; 4];
        read_whole(&mut self.reader, &mut bytes, &self.part.file.path)?;
        Ok(i32::from_le_bytes(bytes))
    }
}

/// Decompresses one block: PIZ by our own codec, which is several times as fast, the rest by the
/// `exr` crate. Every pixel has a sample of every channel.
fn decompressed(
    header: &Header,
    bytes: Vec<u8>,
    area: IntegerBounds,
    path: &Path,
) -> Result<Vec<u8>> {
    if !is_subsampled(header) {
        return unpacked(header, bytes, area, path);
    }
    let (width, rows) = (area.size.width(), rows(header, area));
    let expected = stored_bytes(header, width, rows.clone());
    let block = if bytes.len() == expected {
        bytes
    } else {
        // The crate expects whole bytes of each pixel, and that many.
        let mut header = header.clone();
        header.channels.bytes_per_pixel = expected / area.size.area();
        unpacked(&header, bytes, area, path)?
    };
    if block.len() != expected {
        return Err(Error::file(path, "is damaged: a block has not the samples of its channels"));
    }
    Ok(expanded(header, &block, width, rows))
}

/// The rows of a block, as the file counts them.
fn rows(header: &Header, area: IntegerBounds) -> Range<i32> {
    let top = area.position.y() + header.own_attributes.layer_position.y();
    top..top + area.size.height() as i32
}

fn unpacked(header: &Header, bytes: Vec<u8>, area: IntegerBounds, path: &Path) -> Result<Vec<u8>> {
    // A block that would not shrink is stored as it is.
    let raw = bytes.len() == area.size.area() * header.channels.bytes_per_pixel;
    match header.compression {
        Compression::PIZ if !raw && cfg!(target_endian = "little") => piz(header, &bytes, area)
            .map_err(|problem| {
                let problem = format!("is damaged: its pixels cannot be decompressed ({problem})");
                Error::file(path, problem)
            }),
        Compression::DWAA(_) | Compression::DWAB(_)
            if !raw && !dwa_sizes_are_sound(&bytes, header, area) =>
        {
            Err(Error::file(path, "is damaged: a DWA block claims more than its pixels"))
        }
        _ => guarded(path, || {
            header.compression.decompress_image_section_from_le(header, bytes, area, false)
        }),
    }
}

fn piz(header: &Header, bytes: &[u8], area: IntegerBounds) -> Result<Vec<u8>, Damaged> {
    let channel = |channel: &ChannelDescription| piz::Channel {
        wide: channel.sample_type != SampleType::F16,
        sampling: (channel.sampling.x(), channel.sampling.y()),
    };
    let channels: Vec<piz::Channel> = header.channels.list.iter().map(channel).collect();
    piz::decoded(bytes, &channels, area.size.width(), rows(header, area))
}

/// The crate allocates what a DWA block's eleven counters claim. None is larger than the block,
/// whose sides are padded to eight pixels.
fn dwa_sizes_are_sound(bytes: &[u8], header: &Header, area: IntegerBounds) -> bool {
    let padded = area.size.width().next_multiple_of(8) * area.size.height().next_multiple_of(8);
    let largest = (2 * padded * header.channels.bytes_per_pixel) as u64;
    bytes.as_chunks().0.iter().take(11).all(|counter| u64::from_le_bytes(*counter) <= largest)
}

fn read_whole(reader: &mut impl Read, bytes: &mut [u8], path: &Path) -> Result<()> {
    reader.read_exact(bytes).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => cut_short(path),
        _ => Error::io(path, "read")(error),
    })
}
