//! A plate: an OpenEXR frame with everything that it carries, written again in other colours.
//!
//! Alpha, the other channels and layers of the picture's part, every attribute as bytes, both
//! windows and whole other parts pass untouched. Other parts are copied chunk by chunk as they are
//! compressed; the picture's own part is decoded and encoded again in bands of rows. Nothing is
//! held beyond one band, and of a plate with nothing but colours only the header is read again.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;
use exr_blocks::chunks::{Layout, Writer};
use exr_blocks::header::Headers;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::frames::atomic::{Sink, write_whole};
use crate::frames::exr_file::Part;
use crate::frames::exr_picture::ExrPicture;
use crate::frames::plate_channels::{Carried, Colours, channels};
use crate::frames::plate_header::{headers, part_header};
use crate::frames::written::{About, Compression, packed, write_exr};
use crate::light::Planes;

/// Rows that are decoded and encoded together: a multiple of every block's.
const BAND: usize = 512;

/// A frame that can be written again.
pub struct Plate {
    pub(super) picture: ExrPicture,
    /// The factor from its own numbers to those of the footage.
    pub(super) gain: f32,
}

/// Writes the percept of a frame: the frame's plate in these colours where it is one, else R, G and
/// B alone.
pub fn write_percept(
    path: &Path,
    planes: &Planes,
    compression: Compression,
    about: &About,
    plate: Option<&Plate>,
) -> Result<()> {
    match plate {
        Some(plate) => plate.write(path, planes, compression, about),
        None => write_exr(path, &["R", "G", "B"], planes, compression, about),
    }
}

impl Plate {
    /// Writes the plate with `planes` as its colours where they cover its data window. Beyond them
    /// its own stay.
    fn write(
        &self,
        path: &Path,
        planes: &Planes,
        compression: Compression,
        about: &About,
    ) -> Result<()> {
        let file = &self.picture.file;
        let canvas = self.picture.part()?;
        if (planes.width, planes.height) != (canvas.width(), canvas.height()) {
            return Err(Error::file(&file.path, "has another size than when it was read"));
        }
        let sheet = self.sheet(canvas, planes, compression, about);
        let reread = || {
            let mut reader = BufReader::new(File::open(&file.path)?);
            Headers::read(&mut reader).map(|headers| (headers, reader))
        };
        let (source, reader) = reread().map_err(Error::io(&file.path, "read"))?;
        let headers = headers(&self.picture, source, &sheet.header);
        write_whole(path, |sink| self.write_parts(&sheet, &headers, reader, sink))
    }

    /// The picture's part in new colours.
    fn sheet<'a>(
        &self,
        canvas: Part<'a>,
        planes: &'a Planes,
        compression: Compression,
        about: &About,
    ) -> Sheet<'a> {
        let channels = channels(&self.picture);
        let header = part_header(&self.picture, &channels, compression, about);
        let colours = Colours { planes, window: canvas.window, gain: self.gain };
        Sheet { colours, canvas, channels, header, compression }
    }

    /// Writes all parts, of which one is new.
    fn write_parts(
        &self,
        sheet: &Sheet,
        headers: &Headers,
        mut reader: BufReader<File>,
        sink: &mut dyn Sink,
    ) -> io::Result<()> {
        let parts = &self.picture.file.meta.headers;
        let mut counts: Vec<usize> = parts.iter().map(|part| part.chunk_count).collect();
        counts[self.picture.part] = sheet.header.chunk_count;
        let mut out = Writer::begin(sink, headers, counts)?;
        for part in 0..headers.parts.len() {
            if part == self.picture.part {
                sheet.encode(&mut |y, block| out.scan_lines(part, y, block))?;
            } else {
                self.copy(part, &mut reader, &mut out)?;
            }
        }
        out.end()
    }

    /// Copies another part as it is.
    fn copy(
        &self,
        part: usize,
        reader: &mut BufReader<File>,
        out: &mut Writer<&mut dyn Sink>,
    ) -> io::Result<()> {
        let file = &self.picture.file;
        let header = &file.meta.headers[part];
        let tiled = matches!(header.blocks, BlockDescription::Tiles(_));
        let layout = Layout { tiled, deep: header.deep };
        let before: usize = file.meta.headers[..part].iter().map(|part| part.chunk_count).sum();
        reader.seek(SeekFrom::Start(file.tables_at + 8 * before as u64))?;
        let mut table = Vec::new();
        reader.take(8 * header.chunk_count as u64).read_to_end(&mut table)?;
        for offset in table.as_chunks().0 {
            out.copy(part, layout, reader, u64::from_le_bytes(*offset))?;
        }
        Ok(())
    }
}

/// The part of the picture as it is written.
struct Sheet<'a> {
    colours: Colours<'a>,
    /// The picture as the eye saw it.
    canvas: Part<'a>,
    channels: Vec<Carried>,
    header: Header,
    compression: Compression,
}

impl Sheet<'_> {
    /// Encodes the part in order of its blocks.
    fn encode(&self, sink: &mut dyn FnMut(i32, &[u8]) -> io::Result<()>) -> io::Result<()> {
        let data = self.header.data_window();
        let lines = self.header.compression.scan_lines_per_block();
        let row_length = data.size.width() * self.header.channels.bytes_per_pixel;
        for top in (0..data.size.height()).step_by(BAND) {
            let rows = BAND.min(data.size.height() - top);
            let corner = Vec2(data.position.x(), data.position.y() + top as i32);
            let band = IntegerBounds::new(corner, Vec2(data.size.width(), rows));
            let bytes = self.band(band, row_length).map_err(io::Error::other)?;
            let encode = |(i, block): (usize, &[u8])| {
                let first = top + i * lines;
                let rows = first..first + block.len() / row_length;
                packed(block.to_vec(), &self.header, self.compression, rows)
            };
            let blocks = bytes.par_chunks(lines * row_length).enumerate().map(encode);
            let blocks: Vec<Vec<u8>> =
                blocks.collect::<Result<_, _>>().map_err(io::Error::other)?;
            for (i, block) in blocks.iter().enumerate() {
                sink(corner.y() + (i * lines) as i32, block)?;
            }
        }
        Ok(())
    }

    /// The bytes of some rows of the data window.
    fn band(&self, window: IntegerBounds, row_length: usize) -> Result<Vec<u8>> {
        let mut bytes = vec![0; window.size.height() * row_length];
        let width = window.size.width();
        if !self.colours.are_all_of(&self.channels, self.header.data_window()) {
            let part = Part { window, ..self.canvas };
            part.decode(&mut bytes, row_length, |rows, out, room| {
                for ((i, _), out) in rows.rows().zip(out.chunks_exact_mut(row_length)) {
                    let mut rest = out;
                    for channel in &self.channels {
                        channel.carry(rows, i, channel.take(&mut rest, width), room);
                    }
                }
            })?;
        }
        let rows = bytes.par_chunks_mut(row_length).enumerate();
        rows.for_each_init(Vec::new, |room, (i, out)| {
            let mut rest = out;
            for channel in &self.channels {
                let out = channel.take(&mut rest, width);
                let corner = (window.position.x(), window.position.y() + i as i32);
                self.colours.fill(channel, corner, out, room);
            }
        });
        Ok(bytes)
    }
}
