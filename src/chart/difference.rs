//! CIEDE2000, the difference of two colours as seen (CIE 142-2001; Sharma, Wu & Dalal 2005), of
//! sRGB pictures.

use crate::colour::Primaries;
use crate::colour::{apply, rgb_to_xyz};

/// CIELAB of an 8-bit sRGB colour, D65.
pub(super) fn lab(srgb: [u8; 3]) -> [f64; 3] {
    let linear = srgb.map(|code| {
        let v = f64::from(code) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    });
    let to_xyz = rgb_to_xyz(&Primaries::REC709).unwrap_or(crate::colour::IDENTITY);
    let (xyz, white) = (apply(&to_xyz, linear), apply(&to_xyz, [1.0; 3]));
    let f = |t: f64| {
        if t > (6.0f64 / 29.0).powi(3) {
            t.cbrt()
        } else {
            t * (29.0f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0
        }
    };
    let [x, y, z] = [0, 1, 2].map(|i| f(xyz[i] / white[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The difference of two colours in CIELAB.
pub(super) fn ciede2000(a: [f64; 3], b: [f64; 3]) -> f64 {
    let mean_chroma = (a[1].hypot(a[2]) + b[1].hypot(b[2])) / 2.0;
    let g = 0.5 * (1.0 - seventh(mean_chroma));
    let polar = |[l, a, b]: [f64; 3]| {
        let a = a * (1.0 + g);
        (
            l,
            a.hypot(b),
            if a == 0.0 && b == 0.0 { 0.0 } else { b.atan2(a).to_degrees().rem_euclid(360.0) },
        )
    };
    let ((l1, c1, h1), (l2, c2, h2)) = (polar(a), polar(b));
    let colourless = c1 * c2 == 0.0;
    let turn = if colourless { 0.0 } else { (h2 - h1 + 540.0).rem_euclid(360.0) - 180.0 };
    let hue = match (colourless, (h1 - h2).abs() > 180.0) {
        (true, _) => h1 + h2,
        (_, true) => ((h1 + h2 + 360.0) / 2.0).rem_euclid(360.0),
        _ => (h1 + h2) / 2.0,
    };
    let (lightness, chroma) = ((l1 + l2) / 2.0, (c1 + c2) / 2.0);
    let cos = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cos(hue - 30.0) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6.0)
        - 0.20 * cos(4.0 * hue - 63.0);
    let away = (lightness - 50.0).powi(2);
    let of_l = (l2 - l1) / (1.0 + 0.015 * away / (20.0 + away).sqrt());
    let of_c = (c2 - c1) / (1.0 + 0.045 * chroma);
    let of_h =
        2.0 * (c1 * c2).sqrt() * (turn / 2.0).to_radians().sin() / (1.0 + 0.015 * chroma * t);
    let rotation = 60.0 * (-((hue - 275.0) / 25.0).powi(2)).exp();
    let mixed = -rotation.to_radians().sin() * 2.0 * seventh(chroma);
    (of_l * of_l + of_c * of_c + of_h * of_h + mixed * of_c * of_h).max(0.0).sqrt()
}

fn seventh(chroma: f64) -> f64 {
    (chroma.powi(7) / (chroma.powi(7) + 25f64.powi(7))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_pairs_have_their_published_differences() {
        // Sharma, Wu & Dalal 2005, Table 1: pairs 1, 7, 17, 21, 25.
        let pairs = [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [50.0, 3.1736, 0.5854], 1.0),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ];
        for (a, b, expected) in pairs {
            assert!((ciede2000(a, b) - expected).abs() < 1e-4, "{} {expected}", ciede2000(a, b));
            assert!((ciede2000(b, a) - expected).abs() < 1e-4);
        }
    }

    #[test]
    fn white_is_100_and_grey_has_no_colour() {
        let [l, a, b] = lab([255; 3]);
        assert!((l - 100.0).abs() < 1e-9 && a.abs() < 1e-9 && b.abs() < 1e-9);
    }
}
