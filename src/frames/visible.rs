//! Whether the bands of a file hold the light that an eye needs.

use crate::spectrum::{Band, Bands};

/// Visible light, nm: where the CIE tabulates colour matching functions.
const VISIBLE: [f64; 2] = [360.0, 830.0];

/// Where a class of cones has more than a hundredth of its greatest sensitivity, nm (CIE 170-1:2006,
/// 10 degrees, energy units).
const CONES: [(&str, [f64; 2]); 3] =
    [("L", [411.0, 691.0]), ("M", [411.0, 654.0]), ("S", [393.0, 526.0])];

/// Notes on light that a file holds in vain or lacks. The problem of a file without visible light
/// is a message.
pub(super) fn examine(bands: &Bands) -> Result<Vec<String>, String> {
    let bands = bands.as_slice();
    let (first, last) = (bands[0], bands[bands.len() - 1]);
    let reaches = |[from, to]: [f64; 2]| bands.iter().any(|band| band.high > from && band.low < to);
    let outside = |band: &&Band| !(VISIBLE[0]..=VISIBLE[1]).contains(&band.centre);
    let invisible = bands.iter().filter(outside).count();
    if invisible == bands.len() {
        let (from, to) = (first.centre, last.centre);
        return Err(format!("holds no visible light: its bands are at {from} to {to} nm"));
    }
    let mut notes = Vec::new();
    if invisible > 0 {
        let [from, to] = VISIBLE;
        notes.push(format!(
            "{invisible} of its bands lie outside {from} to {to} nm: no eye sees them"
        ));
    }
    let dark = CONES.iter().filter(|(_, range)| !reaches(*range)).map(|(cone, _)| *cone);
    let dark: Vec<&str> = dark.collect();
    if !dark.is_empty() {
        let (cones, from, to) = (dark.join(" and "), first.low, last.high);
        notes.push(format!(
            "its bands, {from} to {to} nm, leave the {cones} cones in the dark: what they would \
             have seen of this light is not in the file"
        ));
    }
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(centres: &[f64]) -> Result<String, String> {
        examine(&Bands::from_centres(centres).unwrap()).map(|notes| notes.join("; "))
    }

    #[test]
    fn light_that_no_eye_sees_is_refused_and_a_class_in_the_dark_is_named() {
        assert_eq!(told(&[450.0, 550.0, 650.0]).unwrap(), "");
        assert!(told(&[900.0, 1050.0, 1200.0]).unwrap_err().contains("900 to 1200 nm"));
        assert!(told(&[600.0, 650.0, 700.0]).unwrap().contains("leave the S cones in the dark"));
        assert!(told(&[690.0, 700.0, 710.0]).unwrap().contains("leave the M and S cones"));
        assert!(told(&[450.0, 550.0, 650.0, 900.0]).unwrap().starts_with("1 of its bands"));
    }
}
