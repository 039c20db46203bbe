//! Wavelengths: bands of a frame, tables on a grid, and the integrals between them.

/// One band: its nominal centre and the interval its light was gathered over, nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    pub centre: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Band {
    /// Width, nm.
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}

/// The bands of a spectral frame, in order of wavelength. Values are spectral radiance per nm, the
/// mean over the band: a band stands for an interval, not for a point (a 20 nm point sample of a
/// lamp errs by up to 90 %).
#[derive(Clone, Debug, PartialEq)]
pub struct Bands(Vec<Band>);

impl Bands {
    /// Bands with stated limits. `None` unless there is at least one, all are finite with positive
    /// wavelengths and width, and centres rise strictly.
    pub(crate) fn new(bands: Vec<Band>) -> Option<Self> {
        let sound = |b: &Band| {
            b.low > 0.0
                && b.high.is_finite()
                && b.low < b.high
                && b.low <= b.centre
                && b.centre <= b.high
        };
        let rising = bands.windows(2).all(|pair| pair[0].centre < pair[1].centre);
        (!bands.is_empty() && bands.iter().all(sound) && rising).then_some(Bands(bands))
    }

    /// Bands known by their centres only: limits lie midway between neighbours, and the outermost
    /// bands are symmetrical. A single centre gets a width of 10 nm.
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
        let band = |i: usize| Band {
            centre: centres[i],
            low: centres[i] - half_below(i),
            high: centres[i] + half_above(i),
        };
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

/// A function of wavelength at every nanometre from `Curve::FROM` to `Curve::TO`; zero outside.
/// Each value stands for the nanometre around its wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve(pub Vec<f64>);

impl Curve {
    /// First wavelength, nm: where the published cone fundamentals begin.
    pub(crate) const FROM: usize = 390;
    /// Last wavelength, nm.
    pub(crate) const TO: usize = 830;

    /// The wavelengths of the grid, nm.
    pub(crate) fn wavelengths() -> impl Iterator<Item = f64> {
        (Self::FROM..=Self::TO).map(|nm| nm as f64)
    }

    /// The function sampled at every wavelength of the grid.
    pub fn sampled(f: impl FnMut(f64) -> f64) -> Self {
        Curve(Self::wavelengths().map(f).collect())
    }

    /// A spectrum from rows of wavelength in nm and value, straight lines between them and nothing
    /// outside. Blank lines, lines after `#` and a header are passed over.
    ///
    /// # Errors
    /// A row is not two numbers, a wavelength does not rise, a value is negative, or nothing lies
    /// within the grid; the problem names its line.
    pub(crate) fn of_rows(text: &str) -> Result<Curve, String> {
        let mut rows: Vec<[f64; 2]> = Vec::new();
        let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).enumerate();
        let lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        for (place, (i, line)) in lines.enumerate() {
            let cells: Vec<f64> = line.split(',').map_while(|v| v.trim().parse().ok()).collect();
            match cells[..] {
                [nm, value]
                    if nm.is_finite()
                        && (0.0..f64::INFINITY).contains(&value)
                        && rows.last().is_none_or(|last| last[0] < nm) =>
                {
                    rows.push([nm, value])
                }
                [] if place == 0 => {}
                _ => {
                    let accepted = "nm,value with rising wavelengths and values of 0 or more";
                    return Err(format!("line {}: found {line:?}; accepted: {accepted}", i + 1));
                }
            }
        }
        let curve = Curve::sampled(|nm| between(&rows, nm));
        let lit = curve.integral() > 0.0;
        lit.then_some(curve).ok_or_else(|| "holds no light from 390 to 830 nm".into())
    }

    /// The value at a wavelength of the grid; zero elsewhere.
    pub(crate) fn at(&self, nm: usize) -> f64 {
        nm.checked_sub(Self::FROM).and_then(|i| self.0.get(i)).copied().unwrap_or(0.0)
    }

    /// The pointwise product.
    pub fn times(&self, other: &Curve) -> Curve {
        Curve(self.0.iter().zip(&other.0).map(|(a, b)| a * b).collect())
    }

    /// The curve times a number.
    pub(crate) fn scaled(&self, factor: f64) -> Curve {
        Curve(self.0.iter().map(|v| v * factor).collect())
    }

    /// The largest value.
    pub(crate) fn peak(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }

    /// Integral over wavelength, nm.
    pub fn integral(&self) -> f64 {
        self.0.iter().sum()
    }

