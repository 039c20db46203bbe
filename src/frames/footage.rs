//! Frames in any order. Footage made of files holds one frame a file, of whatever formats: each
//! file says in its header what it is, and every one after the first is held to what the first one
//! said.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::frames::format::{Footage, Format};
use crate::frames::options::{Overscan, ReadOptions};
use crate::frames::picture::{Header, Kind};
use crate::frames::plate::Plate;
use crate::light::{Frame, Planes, Window};
use crate::vision::Projection;

/// The formats that are read.
pub(super) type Formats = &'static [&'static Format];

/// Tells the format of a file: by its extension if that belongs to one format alone, else by the
/// file itself.
pub(super) fn format(formats: Formats, path: &Path) -> Result<&'static Format> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let owns = |format: &Format| {
        extension.as_deref().is_some_and(|extension| format.extensions.contains(&extension))
    };
    let owners: Vec<&Format> = formats.iter().copied().filter(|format| owns(format)).collect();
    if let [only] = owners[..] {
        return Ok(only);
    }
    let mut start = Vec::new();
    // A file that cannot be opened begins with nothing; its reader will say why.
    let _ = File::open(path).and_then(|file| file.take(16).read_to_end(&mut start));
    let candidates = if owners.is_empty() { formats } else { &owners[..] };
    let recognised = candidates.iter().find(|format| (format.recognise)(path, &start));
    recognised.or(owners.first()).copied().ok_or_else(|| {
        Error::file(path, format!("is of no known format; read are {}", listed(formats)))
    })
}

/// Extensions and names of formats, for people.
fn listed(formats: Formats) -> String {
    let each = formats.iter().map(|format| {
        let extensions: Vec<String> =
            format.extensions.iter().map(|extension| format!(".{extension}")).collect();
        format!("{} ({})", format.name, extensions.join(" "))
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Opens one file.
pub(super) fn picture(
    formats: Formats,
    path: &Path,
    options: &ReadOptions,
) -> Result<Box<dyn Footage>> {
    (format(formats, path)?.open)(path, options)
}

struct Files {
    formats: Formats,
    paths: Vec<PathBuf>,
    options: ReadOptions,
    header: Header,
    window: Window,
}

/// Opens footage of one file for each frame. The first file's header tells its size and meaning.
pub(super) fn open(
    formats: Formats,
    paths: &[PathBuf],
    options: &ReadOptions,
) -> Result<Box<dyn Footage>> {
    let first = paths.first().ok_or_else(|| Error::config("[input]", "frames", "names no file"))?;
    let opened = picture(formats, first, options)?;
    if paths.len() == 1 {
        return Ok(opened);
    }
    alone(first, &*opened)?;
    let (header, window) = (opened.header().clone(), opened.window());
    let overscan = margins(&header, window);
    let options = ReadOptions { overscan, ..options.clone() };
    Ok(Box::new(Files { formats, paths: paths.to_vec(), options, header, window }))
}

/// The overscan of a frame, which all that follow are given.
fn margins(header: &Header, Window { corner, size }: Window) -> Overscan {
    let beyond = [header.width - corner[0] - size[0], header.height - corner[1] - size[1]];
    Overscan::Margins([corner[0], corner[1], beyond[0], beyond[1]])
}

/// Refuses a film in a list of pictures.
fn alone(path: &Path, opened: &dyn Footage) -> Result<()> {
    match opened.times() {
        Some(_) => Err(Error::file(path, "is a film; a film stands alone in `frames`")),
        None => Ok(()),
    }
}

impl Footage for Files {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        self.paths.len()
    }

    fn window(&self) -> Window {
        self.window
    }

    fn read(
        &self,
        index: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame> {
        let picture = picture(self.formats, &self.paths[index], &self.options)?;
        alone(&self.paths[index], &*picture)?;
        self.agrees(index, picture.header())?;
        let gain = self.gain(index, picture.header())?;
        let frame = picture.read(0, projection, recycled)?;
        Ok(match gain {
            1.0 => frame,
            gain => Frame { planes: frame.planes.scaled(gain), ..frame },
        })
    }

    fn plate(&self, index: usize) -> Result<Option<Plate>> {
        let picture = picture(self.formats, &self.paths[index], &self.options)?;
        let gain = self.gain(index, picture.header())?;
        Ok(picture.plate(0)?.map(|plate| Plate { gain, ..plate }))
    }
}

impl Files {
    /// The factor from a frame's own numbers to those of the first one: the luminances of (1, 1, 1)
    /// may differ, where it is the files that tell them.
    fn gain(&self, index: usize, other: &Header) -> Result<f32> {
        match (self.options.own_white, other.white, self.header.white) {
            (true, Some(own), Some(first)) => Ok((own.0 / first.0) as f32),
            (true, own, first) if own != first => {
                let (path, first) = (&self.paths[index], self.paths[0].display());
                let problem = format!("and {first}: only one tells its white; give white_cd_m2");
                Err(Error::file(path, problem))
            }
            _ => Ok(1.0),
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
            let (other, ours) = (described(&other.kind), described(&ours.kind));
            return Err(Error::file(path, format!("holds {other}, but {first} holds {ours}")));
        }
        Ok(())
    }
}

/// A kind in a few words.
fn described(kind: &Kind) -> String {
    match kind {
        Kind::Rgb(p) => {
            let (r, g, b, white) = (p.red, p.green, p.blue, p.white);
            format!("RGB with primaries {r:?} {g:?} {b:?} and white {white:?}")
        }
        Kind::Spectral(bands) => {
            let (first, last) = (bands.as_slice()[0], bands.as_slice()[bands.len() - 1]);
            format!("{} bands, {} to {} nm", bands.len(), first.centre, last.centre)
        }
    }
}
