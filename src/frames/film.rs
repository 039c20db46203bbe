//! Films: decoded by `ffmpeg` in a process of its own, to the codes that the stream holds. What the
//! codes mean is worked out here, since ffmpeg's own conversions are off by up to 3.7 %.
//!
//! A film shows a display, not the scene: its light is what a person in front of that display sees.
//! Frames are shown when the film says, at whatever rate. PQ is absolute; other curves need the
//! display's peak (`input.peak_cd_m2`).

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use half::f16;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::frames::displayed::refuse_spectral;
use crate::frames::film_child::Decoder;
use crate::frames::film_probe::{Stream, Told, probe};
use crate::frames::film_yuv::Layout;
use crate::frames::format::{Footage, Format};
use crate::frames::options::ReadOptions;
use crate::frames::picture::{Header, Kind, believable, canvas};
use crate::frames::transfer::{Transfer, coded_primaries, coded_transfer};
use crate::frames::turn::Turn;
use crate::kernel::Curve;
use crate::light::{Frame, Planes, Sample, Samples, Tally};
use crate::units::Nits;
use crate::vision::Projection;

pub(super) static FORMAT: Format = Format {
    name: "film",
    extensions: &["mp4", "mov", "mkv", "webm", "m4v", "y4m"],
    recognise: |_, start| {
        start.get(4..8) == Some(b"ftyp")
            || start.starts_with(&[0x1a, 0x45, 0xdf, 0xa3])
            || start.starts_with(b"YUV4MPEG2")
    },
    open: |path, options| Ok(Box::new(Film::open(path, options)?)),
    outline: |_| None,
};

/// The most bits of codes whose light halves hold: at ten the next code's light is at least .27 %
/// away (BT.1886; PQ .9 %), a half at most .05 %. Where light is below 6e-5 codes lie further apart
/// still.
const BITS_IN_HALVES: u32 = 10;
/// Rows that one thread converts at a time.
const ROWS: usize = 16;

struct Film {
    layout: Layout,
    transfer: Transfer,
    curve: Curve,
    turn: Turn,
    header: Header,
    times: Vec<f64>,
    decoder: Mutex<Decoder>,
}

impl Film {
    fn open(path: &Path, options: &ReadOptions) -> Result<Film> {
        refuse_spectral(path, options)?;
        // A film that is not there, or may not be read, is no fault of ffmpeg's.
        std::fs::File::open(path).map_err(Error::io(path, "read"))?;
        let Told { stream, times, complaints } = probe(path)?;
        let fail = |problem: String| Error::file(path, problem);
        believable(path, (stream.width, stream.height), 1, u64::MAX, options.max_pixels)?;
        let (layout, mut notes) = Layout::of(&stream, options).map_err(fail)?;
        let transfer = transfer(&stream, options).map_err(fail)?;
        let told = || primaries(&stream, &mut notes);
        let primaries = options.primaries.map_or_else(told, Ok).map_err(fail)?;
        let turn = Turn::of_exif(stream.orientation());
        let (width, height) = turn.size(stream.width, stream.height);
        notes.insert(0, format!("a film, decoded by {transfer}: it shows a display, not a scene"));
        notes.extend(oddities(&stream));
        let header = Header {
            white: transfer.white().or(options.peak_cd_m2.map(Nits)),
            transfer: Some(transfer),
            frames_per_second: stream.rate(),
            notes,
            ..Header::new(width, height, Kind::Rgb(primaries))
        };
        let decoder = Decoder::new(path, &layout, times.len() - 1, complaints);
        Ok(Film {
            layout,
            transfer,
            curve: Curve::of(|signal| transfer.light(signal)),
            turn,
            header,
            times,
            decoder: Mutex::new(decoder),
        })
    }

    /// The light of row `y`, as it is stored, and how many of its signals are clipped.
    fn row(&self, codes: &[u8], y: usize, row: &mut [f32], room: &mut Vec<f32>) -> u64 {
        let width = self.layout.width;
        self.layout.signals(codes, y, row, room);
        let reached = self.curve.apply(row);
        if let Transfer::Hlg(_) = self.transfer {
            let (red, rest) = row.split_at_mut(width);
            let (green, blue) = rest.split_at_mut(width);
            for ((r, g), b) in red.iter_mut().zip(green).zip(blue) {
                [*r, *g, *b] = self.transfer.shown([*r, *g, *b]);
            }
        }
        // The light of PQ ends at 10 000 cd/m2, where hardly anything was cut off.
        if self.transfer == Transfer::Pq { 0 } else { reached }
    }