    /// The wavelength of the largest value and the full width at half of it, nm, between samples by
    /// straight lines.
    pub(crate) fn peak_and_width(&self) -> (f64, f64) {
        let (top, peak) = self
            .0
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (i, &v)| if v > best.1 { (i, v) } else { best });
        let half = peak / 2.0;
        let crossing = |inside: usize, outside: usize| {
            let (a, b) = (self.0[inside], self.0[outside]);
            inside as f64 + (outside as f64 - inside as f64) * (a - half) / (a - b)
        };
        let below = (0..top).rev().find(|&i| self.0[i] < half).map_or(0.0, |i| crossing(i + 1, i));
        let above = (top..self.0.len())
            .find(|&i| self.0[i] < half)
            .map_or(f64::NAN, |i| crossing(i - 1, i));
        ((Self::FROM + top) as f64, above - below)
    }

    /// Integral of the curve over each band, nm: its weights for light that is known by its mean
    /// over the band.
    pub fn over(&self, bands: &Bands) -> Vec<f64> {
        bands.as_slice().iter().map(|band| self.between(band.low, band.high)).collect()
    }

    fn between(&self, low: f64, high: f64) -> f64 {
        Self::wavelengths().zip(&self.0).map(|(nm, v)| v * overlap(nm, low, high)).sum()
    }

    /// How much of each nanometre lies between two wavelengths: a light of 1 in just that band.
    pub(crate) fn within(low: f64, high: f64) -> Curve {
        Curve::sampled(|nm| overlap(nm, low, high))
    }
}

/// How much of the nanometre around `nm` lies between two wavelengths.
fn overlap(nm: f64, low: f64, high: f64) -> f64 {
    ((nm + 0.5).min(high) - (nm - 0.5).max(low)).max(0.0)
}

/// A published table as it stands in `data/`: rising wavelengths in the first column.
#[derive(Clone, Debug)]
pub struct Table {
    pub(crate) wavelengths: Vec<f64>,
    columns: Vec<Vec<f64>>,
    names: Vec<String>,
}

impl Table {
    /// Reads one of our own tables. Lines that begin with `#` name its source; the next holds the
    /// column names.
    fn embedded(text: &str) -> Table {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let names: Vec<String> =
            lines.next().unwrap_or_default().split(',').map(str::to_owned).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for line in lines {
            for (column, cell) in columns.iter_mut().zip(line.split(',')) {
                column.push(cell.trim().parse().unwrap_or(f64::NAN));
            }
        }
        Table { wavelengths: columns[0].clone(), columns, names }
    }

    /// A column by its name; empty if there is none.
    pub(crate) fn column(&self, name: &str) -> &[f64] {
        self.names.iter().position(|n| n == name).map_or(&[], |i| &self.columns[i])
    }

    /// Straight-line interpolation in a column; the end values go on outside.
    pub(crate) fn interpolated(&self, name: &str, nm: f64) -> f64 {
        let (x, y) = (&self.wavelengths, self.column(name));
        let i = x.partition_point(|&w| w <= nm);
        match i {
            0 => y[0],
            i if i == x.len() => y[i - 1],
            i => y[i - 1] + (y[i] - y[i - 1]) * (nm - x[i - 1]) / (x[i] - x[i - 1]),
        }
    }
}

/// The value at a wavelength, on straight lines between rows; zero outside.
fn between(rows: &[[f64; 2]], nm: f64) -> f64 {
    let next = rows.partition_point(|row| row[0] <= nm);
    match (next.checked_sub(1).map(|i| rows[i]), rows.get(next)) {
        (Some([x0, a]), Some([x1, b])) => a + (b - a) * (nm - x0) / (x1 - x0),
        (Some([x, a]), None) if x == nm => a,
        _ => 0.0,
    }
}

macro_rules! tables {
    ($($(#[$doc:meta])* $name:ident = $file:literal;)*) => {$(
        $(#[$doc])*
        pub static $name: std::sync::LazyLock<Table> =
            std::sync::LazyLock::new(|| Table::embedded(include_str!(concat!("../data/", $file))));
    )*};
}

tables! {
    /// CIE 170-1:2006: log10 absorbances, lens and macular density, the tabulated 10-degree
    /// fundamentals.
    CONE_PIECES = "cone_pieces.csv";
    /// CIE 1964 10-degree colour-matching functions.
    CIE1964 = "cie1964_10deg.csv";
    /// CIE 1931 2-degree colour-matching functions.
    CIE1931 = "cie1931_2deg.csv";
    /// CIE standard illuminant D65, relative.
    D65 = "d65.csv";
    /// Spectral primary decomposition of sRGB (Mallett & Yuksel 2019).
    SRGB_BASIS = "mallett_yuksel_2019.csv";
    /// Stiles-Crawford p(lambda), mm^-2 (after Berendschot et al. 2001).
    STILES_CRAWFORD = "stiles_crawford.csv";
    /// Extraterrestrial solar irradiance, W m^-2 nm^-1 (ASTM G173-03).
    SOLAR = "solar_etr.csv";
    /// CIE 1951 scotopic luminous efficiency.
    SCOTOPIC = "scotopic.csv";
}
