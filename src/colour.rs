//! Three by three matrices between colour spaces.

/// A matrix, rows first.
pub(crate) type Matrix = [[f64; 3]; 3];

/// The identity.
pub(crate) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Red, green, blue and white chromaticities, CIE 1931 x, y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    pub red: [f64; 2],
    pub green: [f64; 2],
    pub blue: [f64; 2],
    pub white: [f64; 2],
}

impl Primaries {
    /// ITU-R BT.709 / sRGB with D65: what an OpenEXR file without `chromaticities` means.
    pub const REC709: Primaries = Primaries {
        red: [0.64, 0.33],
        green: [0.30, 0.60],
        blue: [0.15, 0.06],
        white: [0.3127, 0.3290],
    };

    /// ITU-R BT.601 of 525 lines: SMPTE 170M.
    pub(crate) const BT601_525: Primaries =
        primaries([0.630, 0.340], [0.310, 0.595], [0.155, 0.070], Primaries::REC709.white);

    /// ITU-R BT.601 of 625 lines: EBU Tech 3213.
    pub(crate) const BT601_625: Primaries =
        primaries([0.64, 0.33], [0.29, 0.60], [0.15, 0.06], Primaries::REC709.white);

    /// ITU-R BT.2020 and BT.2100.
    pub const BT2020: Primaries =
        primaries([0.708, 0.292], [0.170, 0.797], [0.131, 0.046], Primaries::REC709.white);

    /// Display P3: SMPTE EG 432-1.
    pub const P3_D65: Primaries =
        primaries([0.680, 0.320], [0.265, 0.690], [0.150, 0.060], Primaries::REC709.white);

    /// The cinema's P3: SMPTE RP 431-2.
    pub(crate) const P3_DCI: Primaries =
        primaries([0.680, 0.320], [0.265, 0.690], [0.150, 0.060], [0.314, 0.351]);

    /// ACES AP1: S-2014-004.
    pub const ACESCG: Primaries =
        primaries([0.713, 0.293], [0.165, 0.830], [0.128, 0.044], [0.32168, 0.33767]);

    /// ACES AP0: SMPTE ST 2065-1.
    pub(crate) const ACES: Primaries =
        primaries([0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.0770], [0.32168, 0.33767]);

    /// CIE 1931 XYZ itself, as channels X, Y, Z hold it.
    pub const XYZ: Primaries =
        Primaries { red: [1.0, 0.0], green: [0.0, 1.0], blue: [0.0, 0.0], white: [1.0 / 3.0; 2] };

    /// Whether all eight numbers agree but for rounding, in files that print them or keep them as
    /// single floats: within 1e-5.
    pub fn agrees(&self, other: &Primaries) -> bool {
        let points = |p: &Primaries| [p.red, p.green, p.blue, p.white];
        let both = points(self).into_iter().flatten().zip(points(other).into_iter().flatten());
        both.into_iter().all(|(a, b)| (a - b).abs() < 1e-5)
    }
}

const fn primaries(red: [f64; 2], green: [f64; 2], blue: [f64; 2], white: [f64; 2]) -> Primaries {
    Primaries { red, green, blue, white }
}

/// Matrix times vector.
pub(crate) fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Matrix product a b.
pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

/// Every entry times a number.
pub(crate) fn scaled(m: &Matrix, factor: f64) -> Matrix {
    m.map(|row| row.map(|v| v * factor))
}

/// The inverse; entries are not finite if there is none.
pub(crate) fn inverse(m: &Matrix) -> Matrix {
    let minor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / determinant))
}

/// Linear RGB in these primaries -> CIE 1931 XYZ, Y of white 1. `None` if they span no gamut.
pub fn rgb_to_xyz(primaries: &Primaries) -> Option<Matrix> {
    // A primary without luminance (y = 0: X and Z of XYZ) is given by its proportions.
    let tristimulus = |[x, y]: [f64; 2]| {
        if y == 0.0 { [x, 0.0, 1.0 - x] } else { [x / y, 1.0, (1.0 - x - y) / y] }
    };
    let columns = [primaries.red, primaries.green, primaries.blue].map(tristimulus);
    let m = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]));
    let share = apply(&inverse(&m), tristimulus(primaries.white));
    let rgb = m.map(|row| [0, 1, 2].map(|j| row[j] * share[j]));
    let sound = rgb.iter().chain(&inverse(&rgb)).flatten().all(|v| v.is_finite());
    sound.then_some(rgb)
}

/// Linear RGB in these primaries -> linear sRGB, without chromatic adaptation.
pub fn to_rec709(primaries: &Primaries) -> Option<Matrix> {
    if *primaries == Primaries::REC709 {
        return Some(IDENTITY);
    }
    let rec709 = rgb_to_xyz(&Primaries::REC709)?;
    Some(product(&inverse(&rec709), &rgb_to_xyz(primaries)?))
}

/// Chromaticity x, y of XYZ; NaN in the dark.
pub(crate) fn chromaticity(xyz: [f64; 3]) -> [f64; 2] {
    let sum: f64 = xyz.iter().sum();
    [xyz[0] / sum, xyz[1] / sum]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rec709_has_the_luminance_weights_of_its_standard() {
        let m = rgb_to_xyz(&Primaries::REC709).unwrap();
        for (ours, standard) in m[1].iter().zip([0.2126, 0.7152, 0.0722]) {
            assert!((ours - standard).abs() < 5e-5);
        }
    }

    #[test]
    fn acescg_goes_to_rec709_and_back() {
        let ap1 = Primaries {
            red: [0.713, 0.293],
            green: [0.165, 0.830],
            blue: [0.128, 0.044],
            white: [0.32168, 0.33767],
        };
        let there = to_rec709(&ap1).unwrap();
        let round = product(&inverse(&there), &there);
        for (i, row) in round.iter().enumerate() {
            for (j, v) in row.iter().enumerate() {
                assert!((v - IDENTITY[i][j]).abs() < 1e-12);
            }
        }
        assert!(there[0][1] < 0.0, "a green of ACEScg lies outside Rec. 709");
    }

    #[test]
    fn xyz_is_a_basis_of_its_own() {
        let m = rgb_to_xyz(&Primaries::XYZ).unwrap();
        for (row, unit) in m.iter().flatten().zip(IDENTITY.iter().flatten()) {
            assert!((row - unit).abs() < 1e-12, "{m:?}");
        }
    }

    #[test]
    fn primaries_agree_within_rounding_only() {
        let near = Primaries { red: [0.64, 0.330_000_1], ..Primaries::REC709 };
        let far = Primaries { red: [0.64, 0.331], ..Primaries::REC709 };
        assert!(Primaries::REC709.agrees(&near) && !Primaries::REC709.agrees(&far));
    }

    #[test]
    fn primaries_on_one_line_span_no_gamut() {
        let flat =
            Primaries { red: [0.2, 0.2], green: [0.3, 0.3], blue: [0.4, 0.4], white: [0.3, 0.3] };
        assert_eq!(rgb_to_xyz(&flat), None);
    }
}
