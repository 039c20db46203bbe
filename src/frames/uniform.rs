//! A uniform field: every place has the same light, which may change from frame to frame.

use super::{Footage, Header, Kind};
use crate::error::Result;
use crate::light::Samples;
use crate::light::{Frame, Planes, Tally};
use crate::observer::Observer;
use crate::spectrum::{Bands, Curve};
use crate::vision::{Projection, Vision};

/// Width of a field, degrees, where nothing says it. What surrounds it is usually the same light.
pub(crate) const FIELD_DEG: f64 = 10.0;

/// Frames of one spectrum, each of its own strength.
#[derive(Clone, Debug)]
pub(crate) struct UniformField {
    header: Header,
    moments: Vec<Vec<f64>>,
}

impl UniformField {
    /// A field of `size` (width, height). `lights`: strengths for L, M and S cones, one triple a
    /// frame; three times 1 is one cd/m2 of the spectrum.
    pub(crate) fn new(
        observer: Observer,
        size: [usize; 2],
        spectrum: &Curve,
        lights: impl Iterator<Item = [f64; 3]>,
    ) -> UniformField {
        let bands = bands();
        let vision = Vision::of_bands(observer, &bands);
        let unit = vision.moments_of(spectrum);
        let light = |strengths: [f64; 3]| {
            let moments = unit.iter().enumerate();
            moments.map(|(row, of_unit)| strengths[vision.cone_of_moment(row)] * of_unit).collect()
        };
        let header = Header::new(size[0], size[1], Kind::Spectral(bands));
        UniformField { header, moments: lights.map(light).collect() }
    }
}

/// Bands of 1 nm over the whole grid: a field is never held as bands.
fn bands() -> Bands {
    let (from, to) = (Curve::FROM as f64, Curve::TO as f64);
    Bands::uniform(from - 0.5, to + 0.5, Curve::TO - Curve::FROM + 1)
        .unwrap_or_else(|| unreachable!("these bands rise"))
}

impl Footage for UniformField {
    fn header(&self) -> &Header {
        &self.header
    }

    fn len(&self) -> usize {
        self.moments.len()
    }

    fn read(&self, index: usize, _: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
        let (width, moments) = (self.header.width, &self.moments[index]);
        let row = moments.iter().flat_map(|&value| std::iter::repeat_n(value as f32, width));
        let row: Vec<f32> = row.collect();
        let samples = Samples::Float(row.repeat(self.header.height));
        let planes = Planes { width, height: self.header.height, count: moments.len(), samples };
        Ok(Frame { planes, tally: Tally::default() })
    }

    fn uniform(&self, index: usize) -> Option<&[f64]> {
        Some(&self.moments[index])
    }
}
