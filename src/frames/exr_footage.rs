//! The frame of an OpenEXR file: the way from blocks to planes.

use std::path::Path;

use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, SampleType};
use half::f16;
use rayon::prelude::*;

use crate::colour::{Primaries, rgb_to_xyz};
use crate::error::{Error, Result};
use crate::frames::census::{Census, Mending, verdict};
use crate::frames::channels::Choice;
use crate::frames::exr_description::{self, ExrDescription, text};
use crate::frames::exr_file::{ExrFile, Part};
use crate::frames::exr_picture::ExrPicture;
use crate::frames::exr_rows::Stored;
use crate::frames::exr_sampling::{interpolate, to_rgb};
use crate::frames::format::{Footage, Format};
use crate::frames::options::ReadOptions;
use crate::frames::picture::{Header, Kind, canvas, examined};
use crate::frames::plate::Plate;
use crate::light::{Frame, Planes, Samples, Window};
use crate::vision::Projection;

pub(super) static FORMAT: Format = Format {
    name: "OpenEXR",
    extensions: &["exr"],
    recognise: |_, start| start.starts_with(&[0x76, 0x2f, 0x31, 0x01]),
    open: |path, options| Ok(Box::new(ExrPicture::open(path, options)?)),
    outline: |path| {
        let file = ExrFile::open(path).ok()?;
        let header = &file.meta.headers[0];
        let size = header.shared_attributes.display_window.size;
        Some((size.width(), size.height(), exr_description::described(header)))
    },
};

impl ExrPicture {
    /// Whether the frame is to be read with its infinities mended, or refused.
    fn verdict(&self, census: &Census) -> Result<bool> {
        verdict(census, self.options.non_finite, |plane| self.channel(plane))
            .map_err(|problem| Error::file(&self.file.path, problem))
    }

    /// The planes in the file's own numbers.
    fn as_stored<T: Stored>(&self, recycled: Option<Planes>) -> Result<Frame> {
        let part = self.part()?;
        let (width, places) = (part.width(), self.places(&part));
        let count = places.len();
        let mut samples: Vec<T> =
            canvas(recycled, width * part.height() * count, part.covers_window());
        let mending = Mending::first(&self.options);
        let counts = part.decode(&mut samples, width * count, |rows, out, _| {
            let mut census = Census::default();
            let columns = rows.columns();
            for (i, y) in rows.rows() {
                for (plane, &place) in places.iter().enumerate() {
                    let out = &mut out[(i * count + plane) * width..][columns.clone()];
                    rows.fetch(i, place, out);
                    census.admit(out, plane, (columns.start, y), mending);
                }
            }
            census
        })?;
        let census = counts.into_iter().fold(Census::default(), Census::plus);
        if self.verdict(&census)? {
            samples.par_chunks_mut(width).for_each(|row| mending.second(&census).mend(row));
        }
        let planes = Planes { width, height: part.height(), count, samples: T::samples(samples) };
        Ok(Frame { planes, tally: census.tally })
    }

    /// Red, green and blue out of Y, RY and BY.
    fn of_chroma(&self, primaries: &Primaries) -> Result<Frame> {
        let problem = || Error::file(&self.file.path, "has chromaticities that span no gamut");
        let weights = rgb_to_xyz(primaries).ok_or_else(problem)?[1];
        let part = self.part()?;
        let (width, places) = (part.width(), self.places(&part));
        let mut samples: Vec<f32> = vec![0.0; 3 * width * part.height()];
        part.decode(&mut samples, 3 * width, |rows, out, _| {
            for ((i, _), out) in rows.rows().zip(out.chunks_exact_mut(3 * width)) {
                for (&place, out) in places.iter().zip(out.chunks_exact_mut(width)) {
                    rows.fetch(i, place, &mut out[rows.columns()]);
                }
            }
        })?;
        for (plane, &channel) in self.choice.channels.iter().enumerate() {
            let channel = &part.header.channels.list[channel];
            interpolate(&mut samples, part.window, (plane, 3), channel);
        }
        samples.par_chunks_mut(3 * width).for_each(|row| to_rgb(row, weights));
        examined(&self.file.path, samples, (width, part.height()), &self.options)
    }

    /// The projections of every pixel, block by block.
    fn spectral(&self, projection: &Projection, recycled: Option<Planes>) -> Result<Frame> {
        let part = self.part()?;
        let bands: Vec<usize> = (0..self.choice.channels.len()).collect();
        let projection = projection.reordered(&bands, &self.choice.scale);
        let count = projection.rows;
        let mut sums: Vec<f32> =
            canvas(recycled, part.width() * part.height() * count, part.covers_window());
        let mending = Mending::first(&self.options);
        let census = self.project(&part, &projection, &mut sums, mending)?;
        if self.verdict(&census)? {
            self.project(&part, &projection, &mut sums, mending.second(&census))?;
        }
        let planes = Planes {
            width: part.width(),
            height: part.height(),
            count,
            samples: Samples::Float(sums),
        };
        Ok(Frame { planes, tally: census.tally })
    }

