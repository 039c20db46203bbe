//! Footage made of files, one frame each, of whatever formats: each file says in its header what it is, and every
//! one after the first is held to what the first one said.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::frames::exr_picture::ExrPicture;
use crate::frames::{Footage, Header, Kind, ReadOptions};
use crate::light::{Frame, Planes, Projection};

/// A picture file whose header was read.
pub(super) trait Picture: Send + Sync {
    fn header(&self) -> &Header;
    /// Decodes the pixels; without a projection a spectral picture keeps every band.
    fn decode(&self, projection: Option<&Projection>, recycled: Option<Planes>) -> Result<Frame>;
}

/// The extensions that are read.
pub const EXTENSIONS: &str = ".exr";

/// Opens a picture by its extension.
pub(super) fn picture(path: &Path, options: &ReadOptions) -> Result<Box<dyn Picture>> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("exr") => Ok(Box::new(ExrPicture::open(path, options)?)),
        _ => Err(Error::file(path, format!("is of no known format; read are {EXTENSIONS}"))),
    }
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

    fn read(&self, index: usize, projection: Option<&Projection>, recycled: Option<Planes>) -> Result<Frame> {
        let picture = picture(&self.paths[index], &self.options)?;
        self.agrees(index, picture.header())?;
        picture.decode(projection, recycled)
    }
}

impl Files {
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
        if other.kind != ours.kind {
            let problem = format!("holds {}, but {first} holds {}", described(&other.kind), described(&ours.kind));
            return Err(Error::file(path, problem));
        }
        Ok(())
    }
}

/// A kind in a few words.
pub(super) fn described(kind: &Kind) -> String {
    match kind {
        Kind::Rgb(p) => {
            format!("RGB with primaries {:?} {:?} {:?} and white {:?}", p.red, p.green, p.blue, p.white)
        }
        Kind::Spectral(bands) => {
            let (first, last) = (bands.as_slice()[0], bands.as_slice()[bands.len() - 1]);
            format!("{} bands, {} to {} nm", bands.len(), first.centre, last.centre)
        }
    }
}
