//! Footage in fewer pixels: each is the mean of the light in the area that it covers.

use std::sync::Arc;

use crate::error::Result;
use crate::frames::area::{covered, reduced};
use crate::frames::format::Footage;
use crate::frames::picture::Header;
use crate::light::{Frame, Planes};
use crate::vision::{Projection, SampledSpectra};

/// Frames that are read whole and reduced before anybody looks at them. They carry nothing beside
/// their light.
struct Reduced {
    whole: Box<dyn Footage>,
    header: Header,
}

/// Footage no wider than so many pixels. Narrower footage stays as it is.
pub(crate) fn no_wider(footage: Box<dyn Footage>, width: usize) -> Box<dyn Footage> {
    let of_whole = footage.header();
    if of_whole.width <= width {
        return footage;
    }
    let scale = width as f64 / of_whole.width as f64;
    let height = ((of_whole.height as f64 * scale).round() as usize).max(1);
    let mut header = Header { width, height, ..of_whole.clone() };
    header.notes.push(format!(
        "reduced from {} x {} to {width} x {height} pixels, each the mean light of the area that \
         it covers",
        of_whole.width, of_whole.height
    ));
    Box::new(Reduced { header, whole: footage })
}

impl Reduced {
    /// The pixels under a place, with their shares of it.
    fn pixels(&self, place: [usize; 2]) -> Vec<([usize; 2], f64)> {
        let size = |header: &Header| [header.width, header.height];
        covered(place, size(self.whole.header()), size(&self.header)).collect()
    }

    /// Reads a frame whole, and fills in the spectra of the places to be remembered.
    fn read_keeping(
        &self,
        index: usize,
        projection: &Projection,
        kept: &SampledSpectra,
    ) -> Result<Frame> {
        let places: Vec<_> = kept.places().iter().map(|&place| self.pixels(place)).collect();
        let pixels: Vec<_> = places.iter().flatten().map(|(pixel, _)| *pixel).collect();
        let spectra = Arc::new(SampledSpectra::new(&pixels));
        let frame = self.whole.read(index, Some(&projection.keeping(spectra.clone())), None)?;
        let mut pixel = 0;
        for (i, place) in places.iter().enumerate() {
            let parts = place.iter().enumerate().map(|(j, (_, share))| (j, *share));
            kept.fill(i, mean(parts.map(|(j, share)| (spectra.spectrum(pixel + j), share))));
            pixel += place.len();
        }
        Ok(frame)
    }
}

/// The mean of spectra with their shares; empty ones are dark.
fn mean(spectra: impl Iterator<Item = (Vec<f64>, f64)>) -> Vec<f64> {
    let mut sum = Vec::new();
    for (spectrum, share) in spectra {
        sum.resize(sum.len().max(spectrum.len()), 0.0);
        sum.iter_mut().zip(&spectrum).for_each(|(sum, light)| *sum += share * light);
    }
    sum
}

impl Footage for Reduced {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        self.whole.len()
    }

    fn times(&self) -> Option<&[f64]> {
        self.whole.times()
    }

    fn read(
        &self,
        index: usize,
        projection: Option<&Projection>,
        _: Option<Planes>,
    ) -> Result<Frame> {
        let kept = projection.and_then(|projection| Some((projection, projection.kept()?)));
        let frame = match kept {
            Some((projection, kept)) => self.read_keeping(index, projection, kept)?,
            None => self.whole.read(index, projection, None)?,
        };
        let planes = reduced(&frame.planes, [self.header.width, self.header.height]);
        Ok(Frame { planes, ..frame })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::picture::Kind;
    use crate::light::{Samples, Tally};
    use crate::spectrum::Bands;

    /// Two bands of 6 x 4 pixels: column + 10 row, and its square.
    struct Ramp(Header);

    fn ramp() -> Box<dyn Footage> {
        let bands = Bands::uniform(500.0, 600.0, 2).unwrap();
        Box::new(Ramp(Header::new(6, 4, Kind::Spectral(bands))))
    }

    impl Footage for Ramp {
        fn header(&self) -> &Header {
            &self.0
        }

        fn read(&self, _: usize, p: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
            let light = |i: usize| (i % 6 + 10 * (i / 12)) as f32;
            let value = |i: usize| if i % 12 < 6 { light(i) } else { light(i).powi(2) };
            let samples: Vec<f32> = (0..48).map(value).collect();
            (0..4).for_each(|y| p.unwrap().remember(y, 0, &samples[12 * y..][..12]));
            let planes = Planes { width: 6, height: 4, count: 2, samples: Samples::Float(samples) };
            Ok(Frame { planes, tally: Tally::default() })
        }
    }

    #[test]
    fn a_pixel_is_the_mean_of_what_it_covers_and_so_is_its_spectrum() {
        for width in [1, 2, 3, 4, 5] {
            let footage = no_wider(ramp(), width);
            let (width, height) = (footage.header().width, footage.header().height);
            assert_eq!(height, ((4.0 * width as f64 / 6.0).round() as usize).max(1));
            let places = [[0, 0], [width - 1, height - 1]];
            let kept = Arc::new(SampledSpectra::new(&places));
            let projection = Projection::identity(2).keeping(kept.clone());
            let frame = footage.read(0, Some(&projection), None).unwrap();
            for (i, [x, y]) in places.into_iter().enumerate() {
                for (band, light) in kept.spectrum(i).into_iter().enumerate() {
                    approx::assert_relative_eq!(
                        frame.planes.at(x, y, band),
                        light,
                        max_relative = 1e-6
                    );
                }
            }
        }
    }

    #[test]
    fn narrower_footage_stays_as_it_is() {
        assert!(no_wider(ramp(), 6).header().notes.is_empty());
        assert_eq!(no_wider(ramp(), 3).header().notes.len(), 1);
    }
}