    fn project(
        &self,
        part: &Part,
        projection: &Projection,
        sums: &mut [f32],
        mending: Mending,
    ) -> Result<Census> {
        let (width, places) = (part.width(), self.places(part));
        let counts = part.decode(sums, width * projection.rows, |rows, out, row| {
            let mut census = Census::default();
            let columns = rows.columns();
            row.resize(places.len() * columns.len(), 0.0);
            let mut partial =
                vec![0.0; if columns.len() < width { columns.len() * projection.rows } else { 0 }];
            for (i, y) in rows.rows() {
                for (band, samples) in row.chunks_exact_mut(columns.len()).enumerate() {
                    rows.fetch(i, places[band], samples);
                    census.admit(samples, band, (columns.start, y), mending);
                }
                projection.remember(y, columns.start, row);
                let out = &mut out[i * projection.rows * width..][..projection.rows * width];
                if columns.len() == width {
                    projection.project(row, out);
                } else {
                    projection.project(row, &mut partial);
                    for (out, partial) in
                        out.chunks_exact_mut(width).zip(partial.chunks_exact(columns.len()))
                    {
                        out[columns.clone()].copy_from_slice(partial);
                    }
                }
            }
            census
        })?;
        Ok(counts.into_iter().fold(Census::default(), Census::plus))
    }
}

impl Footage for ExrPicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn window(&self) -> Window {
        let display = self.file.meta.headers[self.part].shared_attributes.display_window;
        let apart = |a: i32, b: i32| (i64::from(a) - i64::from(b)) as usize;
        let (Vec2(x, y), Vec2(left, top)) = (display.position, self.canvas.position);
        let size = [display.size.width(), display.size.height()];
        Window { corner: [apart(x, left), apart(y, top)], size }
    }

    fn plate(&self, _: usize) -> Result<Option<Plate>> {
        let picture = ExrPicture::open(&self.file.path, &self.options)?;
        Ok(Some(Plate { picture, gain: 1.0 }))
    }

    fn description(&self) -> Option<ExrDescription> {
        Some(exr_description::described(&self.file.meta.headers[self.part]))
    }

    fn read(
        &self,
        _: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame> {
        let part = self.part()?;
        let half = self.places(&part).iter().all(|place| place.kind == SampleType::F16);
        match (&self.choice.kind, projection) {
            (Kind::Rgb(primaries), _) if self.choice.chroma => self.of_chroma(primaries),
            (Kind::Rgb(_), _) if half => self.as_stored::<f16>(recycled),
            (Kind::Rgb(_), _) => self.as_stored::<f32>(recycled),
            (Kind::Spectral(_), Some(projection)) => self.spectral(projection, recycled),
            (Kind::Spectral(bands), None) => {
                self.spectral(&Projection::identity(bands.len()), recycled)
            }
        }
    }
}

/// Reads channels by their names, as float planes in that order, and the text of the attribute
/// `sungaze`: what [`write_exr`](crate::frames::write_exr) wrote.
pub fn read_exr(path: &Path, names: &[&str], max_pixels: u64) -> Result<(Planes, Option<String>)> {
    let file = ExrFile::open(path)?;
    let header = &file.meta.headers[0];
    let list = &header.channels.list;
    let channel = |name: &&str| {
        let found = list.iter().position(|channel| channel.name == **name);
        found.ok_or_else(|| Error::file(path, format!("has no channel `{name}`")))
    };
    let channels = names.iter().map(channel).collect::<Result<_>>()?;
    let json = header.own_attributes.other.iter().find_map(|(name, value)| match value {
        AttributeValue::Text(json) if *name == *"sungaze" => Some(text(json)),
        _ => None,
    });
    let kind = Kind::Rgb(Primaries::REC709);
    let canvas = file.part(0, max_pixels)?.window;
    let (width, height) = (canvas.size.width(), canvas.size.height());
    let header = Header::new(width, height, kind.clone());
    let choice = Choice { kind, channels, scale: Vec::new(), chroma: false, notes: Vec::new() };
    let options = ReadOptions { max_pixels, ..ReadOptions::default() };
    let (part, prefix) = (0, String::new());
    let picture = ExrPicture { file, part, canvas, choice, prefix, header, options };
    Ok((picture.as_stored::<f32>(None)?.planes, json))
}