    /// The light of a frame the right way up, and how many of its signals are clipped.
    fn planes<T: Sample>(&self, codes: &[u8], recycled: Option<Planes>) -> (Samples, u64) {
        let length = 3 * self.layout.width;
        let mut planes: Vec<T> = canvas(recycled, length * self.layout.height, true);
        let strips = planes.par_chunks_mut(ROWS * length).enumerate();
        let clipped = strips.map_init(
            || (vec![0.0; length], Vec::new()),
            |(row, room), (strip, rows)| {
                let rows = rows.chunks_exact_mut(length).enumerate();
                rows.fold(0, |clipped, (i, out)| {
                    let more = self.row(codes, strip * ROWS + i, row, room);
                    T::store(row, out);
                    clipped + more
                })
            },
        );
        let clipped = clipped.sum();
        (T::samples(self.turned(planes)), clipped)
    }

    /// The planes the right way up.
    fn turned<T: Sample>(&self, stored: Vec<T>) -> Vec<T> {
        if self.turn == Turn::default() {
            return stored;
        }
        let size = (self.layout.width, self.layout.height);
        let mut planes = vec![T::default(); stored.len()];
        for (row, out) in planes.chunks_exact_mut(self.header.width).enumerate() {
            let (y, plane) = (row / 3, row % 3);
            for (x, out) in out.iter_mut().enumerate() {
                let (column, line) = self.turn.source((x, y), size);
                *out = stored[(line * 3 + plane) * size.0 + column];
            }
        }
        planes
    }
}

/// The curve of a stream: the configuration's, or else its own.
fn transfer(stream: &Stream, options: &ReadOptions) -> Result<Transfer, String> {
    if let Some(transfer) = options.transfer {
        return Ok(transfer);
    }
    let code = match stream.color_transfer.as_deref() {
        Some("bt709") => 1,
        Some("gamma22" | "bt470m") => 4,
        Some("gamma28" | "bt470bg") => 5,
        Some("smpte170m") => 6,
        Some("linear") => 8,
        Some("iec61966-2-1") => 13,
        Some("bt2020-10") => 14,
        Some("bt2020-12") => 15,
        Some("smpte2084") => 16,
        Some("arib-std-b67") => 18,
        found => {
            return Err(format!(
                "has {} transfer curve; say input.transfer: pq, hlg, bt1886 (most films), srgb or \
                 linear",
                found.map_or("no".into(), |found| format!("the unread `{found}`"))
            ));
        }
    };
    coded_transfer(code, options.peak_cd_m2)
}

/// The primaries of a stream; where it does not tell, those of its size, as players take them.
fn primaries(stream: &Stream, notes: &mut Vec<String>) -> Result<crate::colour::Primaries, String> {
    let code = match stream.color_primaries.as_deref() {
        Some("bt709") => 1,
        Some("bt470bg") => 5,
        Some("smpte170m") => 6,
        Some("smpte240m") => 7,
        Some("bt2020") => 9,
        Some("smpte431") => 11,
        Some("smpte432") => 12,
        None | Some("unknown" | "reserved") => {
            notes.push("its primaries are not told: taken as BT.709".into());
            1
        }
        Some(other) => {
            return Err(format!(
                "has the primaries `{other}`; bt709, bt470bg, smpte170m, smpte240m, bt2020, \
                 smpte431 and smpte432 are read. If that is wrong, say input.primaries"
            ));
        }
    };
    coded_primaries(code)
}

/// What is read and yet not as it is meant.
fn oddities(stream: &Stream) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(aspect) = &stream.sample_aspect_ratio
        && !matches!(aspect.as_str(), "1:1" | "0:1" | "N/A")
    {
        notes.push(format!("its pixels are not square ({aspect}); read as square"));
    }
    if matches!(stream.field_order.as_deref(), Some("tt" | "bb" | "tb" | "bt")) {
        notes.push("it is interlaced: read as whole frames".into());
    }
    if stream.pix_fmt.contains("yuva") || stream.pix_fmt.contains("gbrap") {
        notes.push("passed over its alpha".into());
    }
    notes
}

impl Footage for Film {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        self.times.len() - 1
    }

    fn times(&self) -> Option<&[f64]> {
        Some(&self.times)
    }

    fn read(
        &self,
        index: usize,
        _: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame> {
        let mut decoder = self.decoder.lock().unwrap_or_else(PoisonError::into_inner);
        let codes = decoder.frame(index)?;
        // A curve's light is finite and never negative.
        let (samples, clipped) = if self.layout.bits() <= BITS_IN_HALVES {
            self.planes::<f16>(codes, recycled)
        } else {
            self.planes::<f32>(codes, recycled)
        };
        drop(decoder);
        let (width, height) = (self.header.width, self.header.height);
        let tally = Tally { clipped, ..Tally::default() };
        Ok(Frame { planes: Planes { width, height, count: 3, samples }, tally })
    }
}
