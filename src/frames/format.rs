//! A file format: how a file is recognised and opened, and the frames that it then gives.

use std::path::Path;

use crate::error::Result;
use crate::frames::exr_description::ExrDescription;
use crate::frames::options::ReadOptions;
use crate::frames::picture::Header;
use crate::frames::plate::Plate;
use crate::light::{Frame, Planes, Window};
use crate::vision::Projection;

/// Frames that can be read in any order, by any thread: a picture file, a film, a list of files, the
/// built-in scene.
pub trait Footage: Send + Sync {
    /// Size and meaning, the same for every frame.
    fn header(&self) -> &Header;
    /// How many different frames there are; never 0.
    fn len(&self) -> usize {
        1
    }
    /// Never true: footage without a frame is refused when it is opened.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The starts of all frames and the end of the last, s from 0, where a film tells them.
    fn times(&self) -> Option<&[f64]> {
        None
    }
    /// Decodes frame `index`. Spectral frames are projected block by block, and keep every band
    /// without a projection; RGB frames keep their samples. `recycled` may hold the planes of an
    /// earlier frame to be written over.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::error::Error::File) for a frame that is damaged, cut short or unlike the first one.
    fn read(
        &self,
        index: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame>;
    /// The moments of frame `index` in double precision, where every place has the same light.
    fn uniform(&self, index: usize) -> Option<&[f64]> {
        let _ = index;
        None
    }
    /// The display window among the pixels of every frame.
    fn window(&self) -> Window {
        Window::whole([self.header().width, self.header().height])
    }
    /// What else frame `index` carries, to be written with its percept; `None` where that is
    /// nothing.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::error::Error::File) for a frame that can no longer be read.
    fn plate(&self, index: usize) -> Result<Option<Plate>> {
        let _ = index;
        Ok(None)
    }
    /// What an OpenEXR header tells beyond the rest.
    fn description(&self) -> Option<ExrDescription> {
        None
    }
}

/// A file format: one static of each reader, listed in `FORMATS`.
pub(super) struct Format {
    pub(crate) name: &'static str,
    /// In lower case. Two formats may share one; [`Format::recognise`] then decides.
    pub(crate) extensions: &'static [&'static str],
    /// Whether a file is of this format, by its first 16 bytes or by what lies beside it.
    pub(crate) recognise: fn(&Path, &[u8]) -> bool,
    pub(crate) open: fn(&Path, &ReadOptions) -> Result<Box<dyn Footage>>,
    /// Width, height and header of a file whose channels tell no picture.
    pub(crate) outline: fn(&Path) -> Option<(usize, usize, ExrDescription)>,
}
