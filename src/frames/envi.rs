//! ENVI pictures: raw spectral samples beside a text header, read and projected by blocks of rows.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::iter::{ParallelBridge, ParallelIterator};

use crate::error::{Error, Result};
use crate::frames::census::{Census, Mending, verdict};
use crate::frames::envi_header::{EnviHeader, Interleave, Stored, parse};
use crate::frames::envi_pair::{has_header, is_header, pair};
use crate::frames::format::{Footage, Format};
use crate::frames::options::{Quantity, ReadOptions, Wanted};
use crate::frames::picture::{DENSEST, Header, Kind, believable, canvas};
use crate::frames::visible;
use crate::light::{Frame, Planes, Samples};
use crate::spectrum::Bands;
use crate::vision::Projection;

/// Headers beyond this are no headers, bytes.
const LONGEST_HEADER: u64 = 1 << 24;
/// Bytes of samples that are read and projected together.
const BLOCK: usize = 1 << 21;

pub(super) static FORMAT: Format = Format {
    name: "ENVI",
    extensions: &["hdr", "img", "raw", "dat", "bsq", "bil", "bip"],
    recognise: |path, start| is_header(start) || has_header(path),
    open: |path, options| Ok(Box::new(EnviPicture::open(path, options)?)),
    outline: |_| None,
};

struct EnviPicture {
    envi: EnviHeader,
    data: PathBuf,
    /// Bands of the file in order of wavelength.
    order: Vec<usize>,
    scale: Vec<f64>,
    header: Header,
    options: ReadOptions,
}

impl EnviPicture {
    /// Opens a picture by its header or by its data file.
    fn open(path: &Path, options: &ReadOptions) -> Result<EnviPicture> {
        if options.wanted == Wanted::Rgb {
            return Err(Error::file(path, "is an ENVI picture, spectral; `kind` asks for rgb"));
        }
        let (text, data) = pair(path)?;
        let fail = |problem: String| Error::file(&text, problem);
        let mut envi = parse(&header_text(&text)?).map_err(fail)?;
        let (width, height) = (envi.samples, envi.lines);
        let pixel_bytes = envi.stored.bytes().saturating_mul(envi.bands);
        believable(&data, (width, height), pixel_bytes, DENSEST, options.max_pixels)?;
        holds(&data, &envi)?;
        let (bands, order) = bands(&envi).map_err(fail)?;
        let scale = scales(&envi, &bands, &order, options);
        let mut notes = std::mem::take(&mut envi.notes);
        notes.extend(visible::examine(&bands).map_err(fail)?);
        let header = Header { notes, ..Header::new(width, height, Kind::Spectral(bands)) };
        Ok(EnviPicture { envi, data, order, scale, header, options: options.clone() })
    }

    fn project(
        &self,
        projection: &Projection,
        sums: &mut [f32],
        mending: Mending,
    ) -> Result<Census> {
        let width = self.envi.samples;
        let row_bytes = width * self.envi.bands * self.envi.stored.bytes();
        let rows = (BLOCK / row_bytes).clamp(1, self.envi.lines);
        let mut file = BufReader::with_capacity(
            1 << 16,
            File::open(&self.data).map_err(Error::io(&self.data, "read"))?,
        );
        let blocks = sums.chunks_mut(rows * width * projection.rows).enumerate().map(|(i, out)| {
            let lines = i * rows..self.envi.lines.min((i + 1) * rows);
            (lines.clone(), self.read(&mut file, lines), out)
        });
        let counts: Vec<Result<Census>> = blocks
            .par_bridge()
            .map_init(Vec::new, |row: &mut Vec<f32>, (lines, bytes, out)| {
                let (bytes, mut census) = (bytes?, Census::default());
                row.resize(width * self.order.len(), 0.0);
                for (i, y) in lines.clone().enumerate() {
                    for (band, samples) in row.chunks_exact_mut(width).enumerate() {
                        self.fetch(&bytes, lines.len(), i, self.order[band], samples);
                        census.admit(samples, band, (0, y), mending);
                    }
                    projection.remember(y, 0, row);
                    projection.project(
                        row,
                        &mut out[i * projection.rows * width..][..projection.rows * width],
                    );
                }
                Ok(census)
            })
            .collect();
        counts.into_iter().try_fold(Census::default(), |sum, census| Ok(sum.plus(census?)))
    }

    /// The bytes of some lines: as they stand, or band after band where the file is.
    fn read(&self, file: &mut BufReader<File>, lines: Range<usize>) -> Result<Vec<u8>> {
        let (envi, bands) = (&self.envi, self.envi.bands);
        let line = envi.samples * envi.stored.bytes();
        let mut bytes = vec![0; lines.len() * line * bands];
        let mut fill = |start: usize, bytes: &mut [u8]| {
            file.seek(SeekFrom::Start(envi.offset + start as u64))?;
            file.read_exact(bytes)
        };
        let read = match envi.interleave {
            Interleave::Bsq => bytes.chunks_exact_mut(lines.len() * line).enumerate().try_for_each(
                |(band, bytes)| fill((band * envi.lines + lines.start) * line, bytes),
            ),
            Interleave::Bil | Interleave::Bip => fill(lines.start * line * bands, &mut bytes),
        };
        read.map_err(Error::io(&self.data, "read"))?;
        Ok(bytes)
    }

