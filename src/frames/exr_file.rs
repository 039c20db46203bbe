//! One OpenEXR file: its headers, and its pixels decoded one block of rows at a time.
//!
//! Compressed blocks are read in the file's order by whichever thread is free and decompressed in the current
//! rayon pool; a frame is never held but in the planes that it ends in. The `exr` crate reads headers and
//! decompresses; its own parallel reader would build a pool per file.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use exr::block::chunk::TileCoordinates;
use exr::math::Vec2;
use exr::meta::attribute::{IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use half::f16;
use rayon::iter::{ParallelBridge, ParallelIterator};

use crate::error::{Error, Result};
use crate::frames::census::{Sample, widen};

/// More uncompressed bytes than this for each byte of a file is no picture: the densest code there is (a black
/// frame under DWAB) packs 50 000 into one.
const DENSEST: u64 = 65_536;

/// A file whose headers were read.
pub(super) struct ExrFile {
    pub path: PathBuf,
    pub meta: MetaData,
    bytes: u64,
    tables_at: u64,
}

impl ExrFile {
    /// Reads and checks the headers.
    pub fn open(path: &Path) -> Result<ExrFile> {
        let file = File::open(path).map_err(Error::io(path, "read"))?;
        let bytes = file.metadata().map_err(Error::io(path, "read"))?.len();
        let mut reader = BufReader::new(file);
        let meta = guarded(path, || {
            let meta = MetaData::read_from_buffered(reader.by_ref(), false)?;
            MetaData::validate(&meta.headers, false)?;
            Ok(meta)
        })?;
        let tables_at = reader.stream_position().map_err(Error::io(path, "read"))?;
        Ok(ExrFile { path: path.to_owned(), meta, bytes, tables_at })
    }

    /// The picture of one part, once its declared size has been found believable.
    pub fn part(&self, index: usize, max_pixels: u64) -> Result<Part<'_>> {
        let header = &self.meta.headers[index];
        let display = header.shared_attributes.display_window;
        let (width, height) = (display.size.width(), display.size.height());
        for size in [display.size, header.layer_size] {
            let pixels = size.width() as u64 * size.height() as u64;
            if pixels == 0 || pixels > max_pixels {
                let problem =
                    format!("declares {} x {} pixels; 1 to max_pixels = {max_pixels} are read", size.0, size.1);
                return Err(Error::file(&self.path, problem));
            }
        }
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(Error::file(
                &self.path,
                "has subsampled channels (luminance/chroma); channels of full size are read",
            ));
        }
        let pixels = header.layer_size.width() as u64 * header.layer_size.height() as u64;
        let declared = pixels * header.channels.bytes_per_pixel as u64;
        if declared / DENSEST > self.bytes {
            let problem = format!("declares {declared} bytes of pixels in a file of {} bytes", self.bytes);
            return Err(Error::file(&self.path, problem));
        }
        Ok(Part { file: self, index, header, width, height })
    }
}

/// The picture of one part. `width` and `height` are those of the display window.
pub(super) struct Part<'a> {
    file: &'a ExrFile,
    index: usize,
    pub header: &'a Header,
    pub width: usize,
    pub height: usize,
}

/// Where the samples of a channel lie in a row of a block, and what they are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Bytes of the channels before it, per pixel.
    before: usize,
    pub kind: SampleType,
}

/// Consecutive rows, decompressed: one block of scan lines, or one row of tiles.
pub(super) struct Rows {
    blocks: Vec<(Range<usize>, Vec<u8>)>,
    bytes_per_pixel: usize,
    first: usize,
    /// Rows of the data window that lie in the display window.
    seen: Range<usize>,
    /// Columns of the data window that lie in the display window.
    columns: Range<usize>,
    /// Where the data window stands in the display window.
    offset: (i64, i64),
}

