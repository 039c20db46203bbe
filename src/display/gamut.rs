//! Bringing a colour into what a display can show.
//!
//! A colour is linear RGB in the sRGB primaries. Strongly bleached cones see colours that no light
//! has: those move toward the grey of the same luminance until no component is negative,
//!
//! ```text
//! c' = Y + (c - Y) Y / (Y - min c)
//! ```
//!
//! and never by clipping one channel, which would change hue and luminance. Colours brighter than
//! the display come in between two ways, by the display's `highlights` h:
//!
//! ```text
//! (1 - h^3) hue + h^3 white        hue = c / max c,  white = Y + (c - Y) (1 - Y) / (max c - Y), at most 1
//! ```
//!
//! The eye judges admixed white by about the cube root of its amount (CIE 1976 lightness), so that
//! half way looks half way; mixed as light, half white turns a red sun to a pink that is lost in
//! its sky.

/// Less than this is no light at all, cd/m2; keeps quotients finite.
const DARK: f32 = 1e-30;

/// More than this is as good as infinite, cd/m2; keeps sums finite.
const GLARE: f32 = 1e30;

/// Limits a colour to finite numbers that can be added and multiplied.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "clamp would let NaN pass")]
pub(super) fn bounded(light: [f32; 3]) -> [f32; 3] {
    light.map(|c| c.max(-GLARE).min(GLARE))
}

/// Luminance by the weights of the observer, in the unit of the components.
#[inline(always)]
pub(super) fn luminance([r, g, b]: [f32; 3], weights: [f32; 3]) -> f32 {
    weights[0] * r + weights[1] * g + weights[2] * b
}

/// The colour at unit luminance, without negative components; grey where there is no luminance.
#[inline(always)]
pub(super) fn chroma(light: [f32; 3], luminance: f32) -> [f32; 3] {
    let least = light[0].min(light[1]).min(light[2]).min(0.0);
    let kept = if luminance > DARK { 1.0 / (luminance - least) } else { 0.0 };
    light.map(|c| (1.0 + (c - luminance) * kept).max(0.0))
}

/// Linear RGB in 0..=1 that shows a colour of unit luminance at the given share of white.
#[inline(always)]
pub(super) fn shown(colour: [f32; 3], share: f32, highlights: f32) -> [f32; 3] {
    let wanted = colour.map(|c| c * share);
    let most = wanted[0].max(wanted[1]).max(wanted[2]).max(1.0);
    let grey = share.min(1.0);
    // Both factors are 1 for a colour that needs nothing.
    let (scaled, kept) = (1.0 / most, (1.0 - grey) / (most - grey).max(f32::MIN_POSITIVE));
    let whiteness = highlights * highlights * highlights;
    wanted.map(|c| {
        let (hue, white) = (c * scaled, grey + (c - grey) * kept);
        hue + whiteness * (white - hue)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn luminance(light: [f32; 3]) -> f32 {
        super::luminance(light, crate::display::LUMINANCE)
    }

    fn colour() -> impl Strategy<Value = [f32; 3]> {
        prop::array::uniform3(-10f32..30.0).prop_filter("luminance", |c| luminance(*c) > 0.1)
    }

    #[test]
    fn without_luminance_there_is_neither_colour_nor_light() {
        for light in [[0.0; 3], [-1.0; 3], [0.1, -5.0, 3.0], [-0.0; 3]] {
            assert_eq!(chroma(light, luminance(light)), [1.0; 3]);
            assert_eq!(shown(chroma(light, luminance(light)), 0.0, 0.5), [0.0; 3]);
        }
    }

    #[test]
    fn a_colour_of_the_gamut_keeps_its_proportions() {
        let light = [6.0, 2.0, 0.0];
        let unit = chroma(light, luminance(light));
        for (c, l) in unit.iter().zip(light) {
            approx::assert_relative_eq!(c * luminance(light), l, epsilon = 1e-6);
        }
    }

    #[test]
    fn highlights_go_from_their_hue_to_white() {
        let red = chroma([1.0, 0.1, 0.0], luminance([1.0, 0.1, 0.0]));
        let of_hue = shown(red, 1.0, 0.0);
        approx::assert_relative_eq!(of_hue[1], 0.1, max_relative = 1e-5);
        approx::assert_relative_eq!(of_hue[0], 1.0, max_relative = 1e-6);
        for v in shown(red, 1.0, 1.0) {
            approx::assert_relative_eq!(v, 1.0, max_relative = 1e-6);
        }
    }

    proptest! {
        #[test]
        fn colours_outside_the_gamut_go_to_grey_no_further_than_they_must(light in colour()) {
            let y = luminance(light);
            let unit = chroma(light, y);
            prop_assert!(unit.iter().all(|c| *c >= 0.0));
            prop_assert!((luminance(unit) - 1.0).abs() < 1e-4);
            let least = light.iter().copied().fold(0.0, f32::min);
            for i in 0..3 {
                // On the line from the colour to grey, and on the edge of the gamut where it was
                // outside.
                prop_assert!(((unit[i] - 1.0) * (y - least) - (light[i] - y)).abs() < 1e-3);
                prop_assert!(least == 0.0 || light[i] > least || unit[i] < 1e-5);
            }
        }

        #[test]
        fn moving_to_white_keeps_luminance_and_scaling_keeps_ratios(light in colour(), share in 0f32..1.0) {
            let unit = chroma(light, luminance(light));
            prop_assert!((luminance(shown(unit, share, 1.0)) - share).abs() < 1e-4);
            let (scaled, most) = (shown(unit, share, 0.0), unit.iter().copied().fold(0.0, f32::max));
            let factor = share.min(1.0 / most);
            prop_assert!((0..3).all(|i| (scaled[i] - unit[i] * factor).abs() < 1e-5));
        }
    }
}
