//! ENVI pictures: raw spectral samples beside a text header, read and projected by blocks of rows.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::iter::{ParallelBridge, ParallelIterator};

use crate::error::{Error, Result};
use crate::frames::census::{Census, Mending, verdict};
use crate::frames::envi_header::{EnviHeader, Interleave, Stored, parse};
use crate::frames::exr_picture::canvas;
use crate::frames::footage::{DENSEST, Picture, believable};
use crate::frames::{Header, Kind, Quantity, ReadOptions, Wanted};
use crate::light::{Frame, Planes, Samples};
use crate::spectrum::Bands;
use crate::vision::Projection;

/// Headers beyond this are no headers, bytes.
const LONGEST_HEADER: u64 = 1 << 24;
/// Bytes of samples that are read and projected together.
const BLOCK: usize = 1 << 21;

pub(super) struct EnviPicture {
    pub envi: EnviHeader,
    data: PathBuf,
    /// Bands of the file in order of wavelength.
    order: Vec<usize>,
    scale: Vec<f64>,
    header: Header,
    options: ReadOptions,
}

impl EnviPicture {
    /// Opens a picture by its header or by its data file.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<EnviPicture> {
        if options.wanted == Wanted::Rgb {
            return Err(Error::file(path, "is an ENVI picture, spectral; `kind` asks for rgb"));
        }
        let (text, data) = pair(path)?;
        let bytes = File::open(&text).map_err(Error::io(&text, "read"))?;
        let mut head = Vec::new();
        bytes.take(LONGEST_HEADER).read_to_end(&mut head).map_err(Error::io(&text, "read"))?;
        let fail = |problem: String| Error::file(&text, problem);
        let mut envi = parse(&String::from_utf8_lossy(&head)).map_err(fail)?;
        let (bands, order) = bands(&envi).map_err(fail)?;
        let scale = scales(&envi, &bands, &order, options);
        let pixel_bytes = envi.stored.bytes() * order.len();
        believable(&data, (envi.samples, envi.lines), pixel_bytes, DENSEST, options.max_pixels)?;
        let length = std::fs::metadata(&data).map_err(Error::io(&data, "read"))?.len();
        let needed = (envi.samples as u64 * envi.lines as u64)
            .checked_mul(pixel_bytes as u64)
            .and_then(|bytes| bytes.checked_add(envi.offset));
        if needed.is_none_or(|needed| needed > length) {
            let size = format!("{} x {} x {}", envi.samples, envi.lines, order.len());
            return Err(Error::file(
                &data,
                format!("is cut short: {length} bytes do not hold {size} samples"),
            ));
        }
        let notes = std::mem::take(&mut envi.notes);
        let (width, height) = (envi.samples, envi.lines);
        let kind = Kind::Spectral(bands);
        let header = Header { width, height, kind, white: None, frames_per_second: None, notes };
        Ok(EnviPicture { envi, data, order, scale, header, options: options.clone() })
    }

    fn project(
        &self,
        projection: &Projection,
        sums: &mut [f32],
        mending: Mending,
    ) -> Result<Census> {
        let width = self.envi.samples;
        let row_bytes = width * self.order.len() * self.envi.stored.bytes();
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
        let (envi, bands) = (&self.envi, self.order.len());
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
        let (width, bands) = (self.envi.samples, self.order.len());
        let (first, step) = match self.envi.interleave {
            Interleave::Bsq => ((band * lines + i) * width, 1),
            Interleave::Bil => ((i * bands + band) * width, 1),
            Interleave::Bip => (i * width * bands + band, bands),
        };
        let size = self.envi.stored.bytes();
        let samples = bytes[first * size..].chunks_exact(size).step_by(step);
        for (out, sample) in out.iter_mut().zip(samples) {
            let value = number(sample, self.envi.stored, self.envi.big_endian);
            *out = if self.envi.ignores(value) { 0.0 } else { value as f32 };
        }
    }
}

impl Picture for EnviPicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn decode(&self, projection: Option<&Projection>, recycled: Option<Planes>) -> Result<Frame> {
        let bands: Vec<usize> = (0..self.order.len()).collect();
        let every = Projection::identity(bands.len());
        let projection = projection.unwrap_or(&every).reordered(&bands, &self.scale);
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

/// Bands in order of wavelength. They tile the spectrum between their centres: under gaps between
/// the widths told by `fwhm`, and under overlaps, the light of a pixel would come out too small or
/// too large.
fn bands(envi: &EnviHeader) -> Result<(Bands, Vec<usize>), String> {
    let mut order: Vec<usize> = (0..envi.wavelengths.len()).collect();
    order.sort_by(|&a, &b| envi.wavelengths[a].total_cmp(&envi.wavelengths[b]));
    let centres: Vec<f64> = order.iter().map(|&band| envi.wavelengths[band]).collect();
    let bands = Bands::from_centres(&centres)
        .ok_or("has wavelengths that are not positive, or two that are equal")?;
    Ok((bands, order))
}

/// Factors to W m^-2 sr^-1 nm^-1. A band integral is divided by the width it was gathered over.
fn scales(envi: &EnviHeader, bands: &Bands, order: &[usize], options: &ReadOptions) -> Vec<f64> {
    let width = |(i, &band): (usize, &usize)| match (options.quantity, envi.fwhm.get(band)) {
        (Quantity::Density, _) => 1.0,
        (Quantity::BandIntegral, Some(&fwhm)) if fwhm > 0.0 => fwhm,
        (Quantity::BandIntegral, _) => bands.as_slice()[i].width(),
    };
    order.iter().enumerate().map(|place| options.scale / envi.divisor / width(place)).collect()
}

fn number(bytes: &[u8], stored: Stored, big_endian: bool) -> f64 {
    let mut raw = [0; 8];
    raw[..bytes.len()].copy_from_slice(bytes);
    if big_endian {
        raw[..bytes.len()].reverse();
    }
    let [a, b, c, d, ..] = raw;
    match stored {
        Stored::I16 => i16::from_le_bytes([a, b]).into(),
        Stored::U16 => u16::from_le_bytes([a, b]).into(),
        Stored::F32 => f32::from_le_bytes([a, b, c, d]).into(),
        Stored::F64 => f64::from_le_bytes(raw),
    }
}

/// The header and the data of a picture, given either.
fn pair(path: &Path) -> Result<(PathBuf, PathBuf)> {
    let is_header = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("hdr"));
    let mut beside: Vec<PathBuf> = Vec::new();
    if is_header {
        beside.extend(
            ["img", "dat", "raw", "bsq", "bil", "bip", ""]
                .map(|extension| path.with_extension(extension)),
        );
    } else {
        let appended = PathBuf::from(format!("{}.hdr", path.display()));
        beside.extend([path.with_extension("hdr"), appended]);
    }
    let found = beside.iter().find(|beside| beside.is_file()).cloned().ok_or_else(|| {
        let names: Vec<String> = beside.iter().map(|beside| beside.display().to_string()).collect();
        let part = if is_header { "data" } else { "an ENVI header" };
        Error::file(path, format!("has no {part} beside it; looked for {}", names.join(", ")))
    })?;
    Ok(if is_header { (path.to_owned(), found) } else { (found, path.to_owned()) })
}