impl Part<'_> {
    /// Where the samples of a channel lie.
    pub fn place(&self, channel: usize) -> Place {
        let list = &self.header.channels.list;
        let before = list[..channel].iter().map(|c| c.sample_type.bytes_per_sample()).sum();
        Place { before, kind: list[channel].sample_type }
    }

    /// Whether every pixel of the display window has data.
    pub fn covers_display(&self) -> bool {
        let (columns, rows) = self.seen();
        columns.len() == self.width && rows.len() == self.height
    }

    /// Decodes the rows that the display window shows. `planes` holds `row_length` items for each row of the
    /// display window; `visit` gets decoded rows, the items of just these, and room to work in. Results come in
    /// order of rows.
    pub fn decode<T, R, V>(&self, planes: &mut [T], row_length: usize, visit: V) -> Result<Vec<R>>
    where
        T: Send,
        R: Send,
        V: Fn(&Rows, &mut [T], &mut Vec<f32>) -> R + Sync,
    {
        let (_, rows) = self.seen();
        let shift = self.offset().1;
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let lines = self.lines_per_unit();
        let units = rows.start / lines..rows.end.div_ceil(lines);
        let mut source = Source::open(self, units.clone())?;
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
            let columns = area.position.x() as usize..area.position.x() as usize + area.size.width();
            let header = self.header;
            let pixels = guarded(&self.file.path, || {
                header.compression.decompress_image_section_from_le(header, bytes, area, false)
            })?;
            Ok((columns, pixels))
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

    fn lines_per_unit(&self) -> usize {
        self.header.max_block_pixel_size().height()
    }

    fn chunks_per_unit(&self) -> usize {
        match self.header.blocks {
            BlockDescription::ScanLines => 1,
            BlockDescription::Tiles(tiles) => self.header.layer_size.width().div_ceil(tiles.tile_size.width()),
        }
    }

    fn offset(&self) -> (i64, i64) {
        let (data, display) = (self.header.own_attributes.layer_position, self.header.shared_attributes.display_window);
        let apart = |a: i32, b: i32| i64::from(a) - i64::from(b);
        (apart(data.x(), display.position.x()), apart(data.y(), display.position.y()))
    }

    /// Columns and rows of the data window that lie in the display window.
    fn seen(&self) -> (Range<usize>, Range<usize>) {
        let overlap = |offset: i64, data: usize, display: usize| {
            let end = (display as i64 - offset).clamp(0, data as i64) as usize;
            ((-offset).clamp(0, end as i64) as usize)..end
        };
        let (dx, dy) = self.offset();
        let size = self.header.layer_size;
        (overlap(dx, size.width(), self.width), overlap(dy, size.height(), self.height))
    }
}

impl Rows {
    /// Rows of the display window, with each one's index among the items that `visit` was given.
    pub fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<'_> {
        self.seen.clone().enumerate().map(|(i, row)| (i, (row as i64 + self.offset.1) as usize))
    }

    /// Columns of the display window that have data.
    pub fn columns(&self) -> Range<usize> {
        let to_display = |column: usize| (column as i64 + self.offset.0) as usize;
        to_display(self.columns.start)..to_display(self.columns.end)
    }

    /// Copies the seen samples of a channel in the `i`th of [`Rows::rows`].
    pub fn fetch<T: Stored>(&self, i: usize, place: Place, out: &mut [T]) {
        let row = self.seen.start + i - self.first;
        for (columns, bytes) in &self.blocks {
            let seen = columns.start.max(self.columns.start)..columns.end.min(self.columns.end);
            if seen.is_empty() {
                continue;
            }
            let size = place.kind.bytes_per_sample();
            let start =
                (row * self.bytes_per_pixel + place.before) * columns.len() + (seen.start - columns.start) * size;
            let out = &mut out[seen.start - self.columns.start..][..seen.len()];
            T::load(&bytes[start..][..seen.len() * size], place.kind, out);
        }
    }
}

/// A sample that the bytes of a file are read into.
pub(super) trait Stored: Sample {
    fn load(bytes: &[u8], kind: SampleType, out: &mut [Self]);
}

impl Stored for f16 {
    fn load(bytes: &[u8], _: SampleType, out: &mut [f16]) {
        for (out, bytes) in out.iter_mut().zip(bytes.as_chunks().0) {
            *out = f16::from_ne_bytes(*bytes);
        }
    }
}

impl Stored for f32 {
    fn load(bytes: &[u8], kind: SampleType, out: &mut [f32]) {
        match kind {
            SampleType::F16 => {
                let mut halves = [f16::ZERO; 512];
                for (out, bytes) in out.chunks_mut(512).zip(bytes.chunks(1024)) {
                    let halves = &mut halves[..out.len()];
                    f16::load(bytes, kind, halves);
                    widen(halves, out);
                }
            }
            SampleType::F32 => {
                for (out, bytes) in out.iter_mut().zip(bytes.as_chunks().0) {
                    *out = f32::from_ne_bytes(*bytes);
                }
            }
            SampleType::U32 => {
                for (out, bytes) in out.iter_mut().zip(bytes.as_chunks().0) {
                    *out = u32::from_ne_bytes(*bytes) as f32;
                }
            }
        }
    }
}

