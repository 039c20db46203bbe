//! The picture in an OpenEXR file: where it stands, and what its planes mean.

use std::path::Path;

use exr::meta::attribute::IntegerBounds;

use crate::error::{Error, Result};
use crate::frames::channels::Choice;
use crate::frames::exr_description::text;
use crate::frames::exr_file::{ExrFile, Part};
use crate::frames::exr_layer::chosen;
use crate::frames::exr_rows::Place;
use crate::frames::options::ReadOptions;
use crate::frames::picture::{Header, believable};
use crate::text::shown;
use crate::units::Nits;

/// An OpenEXR file with its picture chosen.
pub(super) struct ExrPicture {
    pub(crate) file: ExrFile,
    pub(crate) part: usize,
    /// The pixels of the file that are read: the display window, and overscan.
    pub(crate) canvas: IntegerBounds,
    pub(crate) choice: Choice,
    /// What the names of the layer's channels begin with.
    pub(crate) prefix: String,
    pub(crate) header: Header,
    pub(crate) options: ReadOptions,
}

impl ExrPicture {
    pub(super) fn open(path: &Path, options: &ReadOptions) -> Result<ExrPicture> {
        let file = ExrFile::open(path)?;
        let (part, prefix, choice) =
            chosen(&file, options).map_err(|problem| Error::file(path, problem))?;
        let canvas = file.part(part, options.max_pixels)?.canvas(options.overscan);
        let (width, height) = (canvas.size.width(), canvas.size.height());
        // Both windows were believable; what they span may not be.
        believable(path, (width, height), 0, u64::MAX, options.max_pixels)?;
        let attributes = &file.meta.headers[part].own_attributes;
        let mut notes = choice.notes.clone();
        if file.meta.headers.len() > 1 {
            let name = attributes.layer_name.as_ref();
            let name = name.map(|name| format!(", `{}`", shown(&text(name)))).unwrap_or_default();
            notes.push(format!("part {} of {}{name}", part + 1, file.meta.headers.len()));
        }
        let aspect = file.meta.headers[part].shared_attributes.pixel_aspect;
        if aspect != 1.0 {
            notes.push(format!(
                "its pixels are not square (pixelAspectRatio {aspect}); read as square"
            ));
        }
        let header = Header {
            white: attributes
                .white_luminance
                .filter(|white| *white > 0.0)
                .map(|white| Nits(white.into())),
            frames_per_second: attributes
                .frames_per_second
                .map(|(frames, seconds)| f64::from(frames) / f64::from(seconds))
                .filter(|rate| rate.is_finite() && *rate > 0.0),
            notes,
            ..Header::new(width, height, choice.kind.clone())
        };
        Ok(ExrPicture { file, part, canvas, choice, prefix, header, options: options.clone() })
    }

    /// Whether the configuration says what its primaries are.
    pub(super) fn primaries_are_given(&self) -> bool {
        self.options.primaries.is_some()
    }

    /// The part with the picture.
    pub(super) fn part(&self) -> Result<Part<'_>> {
        let part = self.file.part(self.part, self.options.max_pixels)?;
        Ok(Part { window: self.canvas, ..part })
    }

    /// Where the samples of each plane lie.
    pub(super) fn places(&self, part: &Part) -> Vec<Place> {
        self.choice.channels.iter().map(|&channel| part.place(channel)).collect()
    }

    /// The name of the channel behind a plane.
    pub(super) fn channel(&self, plane: usize) -> String {
        let channel = self.choice.channels[plane];
        shown(&text(&self.file.meta.headers[self.part].channels.list[channel].name))
    }
}
