//! A sheet as files: SVG, and PNG of the same items.

use std::path::Path;

use super::raster::Canvas;
use super::{Sheet, svg};
use crate::error::Result;
use crate::frames::atomic;

impl Sheet {
    /// The drawing as SVG.
    pub(crate) fn svg(&self) -> String {
        svg::document(self)
    }

    /// Writes `<name>.svg` and `<name>.png`, the latter with two pixels to the unit; each appears whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(crate) fn write(&self, out_dir: &Path, name: &str) -> Result<()> {
        atomic::write_text(&out_dir.join(format!("{name}.svg")), &self.svg())?;
        Canvas::of(self, 2.0).write(&out_dir.join(format!("{name}.png")))
    }
}