/// The compressed chunks of a part, read in order.
struct Source<'a> {
    part: &'a Part<'a>,
    reader: BufReader<File>,
    first_unit: usize,
    offsets: Vec<u64>,
}

impl<'a> Source<'a> {
    fn open(part: &'a Part<'a>, units: Range<usize>) -> Result<Self> {
        let path = &part.file.path;
        let per_unit = part.chunks_per_unit();
        let before: usize = part.file.meta.headers[..part.index].iter().map(|header| header.chunk_count).sum();
        let start = part.file.tables_at + 8 * (before + units.start * per_unit) as u64;
        let count = units.len() * per_unit;
        if start + 8 * count as u64 > part.file.bytes {
            return Err(cut_short(path));
        }
        let mut reader = BufReader::with_capacity(1 << 18, File::open(path).map_err(Error::io(path, "read"))?);
        reader.seek(SeekFrom::Start(start)).map_err(Error::io(path, "read"))?;
        let mut table = vec![0; 8 * count];
        read_whole(&mut reader, &mut table, path)?;
        let offsets = table.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
        Ok(Source { part, reader, first_unit: units.start, offsets })
    }

    fn unit(&mut self, unit: usize) -> Result<Vec<Vec<u8>>> {
        (0..self.part.chunks_per_unit()).map(|i| self.chunk(unit, i)).collect()
    }

    /// Reads one chunk after checking that it says what its place in the table says.
    fn chunk(&mut self, unit: usize, i: usize) -> Result<Vec<u8>> {
        let part = self.part;
        let path = &part.file.path;
        let offset = self.offsets[(unit - self.first_unit) * part.chunks_per_unit() + i];
        if offset == 0 {
            return Err(Error::file(path, "is incomplete: its writer stopped before the last block"));
        }
        if offset < part.file.tables_at || offset >= part.file.bytes {
            return Err(cut_short(path));
        }
        let here = self.reader.stream_position().map_err(Error::io(path, "read"))?;
        self.reader.seek_relative(offset as i64 - here as i64).map_err(Error::io(path, "read"))?;
        let mut expected = Vec::with_capacity(5);
        if part.file.meta.requirements.is_multilayer() {
            expected.push(part.index as i32);
        }
        match part.header.blocks {
            BlockDescription::ScanLines => {
                expected.push((unit * part.lines_per_unit()) as i32 + part.header.own_attributes.layer_position.y());
            }
            BlockDescription::Tiles(_) => expected.extend([i as i32, unit as i32, 0, 0]),
        }
        for expected in expected {
            if self.number()? != expected {
                return Err(Error::file(path, format!("is damaged: block {unit} is not where its table says")));
            }
        }
        let size = self.number()?;
        let limit = part.header.max_block_byte_size().min((part.file.bytes - offset) as usize);
        if size <= 0 || size as usize > limit {
            return Err(Error::file(path, format!("is damaged or cut short: block {unit} claims {size} bytes")));
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

/// Runs the `exr` crate. It indexes by numbers from the file in its rarer codecs, so that a damaged file can make it
/// panic: that is an error of the file too.
fn guarded<T>(path: &Path, work: impl FnOnce() -> exr::error::Result<T>) -> Result<T> {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(exr::error::Error::Io(error))) if error.kind() == ErrorKind::UnexpectedEof => Err(cut_short(path)),
        Ok(Err(exr::error::Error::Io(error))) => Err(Error::io(path, "read")(error)),
        Ok(Err(error)) => Err(Error::file(path, format!("cannot be read as OpenEXR: {error}"))),
        Err(_) => Err(Error::file(path, "is damaged: its pixels cannot be decompressed")),
    }
}

fn read_whole(reader: &mut impl Read, bytes: &mut [u8], path: &Path) -> Result<()> {
    reader.read_exact(bytes).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => cut_short(path),
        _ => Error::io(path, "read")(error),
    })
}

fn cut_short(path: &Path) -> Error {
    Error::file(path, "is cut short: it ends before its picture does")
}
