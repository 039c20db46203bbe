//! Wavelengths: bands of a frame, tables on a grid, and the integrals between them.

/// One band: its nominal centre and the interval its light was gathered over, nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    pub centre: f64,
    pub low: f64,
    pub high: f64,
}

impl Band {
    /// Width, nm.
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}

/// The bands of a spectral frame, in order of wavelength. Values are spectral radiance per nm, the mean over the
/// band: a band stands for an interval, not for a point (a 20 nm point sample of a lamp errs by up to 90 %).
#[derive(Clone, Debug, PartialEq)]
pub struct Bands(Vec<Band>);

impl Bands {
    /// Bands with stated limits. `None` unless there is at least one, all are finite with positive wavelengths
    /// and width, and centres rise strictly.
    pub fn new(bands: Vec<Band>) -> Option<Self> {
        let sound =
            |b: &Band| b.low > 0.0 && b.high.is_finite() && b.low < b.high && b.low <= b.centre && b.centre <= b.high;
        let rising = bands.windows(2).all(|pair| pair[0].centre < pair[1].centre);
        (!bands.is_empty() && bands.iter().all(sound) && rising).then_some(Bands(bands))
    }

    /// Bands known by their centres only: limits lie midway between neighbours, and the outermost bands are
    /// symmetrical. A single centre gets a width of 10 nm.
    pub fn from_centres(centres: &[f64]) -> Option<Self> {
        let n = centres.len();
        let gap = |i: usize| centres[i + 1] - centres[i];
        let half_below = |i: usize| {
            if i > 0 {
                gap(i - 1) / 2.0
            } else if n > 1 {
                gap(0) / 2.0
            } else {
                5.0
            }
        };
        let half_above = |i: usize| {
            if i + 1 < n {
                gap(i) / 2.0
            } else if n > 1 {
                gap(n - 2) / 2.0
            } else {
                5.0
            }
        };
        let band =
            |i: usize| Band { centre: centres[i], low: centres[i] - half_below(i), high: centres[i] + half_above(i) };
        Bands::new((0..n).map(band).collect())
    }

    /// `count` bands of equal width that cover `from..to`.
    pub fn uniform(from: f64, to: f64, count: usize) -> Option<Self> {
        let width = (to - from) / count as f64;
        let band = |i: usize| {
            let low = from + width * i as f64;
            Band { centre: low + width / 2.0, low, high: low + width }
        };
        Bands::new((0..count).map(band).collect())
    }

    /// The bands, rising.
    pub fn as_slice(&self) -> &[Band] {
        &self.0
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Never true: there is always a band.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
