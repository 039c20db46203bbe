//! Footage made of files, one frame each, of whatever formats: each file says in its header what it
//! is, and every one after the first is held to what the first one said.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::frames::census::{Census, Mending, verdict};
use crate::frames::displayed::DisplayedPicture;
use crate::frames::envi::EnviPicture;
use crate::frames::exr_picture::ExrPicture;
use crate::frames::plate::Plate;
use crate::frames::radiance::RadiancePicture;
use crate::frames::{Footage, Header, Kind, ReadOptions};
use crate::light::{Frame, Planes, Samples};
use crate::vision::Projection;

/// A picture file whose header was read.
pub(super) trait Picture: Send + Sync {
    fn header(&self) -> &Header;
    /// Decodes the pixels; without a projection a spectral picture keeps every band.
    fn decode(&self, projection: Option<&Projection>, recycled: Option<Planes>) -> Result<Frame>;
}

/// The extensions that are read.
const EXTENSIONS: &str = ".exr, .hdr and .pic (Radiance), .png, .jpg, and ENVI (.hdr beside .img, .raw, .dat, .bsq, .bil or .bip)";

/// What a file is, by its extension and, for the two formats that share `.hdr`, its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    OpenExr,
    Radiance,
    Displayed,
    Envi,
}

/// Tells the format of a file.
pub(super) fn format(path: &Path) -> Result<Format> {
    let extension =
        path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("exr") => Ok(Format::OpenExr),
        Some("pic") => Ok(Format::Radiance),
        Some("png" | "jpg" | "jpeg") => Ok(Format::Displayed),
        Some("img" | "raw" | "dat" | "bsq" | "bil" | "bip") => Ok(Format::Envi),
        Some("hdr") => {
            let mut start = Vec::new();
            let file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
            file.take(4).read_to_end(&mut start).map_err(Error::io(path, "read"))?;
            Ok(if start == b"ENVI" { Format::Envi } else { Format::Radiance })
        }
        _ => Err(Error::file(path, format!("is of no known format; read are {EXTENSIONS}"))),
    }
}

/// Opens a picture.
pub(super) fn picture(path: &Path, options: &ReadOptions) -> Result<Box<dyn Picture>> {
    Ok(match format(path)? {
        Format::OpenExr => Box::new(ExrPicture::open(path, options)?),
        Format::Radiance => Box::new(RadiancePicture::open(path, options)?),
        Format::Displayed => Box::new(DisplayedPicture::open(path, options)?),
        Format::Envi => Box::new(EnviPicture::open(path, options)?),
    })
}

/// More uncompressed bytes than this for each byte of a file is no picture. Measured on black
/// frames of 3840 x 2160: PXR24 packs 1250 bytes of floats into one, ZIP 940, PIZ 400.
pub(super) const DENSEST: u64 = 4096;

/// Refuses declared sizes that are beyond `max_pixels`, or that no compression fits into the file.
pub(super) fn believable(
    path: &Path,
    (width, height): (usize, usize),
    pixel_bytes: usize,
    densest: u64,
    max_pixels: u64,
) -> Result<()> {
    let pixels = width as u64 * height as u64;
    if pixels == 0 || pixels > max_pixels {
        let problem =
            format!("declares {width} x {height} pixels; 1 to max_pixels = {max_pixels} are read");
        return Err(Error::file(path, problem));
    }
    let bytes = std::fs::metadata(path).map_err(Error::io(path, "read"))?.len();
    let declared = pixels * pixel_bytes as u64;
    if declared / densest > bytes {
        return Err(Error::file(
            path,
            format!("declares {declared} bytes of pixels in a file of {bytes} bytes"),
        ));
    }
    Ok(())
}

