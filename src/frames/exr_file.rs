//! One OpenEXR file: its headers, and its pixels decoded one block of rows at a time.
//!
//! Compressed blocks are read in the file's order by whichever thread is free and decompressed in
//! the current rayon pool; a frame is never held but in the planes that it ends in. The `exr` crate
//! reads headers and decompresses; its own parallel reader would build a pool per file.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::ops::Range;
use std::path::{Path, PathBuf};

use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers, MetaData};

use crate::error::{Error, Result};
use crate::frames::exr_description::text;
use crate::frames::exr_rows::Place;
use crate::frames::options::Overscan;
use crate::frames::picture::{DENSEST, believable};

/// [`DENSEST`] for DWA, which packs 22 000 bytes of such a frame into one.
const DENSEST_DWA: u64 = 65_536;

/// A file whose headers were read.
pub(super) struct ExrFile {
    pub(crate) path: PathBuf,
    pub(crate) meta: MetaData,
    /// Length of the file.
    pub(crate) bytes: u64,
    /// Where the tables of offsets begin.
    pub(crate) tables_at: u64,
}

impl ExrFile {
    /// Reads and checks the headers.
    pub(super) fn open(path: &Path) -> Result<ExrFile> {
        let file = File::open(path).map_err(Error::io(path, "read"))?;
        let bytes = file.metadata().map_err(Error::io(path, "read"))?.len();
        if bytes == 0 {
            return Err(Error::file(path, "is empty"));
        }
        let mut reader = BufReader::new(file);
        let meta = guarded(path, || {
            let meta = MetaData::read_from_buffered(reader.by_ref(), false)?;
            MetaData::validate(&flat(&meta), false)?;
            Ok(meta)
        })?;
        let tables_at = reader.stream_position().map_err(Error::io(path, "read"))?;
        Ok(ExrFile { path: path.to_owned(), meta, bytes, tables_at })
    }

    /// The picture of one part in its display window, once its declared size has been found
    /// believable.
    pub(super) fn part(&self, index: usize, max_pixels: u64) -> Result<Part<'_>> {
        let header = &self.meta.headers[index];
        let display = header.shared_attributes.display_window;
        let dwa = matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
        let densest = if dwa { DENSEST_DWA } else { DENSEST };
        for size in [display.size, header.layer_size] {
            let pixel_bytes = header.channels.bytes_per_pixel;
            believable(
                &self.path,
                (size.width(), size.height()),
                pixel_bytes,
                densest,
                max_pixels,
            )?;
        }
        sampling_is_sound(header).map_err(|problem| Error::file(&self.path, problem))?;
        Ok(Part { file: self, index, header, window: display })
    }
}

/// The flat parts, as the `exr` crate can check them: it refuses deep and subsampled ones.
fn flat(meta: &MetaData) -> Headers {
    let mut headers: Headers = meta.headers.iter().filter(|part| !part.deep).cloned().collect();
    let channels = headers.iter_mut().flat_map(|header| &mut header.channels.list);
    channels.for_each(|channel| channel.sampling = Vec2(1, 1));
    headers
}

/// Checks that the data window has whole samples of every channel, as the format asks.
fn sampling_is_sound(header: &Header) -> Result<(), String> {
    if header.deep {
        return Err("holds deep data; flat parts are read".into());
    }
    let (at, size) = (header.own_attributes.layer_position, header.layer_size);
    let tiled = !matches!(header.blocks, BlockDescription::ScanLines);
    let whole = |sampling: usize, at: i32, size: usize| {
        let possible = (1..=1 << 15).contains(&sampling);
        possible && at % sampling as i32 == 0 && size.is_multiple_of(sampling)
    };
    let unsound = header.channels.list.iter().find(|channel| {
        let Vec2(x, y) = channel.sampling;
        let whole = whole(x, at.x(), size.width()) && whole(y, at.y(), size.height());
        !whole || (tiled && channel.sampling != Vec2(1, 1))
    });
    unsound.map_or(Ok(()), |channel| {
        let Vec2(x, y) = channel.sampling;
        Err(format!(
            "is damaged: channel `{}` is sampled {x} x {y}, which does not divide its window",
            text(&channel.name).escape_debug()
        ))
    })
}

/// The picture of one part, as far as a window shows it.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    pub(crate) file: &'a ExrFile,
    pub(crate) index: usize,
    pub(crate) header: &'a Header,
    /// What is read: pixels in it that have no data are left as they are.
    pub(crate) window: IntegerBounds,
}

