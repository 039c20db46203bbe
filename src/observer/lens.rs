//! Lens by age: what an older eye passes of the light that the tabulated observer's passes.
//!
//! ```text
//! D(A) = f(A) D_1 + D_2 = D(32) + (f(A) - 1) D_1
//! f = 1 + 0.02 (A - 32) up to 60 years,  1.56 + 0.0667 (A - 60) beyond
//! ```
//!
//! D_1: the part of the density that grows with age; D_2: the part that does not. CIE 170-1:2006,
//! after Pokorny, Smith & Lutze 1987 (Applied Optics 26, 1437-1440). D(32) is the tabulated lens,
//! so nothing but D_1 is needed, and 32 years are the tabulated observer to the last bit. A small
//! pupil, below 3 mm, is meant at every age.

use crate::spectrum::Curve;

use super::fundamentals::lens_density;

/// Age of the tabulated observer, years: the mean of Stiles & Burch's.
pub(crate) const TABULATED_AGE: f64 = 32.0;

/// Ages that the formula holds for, years.
pub(crate) const AGES: (f64, f64) = (20.0, 80.0);

/// D_1 every 5 nm from 390 to 455 nm: the table of CIE 170-1:2006 as Asano's observer model
/// (Asano, Fairchild & Blonde 2016) and pysilsub (Martin et al. 2023) hold it. From 460 nm on D_1
/// is the whole lens. Below 400 nm the table goes on in a straight line; the program of CIE TC 1-97
/// takes less there (0.608 and 0.649 at 390 and 395 nm) and the same from 400 nm on; its splines and
/// these straight lines lie within 2.4 % of each other in the fundamentals up to 80 years.
const AGEING: [f64; 14] = [
    0.809599, 0.735718, 0.661837, 0.587956, 0.530708, 0.468040, 0.427672, 0.393583, 0.372871,
    0.336814, 0.310032, 0.282708, 0.258499, 0.241650,
];

/// Wavelength from which D_1 is the whole lens, nm.
const WHOLE_FROM: usize = 460;

/// D_1 at every wavelength, between the table's entries by straight lines.
fn ageing() -> Curve {
    let mut lens = lens_density();
    let nodes = [&AGEING[..], &[lens.at(WHOLE_FROM)]].concat();
    for (i, density) in lens.0.iter_mut().enumerate().take(WHOLE_FROM - Curve::FROM) {
        let (node, share) = (i / 5, (i % 5) as f64 / 5.0);
        *density = nodes[node] + share * (nodes[node + 1] - nodes[node]);
    }
    lens
}

/// f: how much of D_1 there is, relative to the tabulated observer's.
fn growth(age: f64) -> f64 {
    if age <= 60.0 { 1.0 + 0.02 * (age - TABULATED_AGE) } else { 1.56 + 0.0667 * (age - 60.0) }
}

/// Transmittance of the lens at an age over that of the tabulated observer's.
pub(crate) fn relative_transmittance(age: f64) -> Curve {
    let more = growth(age) - 1.0;
    Curve(ageing().0.iter().map(|density| 10f64.powf(-more * density)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// D(A), from what is passed.
    fn density(age: f64, nm: usize) -> f64 {
        lens_density().at(nm) - relative_transmittance(age).at(nm).log10()
    }

    #[test]
    fn the_two_parts_of_the_table_are_the_tabulated_lens() {
        // D_2 every 5 nm from 400 nm: CIE 170-1:2006, and the program of CIE TC 1-97.
        let steady = [
            1.103063, 0.837744, 0.606672, 0.438260, 0.296308, 0.202137, 0.114729, 0.071286,
            0.031288, 0.017272, 0.004381, 0.002150,
        ];
        let lens = lens_density();
        for (i, d2) in steady.into_iter().enumerate() {
            let (nm, d1) = (400 + 5 * i, AGEING[i + 2]);
            assert!((d1 + d2 - lens.at(nm)).abs() < 1e-9, "{nm} nm: {}", d1 + d2);
        }
    }

    #[test]
    fn the_density_at_an_age_is_the_formula_at_the_tables_wavelengths() {
        // 0.661837 f + 1.103063 at 400 nm; 0.310032 f + 0.031288 at 440 nm; 0.2279 f at 460 nm.
        let ages = [(20.0, 0.76), (32.0, 1.0), (60.0, 1.56), (70.0, 2.227), (80.0, 2.894)];
        for (age, f) in ages {
            let parts = [(400, 0.661837, 1.103063), (440, 0.310032, 0.031288), (460, 0.2279, 0.0)];
            for (nm, d1, d2) in parts {
                let expected = f * d1 + d2;
                assert!((density(age, nm) - expected).abs() < 1e-9, "{age} years, {nm} nm");
            }
        }
    }

    #[test]
    fn an_older_lens_is_darker_the_more_the_shorter_the_wave_and_the_same_in_the_far_red() {
        for (younger, older) in [(20.0, 32.0), (32.0, 45.0), (45.0, 60.0), (60.0, 80.0)] {
            let [more, less] = [older, younger].map(relative_transmittance);
            for nm in Curve::FROM..=Curve::TO {
                let (ratio, next) = (more.at(nm) / less.at(nm), more.at(nm + 1) / less.at(nm + 1));
                assert!(ratio <= next || nm == Curve::TO, "{older} years, {nm} nm");
                assert!(nm > 655 || ratio < 1.0, "{older} years, {nm} nm: {ratio}");
                assert!(nm < 660 || ratio == 1.0, "{older} years, {nm} nm: {ratio}");
            }
            assert!((400..=450).all(|nm| more.at(nm) < 0.9 * less.at(nm)), "{older} years");
        }
    }
}