/// Counts and mends the three planes of a picture that was decoded whole.
pub(super) fn examined(
    path: &Path,
    mut planes: Vec<f32>,
    (width, height): (usize, usize),
    options: &ReadOptions,
) -> Result<Frame> {
    let mending = Mending::first(options);
    let mut census = Census::default();
    for (i, row) in planes.chunks_exact_mut(width).enumerate() {
        census.admit(row, i % 3, (0, i / 3), mending);
    }
    let channel = |plane: usize| ["R", "G", "B"][plane].to_owned();
    if verdict(&census, options.non_finite, channel)
        .map_err(|problem| Error::file(path, problem))?
    {
        mending.second(&census).mend(&mut planes);
    }
    let planes = Planes { width, height, count: 3, samples: Samples::Float(planes) };
    Ok(Frame { planes, tally: census.tally })
}

struct Files {
    paths: Vec<PathBuf>,
    options: ReadOptions,
    header: Header,
}

/// Opens footage of one file for each frame. The first file's header tells its size and meaning.
pub fn open(paths: &[PathBuf], options: &ReadOptions) -> Result<Box<dyn Footage>> {
    let first = paths.first().ok_or_else(|| Error::config("[input]", "frames", "names no file"))?;
    let header = picture(first, options)?.header().clone();
    Ok(Box::new(Files { paths: paths.to_vec(), options: options.clone(), header }))
}

impl Footage for Files {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        self.paths.len()
    }

    fn read(
        &self,
        index: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame> {
        let picture = picture(&self.paths[index], &self.options)?;
        self.agrees(index, picture.header())?;
        let frame = picture.decode(projection, recycled)?;
        Ok(match self.gain(picture.header()) {
            1.0 => frame,
            gain => Frame { planes: frame.planes.scaled(gain), ..frame },
        })
    }

    fn plate(&self, index: usize) -> Result<Option<Plate>> {
        self.plate_of(index)
    }
}

impl Files {
    fn plate_of(&self, index: usize) -> Result<Option<Plate>> {
        let path = &self.paths[index];
        if format(path)? != Format::OpenExr {
            return Ok(None);
        }
        let picture = ExrPicture::open(path, &self.options)?;
        let gain = self.gain(picture.header());
        Ok(Some(Plate { picture, gain }))
    }

    /// The factor from a frame's own numbers to those of the first one: the luminances of (1, 1, 1)
    /// may differ, where it is the files that tell them.
    fn gain(&self, other: &Header) -> f32 {
        match (self.options.own_white, &other.kind, other.white, self.header.white) {
            (true, Kind::Rgb(_), Some(own), Some(first)) => (own.0 / first.0) as f32,
            _ => 1.0,
        }
    }

    fn agrees(&self, index: usize, other: &Header) -> Result<()> {
        let (path, first) = (&self.paths[index], self.paths[0].display());
        let ours = &self.header;
        if (other.width, other.height) != (ours.width, ours.height) {
            let problem = format!(
                "is {} x {} pixels, but {first} is {} x {}; all frames must have one size",
                other.width, other.height, ours.width, ours.height
            );
            return Err(Error::file(path, problem));
        }
        let same = match (&other.kind, &ours.kind) {
            (Kind::Rgb(other), Kind::Rgb(ours)) => other.agrees(ours),
            (other, ours) => other == ours,
        };
        if !same {
            let problem = format!(
                "holds {}, but {first} holds {}",
                described(&other.kind),
                described(&ours.kind)
            );
            return Err(Error::file(path, problem));
        }
        Ok(())
    }
}

/// A kind in a few words.
pub(super) fn described(kind: &Kind) -> String {
    match kind {
        Kind::Rgb(p) => {
            format!(
                "RGB with primaries {:?} {:?} {:?} and white {:?}",
                p.red, p.green, p.blue, p.white
            )
        }
        Kind::Spectral(bands) => {
            let (first, last) = (bands.as_slice()[0], bands.as_slice()[bands.len() - 1]);
            format!("{} bands, {} to {} nm", bands.len(), first.centre, last.centre)
        }
    }
}