    /// The samples of a band in the `i`th of `lines` lines.
    fn fetch(&self, bytes: &[u8], lines: usize, i: usize, band: usize, out: &mut [f32]) {
        let (width, bands) = (self.envi.samples, self.envi.bands);
        let (gain, offset) = self.envi.gain(band);
        let (first, step) = match self.envi.interleave {
            Interleave::Bsq => ((band * lines + i) * width, 1),
            Interleave::Bil => ((i * bands + band) * width, 1),
            Interleave::Bip => (i * width * bands + band, bands),
        };
        let size = self.envi.stored.bytes();
        let samples = bytes[first * size..].chunks_exact(size).step_by(step);
        for (out, sample) in out.iter_mut().zip(samples) {
            let value = number(sample, self.envi.stored, self.envi.big_endian);
            *out = if self.envi.ignores(value) { 0.0 } else { (value * gain + offset) as f32 };
        }
    }
}

impl Footage for EnviPicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(
        &self,
        _: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame> {
        let bands: Vec<usize> = (0..self.order.len()).collect();
        let projection = match projection {
            Some(projection) => projection.reordered(&bands, &self.scale),
            None => Projection::identity(bands.len()).reordered(&bands, &self.scale),
        };
        let (width, height, count) = (self.envi.samples, self.envi.lines, projection.rows);
        let mut sums: Vec<f32> = canvas(recycled, width * height * count, true);
        let mending = Mending::first(&self.options);
        let census = self.project(&projection, &mut sums, mending)?;
        let channel = |plane: usize| format!("of band {}", self.order[plane] + 1);
        let again = verdict(&census, self.options.non_finite, channel);
        if again.map_err(|problem| Error::file(&self.data, problem))? {
            self.project(&projection, &mut sums, mending.second(&census))?;
        }
        Ok(Frame {
            planes: Planes { width, height, count, samples: Samples::Float(sums) },
            tally: census.tally,
        })
    }
}

/// A header's text: UTF-8 where it is that, else Latin-1.
fn header_text(path: &Path) -> Result<String> {
    let file = File::open(path).map_err(Error::io(path, "read"))?;
    let mut bytes = Vec::new();
    file.take(LONGEST_HEADER).read_to_end(&mut bytes).map_err(Error::io(path, "read"))?;
    let text = String::from_utf8(bytes);
    Ok(text.unwrap_or_else(|other| other.as_bytes().iter().map(|&byte| char::from(byte)).collect()))
}

/// Refuses data that are shorter than their header says.
fn holds(data: &Path, envi: &EnviHeader) -> Result<()> {
    let length = std::fs::metadata(data).map_err(Error::io(data, "read"))?.len();
    let sizes = [envi.samples, envi.lines, envi.bands, envi.stored.bytes()];
    let needed = sizes.iter().try_fold(1u64, |product, &size| product.checked_mul(size as u64));
    let needed = needed.and_then(|needed| needed.checked_add(envi.offset));
    if needed.is_none_or(|needed| needed > length) {
        let size = format!("{} x {} x {}", envi.samples, envi.lines, envi.bands);
        let problem = format!("is cut short: {length} bytes do not hold {size} samples");
        return Err(Error::file(data, problem));
    }
    Ok(())
}

/// Good bands in order of wavelength. They tile the spectrum between their centres: under gaps
/// between the widths told by `fwhm`, and under overlaps, the light of a pixel would come out too
/// small or too large. So the light of a bad band that was left out is that of its neighbours.
fn bands(envi: &EnviHeader) -> Result<(Bands, Vec<usize>), String> {
    let mut order: Vec<usize> = (0..envi.bands).filter(|&band| envi.is_good(band)).collect();
    order.sort_by(|&a, &b| envi.wavelengths[a].total_cmp(&envi.wavelengths[b]));
    let centres: Vec<f64> = order.iter().map(|&band| envi.wavelengths[band]).collect();
    let bands = Bands::from_centres(&centres)
        .ok_or("has wavelengths that are not positive, or two that are equal, or no good band")?;
    Ok((bands, order))
}

/// Factors to W m^-2 sr^-1 nm^-1. A band integral is divided by the width it was gathered over.
fn scales(envi: &EnviHeader, bands: &Bands, order: &[usize], options: &ReadOptions) -> Vec<f64> {
    let width = |(i, &band): (usize, &usize)| match (options.quantity, envi.fwhm.get(band)) {
        (Quantity::Density, _) => 1.0,
        (Quantity::BandIntegral, Some(&fwhm)) if fwhm > 0.0 => fwhm,
        (Quantity::BandIntegral, _) => bands.as_slice()[i].width(),
    };
    order.iter().enumerate().map(|place| options.scale / width(place)).collect()
}

fn number(bytes: &[u8], stored: Stored, big_endian: bool) -> f64 {
    let mut raw = [0; 8];
    raw[..bytes.len()].copy_from_slice(bytes);
    if big_endian {
        raw[..bytes.len()].reverse();
    }
    let [a, b, c, d, ..] = raw;
    match stored {
        Stored::U8 => a.into(),
        Stored::I32 => i32::from_le_bytes([a, b, c, d]).into(),
        Stored::U32 => u32::from_le_bytes([a, b, c, d]).into(),
        Stored::I16 => i16::from_le_bytes([a, b]).into(),
        Stored::U16 => u16::from_le_bytes([a, b]).into(),
        Stored::F32 => f32::from_le_bytes([a, b, c, d]).into(),
        Stored::F64 => f64::from_le_bytes(raw),
    }
}
