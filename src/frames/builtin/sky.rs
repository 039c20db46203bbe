//! The sky around a low sun, painted: luminances in cd/m2 of three lights that were scattered once.
//!
//! Beside the sun 1e3..1e4, elsewhere a hundred or so, for the sun half a degree up; other suns
//! light their sky in proportion to the square root of their own luminance, which joins dusk to
//! noon.

use super::light::Mixture;

/// Luminances of the sky where the sun stands `from_sun` degrees off, `above` the horizon.
pub(super) fn sky(from_sun: f64, above: f64) -> Mixture {
    let low = (-above.max(0.0) / 2.2).exp();
    Mixture {
        ember: 700.0 * (-from_sun / 3.2).exp() * low + 120.0 * low * low,
        gold: 1500.0 * (-from_sun / 0.6).exp() + 1700.0 * (-from_sun / 1.9).exp() + 150.0 * low,
        air: 110.0 + 160.0 * (1.0 - (-from_sun / 1.2).exp()) * (-from_sun / 5.0).exp(),
        ..Mixture::DARK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sky_is_as_bright_as_measured_near_a_low_sun() {
        let at = |from_sun, above| sky(from_sun, above).nits();
        assert!((1e3..1e4).contains(&at(0.3, 0.5)) && (1e3..1e4).contains(&at(1.0, 0.5)));
        assert!((25.0..200.0).contains(&at(20.0, 20.0)));
    }

    #[test]
    fn the_sky_pales_away_from_the_sun_and_turns_to_the_blue_of_air() {
        let steps: Vec<Mixture> =
            (1..40).map(|i| sky(0.2 * f64::from(i), 0.5 + 0.2 * f64::from(i))).collect();
        assert!(steps.windows(2).all(|pair| pair[1].nits() < pair[0].nits()));
        assert!(
            steps
                .windows(2)
                .all(|pair| pair[1].air / pair[1].nits() > pair[0].air / pair[0].nits())
        );
    }
}