impl Part<'_> {
    pub(super) fn width(&self) -> usize {
        self.window.size.width()
    }

    pub(super) fn height(&self) -> usize {
        self.window.size.height()
    }

    /// Where the samples of a channel lie.
    pub(super) fn place(&self, channel: usize) -> Place {
        Place::of(&self.header.channels, channel)
    }

    /// The display window, and what is wanted beyond it. A data window that does not meet the
    /// display window is no overscan of it.
    pub(super) fn canvas(&self, overscan: Overscan) -> IntegerBounds {
        let (display, data) = (self.window, self.header.data_window());
        let (columns, rows) = self.seen();
        let [left, top, right, bottom] = match overscan {
            Overscan::Margins(margins) => margins,
            Overscan::OfFirst if !(columns.is_empty() || rows.is_empty()) => {
                let beyond = |a: i32, b: i32| (i64::from(b) - i64::from(a)).max(0) as usize;
                [
                    beyond(data.position.x(), display.position.x()),
                    beyond(data.position.y(), display.position.y()),
                    beyond(display.end().x(), data.end().x()),
                    beyond(display.end().y(), data.end().y()),
                ]
            }
            _ => [0; 4],
        };
        let (Vec2(x, y), Vec2(width, height)) = (display.position, display.size);
        let corner = Vec2(x.saturating_sub(left as i32), y.saturating_sub(top as i32));
        IntegerBounds::new(corner, Vec2(left + width + right, top + height + bottom))
    }

    /// Whether every pixel of the window has data.
    pub(super) fn covers_window(&self) -> bool {
        let (columns, rows) = self.seen();
        columns.len() == self.width() && rows.len() == self.height()
    }

    /// Rows that are decompressed together: a block of scan lines, or a row of tiles.
    pub(super) fn lines_per_unit(&self) -> usize {
        self.header.max_block_pixel_size().height()
    }

    /// Blocks that hold them.
    pub(super) fn chunks_per_unit(&self) -> usize {
        match self.header.blocks {
            BlockDescription::ScanLines => 1,
            BlockDescription::Tiles(tiles) => {
                self.header.layer_size.width().div_ceil(tiles.tile_size.width())
            }
        }
    }

    /// The numbers that chunk `i` of a unit begins with in the file: part, then first line or tile
    /// and level.
    pub(super) fn marks(&self, unit: usize, i: usize) -> Vec<i32> {
        let mut marks = Vec::with_capacity(5);
        if self.file.meta.requirements.is_multilayer() {
            marks.push(self.index as i32);
        }
        match self.header.blocks {
            BlockDescription::ScanLines => {
                marks.push(
                    (unit * self.lines_per_unit()) as i32
                        + self.header.own_attributes.layer_position.y(),
                );
            }
            BlockDescription::Tiles(_) => marks.extend([i as i32, unit as i32, 0, 0]),
        }
        marks
    }

    /// Where the data window stands in the window.
    pub(super) fn offset(&self) -> (i64, i64) {
        let (data, window) = (self.header.own_attributes.layer_position, self.window.position);
        let apart = |a: i32, b: i32| i64::from(a) - i64::from(b);
        (apart(data.x(), window.x()), apart(data.y(), window.y()))
    }

    /// Columns and rows of the data window that lie in the window.
    pub(super) fn seen(&self) -> (Range<usize>, Range<usize>) {
        let overlap = |offset: i64, data: usize, display: usize| {
            let end = (display as i64 - offset).clamp(0, data as i64) as usize;
            ((-offset).clamp(0, end as i64) as usize)..end
        };
        let (dx, dy) = self.offset();
        let size = self.header.layer_size;
        (overlap(dx, size.width(), self.width()), overlap(dy, size.height(), self.height()))
    }
}

/// Runs the `exr` crate. None of 400 000 damaged files made it panic, but its codecs index by
/// numbers from the file: should one ever, that is an error of the file and not the end of a run of
/// hours.
pub(super) fn guarded<T>(path: &Path, work: impl FnOnce() -> exr::error::Result<T>) -> Result<T> {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(exr::error::Error::Invalid(problem))) if problem == "reference to missing bytes" => {
            Err(cut_short(path))
        }
        Ok(Err(exr::error::Error::Io(error))) => Err(Error::io(path, "read")(error)),
        Ok(Err(error)) => Err(Error::file(path, format!("cannot be read as OpenEXR: {error}"))),
        Err(_) => Err(Error::file(path, "is damaged: its pixels cannot be decompressed")),
    }
}

pub(super) fn cut_short(path: &Path) -> Error {
    Error::file(path, "is cut short: it ends before its picture does")
}
