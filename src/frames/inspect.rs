//! What a frame file holds, told without a configuration.

use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::frames::exr_description::ExrDescription;
use crate::frames::format::{Footage, Format};
use crate::frames::options::{Negative, NonFinite, ReadOptions};
use crate::frames::picture::{Header, Kind};
use crate::light::{Planes, Tally};
use crate::vision::Projection;

/// Bytes of a frame's bands that are looked at in one reading of a spectral file.
const AT_ONCE: usize = 1 << 28;

/// Bands of a large frame that are looked at in one reading.
const FEW: usize = 8;

/// What a file holds.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection {
    pub(crate) file: String,
    pub(crate) format: String,
    /// The size of what is shown, without overscan: an EXR's display window.
    pub width: usize,
    pub height: usize,
    /// `rgb`, `spectral`, or nothing where the channels' names tell neither.
    pub kind: Option<&'static str>,
    /// x, y of red, green, blue and white.
    pub(crate) primaries: Option<[[f64; 2]; 4]>,
    /// Centre, lower and upper limit of each band, nm.
    pub bands_nm: Option<Vec<[f64; 3]>>,
    pub(crate) white_cd_m2: Option<f64>,
    pub(crate) frames_per_second: Option<f64>,
    /// Of a film.
    pub(crate) frames: Option<usize>,
    pub(crate) duration_s: Option<f64>,
    /// Smallest and largest luminance, where it can be told.
    pub luminance_cd_m2: Option<[f64; 2]>,
    /// Smallest and largest finite value of each plane, in the order of the bands or R, G, B,
    /// overscan included.
    pub ranges: Vec<[f64; 2]>,
    pub nan: u64,
    pub infinite: u64,
    pub negative: u64,
    pub(crate) clipped: u64,
    #[serde(flatten)]
    pub exr: Option<ExrDescription>,
    pub notes: Vec<String>,
}

/// For each plane of a frame the factor to its share of the luminance in cd/m2; nothing where that
/// is unknown.
pub(crate) type LuminanceWeights<'a> = &'a dyn Fn(&Header) -> Option<Vec<f64>>;

/// Describes a file of a format.
pub(super) fn inspect(
    format: &Format,
    path: &Path,
    options: &ReadOptions,
    weights: LuminanceWeights,
) -> Result<Inspection> {
    let options =
        ReadOptions { non_finite: NonFinite::Clamp, negative: Negative::Keep, ..options.clone() };
    let picture = match (format.open)(path, &options) {
        Ok(picture) => picture,
        Err(error) => return unrecognised(format, path, error),
    };
    let header = picture.header();
    let (ranges, luminance_cd_m2, tally) = match &header.kind {
        Kind::Rgb(_) => rgb_ranges(&*picture, weights(header))?,
        Kind::Spectral(bands) => band_ranges(&*picture, bands.len(), weights(header))?,
    };
    let Tally { nan, infinite, negative, clipped } = tally;
    let mut bare = bare(path, format.name, header);
    [bare.width, bare.height] = picture.window().size;
    if let Some([starts @ .., end]) = picture.times() {
        (bare.frames, bare.duration_s) = (Some(starts.len()), Some(*end));
    }
    let exr = picture.description();
    Ok(Inspection { ranges, luminance_cd_m2, nan, infinite, negative, clipped, exr, ..bare })
}

/// A description that only knows the size.
fn blank(path: &Path, format: &str, width: usize, height: usize) -> Inspection {
    Inspection {
        file: path.display().to_string(),
        format: format.into(),
        width,
        height,
        kind: None,
        primaries: None,
        bands_nm: None,
        white_cd_m2: None,
        frames_per_second: None,
        frames: None,
        duration_s: None,
        luminance_cd_m2: None,
        ranges: Vec::new(),
        nan: 0,
        infinite: 0,
        negative: 0,
        clipped: 0,
        exr: None,
        notes: Vec::new(),
    }
}

/// What the header alone tells.
fn bare(path: &Path, format: &str, header: &Header) -> Inspection {
    let (kind, primaries, bands_nm) = match &header.kind {
        Kind::Rgb(p) => ("rgb", Some([p.red, p.green, p.blue, p.white]), None),
        Kind::Spectral(bands) => {
            let limits = bands.as_slice().iter().map(|band| [band.centre, band.low, band.high]);
            ("spectral", None, Some(limits.collect()))
        }
    };
    Inspection {
        kind: Some(kind),
        primaries,
        bands_nm,
        white_cd_m2: header.white.map(|white| white.0),
        frames_per_second: header.frames_per_second,
        notes: header.notes.clone(),
        ..blank(path, format, header.width, header.height)
    }
}

/// A file whose channels tell no picture is still described; one that cannot be read is not.
fn unrecognised(format: &Format, path: &Path, error: Error) -> Result<Inspection> {
    let (Error::File { problem, .. }, Some((width, height, exr))) =
        (&error, (format.outline)(path))
    else {
        return Err(error);
    };
    let notes = vec![problem.clone()];
    Ok(Inspection { exr: Some(exr), notes, ..blank(path, format.name, width, height) })
}

type Ranges = (Vec<[f64; 2]>, Option<[f64; 2]>, Tally);

fn rgb_ranges(picture: &dyn Footage, weights: Option<Vec<f64>>) -> Result<Ranges> {
    let frame = picture.read(0, None, None)?;
    let planes = &frame.planes;
    let ranges = (0..3).map(|i| range(planes, |x, y| planes.at(x, y, i))).collect();
    let luminance = weights.map(|weights| {
        range(planes, |x, y| {
            weights.iter().enumerate().map(|(i, weight)| weight * planes.at(x, y, i)).sum()
        })
    });
    Ok((ranges, luminance, frame.tally))
}

/// Reads a few bands at a time, so that a frame is never held whole.
fn band_ranges(picture: &dyn Footage, bands: usize, weights: Option<Vec<f64>>) -> Result<Ranges> {
    let header = picture.header();
    let of_band = size_of::<f32>() * header.width * header.height;
    let at_once = (AT_ONCE / of_band.max(1)).clamp(FEW, bands.max(FEW));
    let mut ranges = Vec::new();
    let mut tally = Tally::default();
    for first in (0..bands).step_by(at_once) {
        let chosen = first..bands.min(first + at_once);
        let rows = chosen.len();
        let read = picture.read(0, Some(&Projection::choice(bands, chosen)), None)?;
        ranges.extend((0..rows).map(|i| range(&read.planes, |x, y| read.planes.at(x, y, i))));
        tally = read.tally;
    }
    let luminance = match weights {
        None => None,
        Some(weights) => {
            let weights = weights.iter().map(|weight| *weight as f32).collect();
            let planes = picture.read(0, Some(&Projection::new(bands, 1, weights)), None)?.planes;
            Some(range(&planes, |x, y| planes.at(x, y, 0)))
        }
    };
    Ok((ranges, luminance, tally))
}

fn range(planes: &Planes, value: impl Fn(usize, usize) -> f64) -> [f64; 2] {
    let pixels = (0..planes.height).flat_map(|y| (0..planes.width).map(move |x| (x, y)));
    pixels.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (x, y)| {
        let value = value(x, y);
        [low.min(value), high.max(value)]
    })
}
