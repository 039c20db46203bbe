//! From percept to picture: how bright, which colours, which bytes.
//!
//! ```text
//! unbleached light -> Survey -> ToneMap -> (smoothed in time)
//! percept -> luminance Y -> share of white (Ld - Ldmin)/(Ldmax - Ldmin) -> gamut -> sRGB, 8 bit
//! ```
//!
//! The map is built from the light *before* bleaching and follows it slowly: a map rebuilt each
//! frame from the bleached picture would undo the very dimming it should show. Luminances in cd/m2.
//!
//! Tone reproduction: Ward, Rushmeier & Piatko 1997, IEEE TVCG 3(4), 291-306, or a fixed exposure.
//! This room knows no file, no configuration and no eye.

mod encode;
mod gamut;
mod histogram;
mod row;
mod screen;
mod tone;
mod ward;

pub use screen::Screen;
pub use tone::ToneMap;

use serde::{Deserialize, Serialize};

use crate::kernel;
use crate::light::Survey;
use crate::units::{Nits, Seconds};

/// What bounds the contrast of a histogram adjustment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Ceiling {
    /// No step of the world that an observer there could not see becomes visible on the display.
    #[default]
    Human,
    /// The display never shows more contrast than the world has.
    Linear,
}

/// How world luminance becomes display luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tone {
    /// Histogram adjustment, Ward et al. 1997.
    Ward(Ceiling),
    /// World luminance times 2^ev, whatever the frame holds.
    Exposure { ev: f64 },
}

/// A display and how pictures are brought onto it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// Luminance of the display's white.
    pub(crate) white: Nits,
    pub(crate) tone: Tone,
    /// Time constant of the map: 0 follows each frame, infinity pins it to the first.
    pub(crate) smoothing: Seconds,
    /// Colours brighter than the display: 0 keeps their hue, 1 their luminance.
    pub(crate) highlights: f64,
}

/// Luminance of linear sRGB: the Y row of its matrix to XYZ (IEC 61966-2-1, D65 at .3127, .3290).
const LUMINANCE: [f32; 3] = [0.212_639, 0.715_168_7, 0.072_192_32];

impl Default for Display {
    fn default() -> Self {
        Display {
            white: Nits(100.0),
            tone: Tone::Ward(Ceiling::Human),
            smoothing: Seconds(0.5),
            highlights: 0.5,
        }
    }
}

impl Display {
    /// White over black under Ward's adjustment: what a good display shows in a dim room (Ward et
    /// al. 1997).
    const CONTRAST: f64 = 100.0;

    /// Luminance of the display's black. A fixed exposure takes it as none.
    fn black(&self) -> Nits {
        match self.tone {
            Tone::Ward(_) => Nits(self.white.0 / Self::CONTRAST),
            Tone::Exposure { .. } => Nits(0.0),
        }
    }

    /// The map of the frame that lasts `dt`, after the map of the frame before.
    ///
    /// Log display luminance approaches that of the frame's own map exponentially, at every world
    /// luminance alike; a frame without light changes nothing, and a fixed exposure has nothing to
    /// follow.
    pub fn follow(&self, previous: Option<&ToneMap>, survey: &Survey, dt: Seconds) -> ToneMap {
        let (Some(previous), Tone::Ward(_)) = (previous, self.tone) else {
            return self.map(survey);
        };
        let share = if self.smoothing.0 > 0.0 { -(-dt.0 / self.smoothing.0).exp_m1() } else { 1.0 };
        if share > 0.0 && survey.greatest > 0.0 {
            previous.toward(self.map(survey), share)
        } else {
            previous.clone()
        }
    }

    /// A map from the levels that [`ToneMap::levels`] gave, bit for bit; `None` where they are no
    /// map's.
    pub(crate) fn restore(&self, levels: Vec<f64>) -> Option<ToneMap> {
        ToneMap::from_levels(levels, self.black(), self.white)
    }

    /// Encodes one row of a percept as sRGB: linear sRGB primaries, `scale` cd/m2 the unit; three
    /// bytes a pixel out.
    pub fn encode_row(&self, map: &ToneMap, rgb: [&[f32]; 3], scale: f32, out: &mut [u8]) {
        let (weights, highlights) = (LUMINANCE, self.highlights as f32);
        kernel::vectorised(row::Encode { map, rgb, scale, weights, highlights, out });
    }

    /// The map of one frame by itself.
    fn map(&self, survey: &Survey) -> ToneMap {
        match self.tone {
            Tone::Exposure { ev } => ToneMap::tabulate(self.black(), self.white, |ln_world| {
                ln_world + ev * std::f64::consts::LN_2
            }),
            Tone::Ward(ceiling) => {
                let ward = ward::Adjustment::new(survey, ceiling, self.black(), self.white);
                ToneMap::tabulate(self.black(), self.white, |ln_world| ward.ln_display(ln_world))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn survey(cells: Vec<f32>) -> Survey {
        let (least, greatest) =
            cells.iter().fold((f32::INFINITY, 0f32), |(low, high), &c| (low.min(c), high.max(c)));
        let mean = cells.iter().copied().map(f64::from).sum::<f64>() / cells.len() as f64;
        Survey { cells, least, greatest, mean, edge: 0.0, brightest: (0, 0) }
    }

    fn indoors() -> Survey {
        survey((0..2000).map(|i| 10f32.powf(i as f32 / 800.0 - 0.5)).collect())
    }

    fn outdoors() -> Survey {
        survey((0..2000).map(|i| 10f32.powf(i as f32 / 400.0 + 1.0)).collect())
    }

    fn ln_at(map: &ToneMap, world: f64) -> f64 {
        map.display_luminance(Nits(world)).0.ln()
    }

    fn pixel(display: &Display, map: &ToneMap, rgb: [f32; 3]) -> [u8; 3] {
        let mut out = [0; 3];
        display.encode_row(map, [&rgb[..1], &rgb[1..2], &rgb[2..]], 1.0, &mut out);
        out
    }

    #[test]
    fn a_step_of_light_is_followed_exponentially_in_log_however_time_is_cut() {
        let display = Display::default();
        let (before, after) = (display.map(&indoors()), display.map(&outdoors()));
        let mut map = before.clone();
        for n in 1..=20 {
            map = display.follow(Some(&map), &outdoors(), Seconds(0.1));
            let left = (-0.1 * n as f64 / 0.5).exp();
            for level in [0, 1000, 3000, 7000] {
                let expected =
                    after.levels()[level] + left * (before.levels()[level] - after.levels()[level]);
                approx::assert_relative_eq!(map.levels()[level], expected, epsilon = 1e-12);
            }
        }
        let at_once = display.follow(Some(&before), &outdoors(), Seconds(2.0));
        for world in [0.01, 1.0, 30.0, 1e3, 1e6] {
            approx::assert_relative_eq!(ln_at(&map, world), ln_at(&at_once, world), epsilon = 1e-9);
        }
    }

    #[test]
    fn no_time_changes_nothing_no_smoothing_follows_at_once_and_endless_smoothing_pins() {
        let display = Display::default();
        let first = display.follow(None, &indoors(), Seconds(0.04));
        assert_eq!(display.follow(Some(&first), &outdoors(), Seconds(0.0)), first);
        let instant = Display { smoothing: Seconds(0.0), ..display };
        assert_eq!(
            instant.follow(Some(&first), &outdoors(), Seconds(0.0)),
            display.map(&outdoors())
        );
        let pinned = Display { smoothing: Seconds(f64::INFINITY), ..display };
        assert_eq!(pinned.follow(Some(&first), &outdoors(), Seconds(1e9)), first);
    }

    #[test]
    fn a_frame_without_light_keeps_the_map_and_comes_out_black() {
        let display = Display { smoothing: Seconds(0.0), ..Display::default() };
        let map = display.map(&outdoors());
        let dark = survey(vec![0.0; 10]);
        assert_eq!(
            display.follow(Some(&map), &Survey { least: 0.0, ..dark.clone() }, Seconds(1.0)),
            map
        );
        let first = display.follow(None, &Survey { least: 0.0, ..dark }, Seconds(1.0));
        assert_eq!(pixel(&display, &first, [0.0; 3]), [0; 3]);
    }

    #[test]
    fn a_checkpointed_map_comes_back_bit_for_bit_and_a_damaged_one_does_not() {
        let display = Display::default();
        let map = display.follow(Some(&display.map(&indoors())), &outdoors(), Seconds(0.04));
        assert_eq!(display.restore(map.levels().to_vec()).as_ref(), Some(&map));
        assert_eq!(display.restore(map.levels()[1..].to_vec()), None);
        let mut damaged = map.levels().to_vec();
        damaged[500] = f64::NAN;
        assert_eq!(display.restore(damaged), None);
    }

    #[test]
    fn an_exposure_multiplies_by_a_power_of_two_and_never_changes() {
        let display = Display { tone: Tone::Exposure { ev: 1.0 }, ..Display::default() };
        let map = display.follow(None, &indoors(), Seconds(1.0));
        for world in [1e-9, 0.02, 1.0, 12.34, 5e4] {
            approx::assert_relative_eq!(
                map.display_luminance(Nits(world)).0,
                2.0 * world,
                max_relative = 1e-12
            );
        }
        assert_eq!(display.follow(Some(&map), &outdoors(), Seconds(1.0)), map);
        assert_eq!(pixel(&display, &map, [50.0; 3]), [255; 3]);
        assert_eq!(pixel(&display, &map, [25.0, 0.0, 0.0]), [188, 0, 0]);
    }

    #[test]
    fn black_and_white_of_the_display_are_the_ends_of_the_code() {
        let display = Display::default();
        let world = outdoors();
        let map = display.map(&world);
        assert_eq!(pixel(&display, &map, [world.greatest; 3]), [255; 3]);
        assert!(pixel(&display, &map, [world.least; 3])[0] < 9);
        assert_eq!(pixel(&display, &map, [world.least * 1e-3; 3]), [0; 3]);
        assert_eq!(pixel(&display, &map, [f32::MAX; 3]), [255; 3]);
    }

    #[test]
    fn a_bleached_field_is_dim_and_ever_darker_and_never_black() {
        let display = Display::default();
        for field in [300.0f32, 1e4, 1e6, 1e9] {
            let map = display.map(&survey(vec![field; 1000]));
            let seen = (0..=44).map(|i| field * 0.905f32.powi(i));
            let codes: Vec<u8> = seen.map(|y| pixel(&display, &map, [y; 3])[0]).collect();
            assert_eq!(codes[0], 255);
            assert!(codes.windows(2).all(|w| w[0] > w[1]) && codes[44] > 0, "{codes:?}");
        }
    }

    #[test]
    fn a_small_lamp_is_told_from_the_white_wall_beside_it() {
        let display = Display::default();
        let mut room: Vec<f32> = (0..2000).map(|i| 1.0 + 0.05 * i as f32).collect();
        room.push(9e5);
        let map = display.map(&survey(room));
        let [wall, lamp] = [100.0, 9e5].map(|y| pixel(&display, &map, [y; 3])[0]);
        assert!(lamp == 255 && wall < 245, "{wall} {lamp}");
    }

    #[test]
    fn a_row_has_one_pixel_for_three_bytes_and_is_scaled_to_nits() {
        let display = Display { tone: Tone::Exposure { ev: 0.0 }, ..Display::default() };
        let map = display.map(&indoors());
        let (red, green, blue) = ([0.1, 0.2], [0.1, 0.0], [0.1, 0.0]);
        let mut out = [9; 6];
        display.encode_row(&map, [&red, &green, &blue], 100.0, &mut out);
        assert_eq!(out, [89, 89, 89, 124, 0, 0]);
    }

    #[test]
    fn a_low_sun_at_the_white_of_the_display_is_still_orange_red_then_yellow_then_green() {
        let display = Display::default();
        let map = display.map(&outdoors());
        // Linear sRGB of the percept after 0, 1 and 2 s, at the greatest luminance of the frame or
        // more.
        let seen = |rgb: [f32; 3]| pixel(&display, &map, rgb.map(|c| c * 4e6));
        let [red, yellow, green] =
            [[3.9, 0.36, -0.2], [2.2, 0.8, -0.3], [-0.6, 1.6, 0.17]].map(seen);
        assert!(red[0] == 255 && red[1] < 150 && red[2] < red[1], "{red:?}");
        assert!(yellow[0] == 255 && yellow[1] > 180 && yellow[2] < 120, "{yellow:?}");
        assert!(green[1] == 255 && green[0] < 120 && green[2] < 200, "{green:?}");
    }

    proptest! {
        #[test]
        fn greys_stay_grey_and_brighter_is_never_darker(ln in -20f32..30.0, step in 0f32..3.0, highlights in 0.0..=1.0) {
            let display = Display { highlights, ..Display::default() };
            let map = display.map(&outdoors());
            let (dark, bright) = (pixel(&display, &map, [ln.exp(); 3]), pixel(&display, &map, [(ln + step).exp(); 3]));
            prop_assert!(dark[0] == dark[1] && dark[1] == dark[2]);
            prop_assert!((0..3).all(|i| bright[i] >= dark[i]));
        }

        #[test]
        fn any_bits_at_all_come_out_between_black_and_white(
            bits in prop::array::uniform3(any::<u32>()), ev in -100.0..100.0, highlights in 0f32..=1.0
        ) {
            let rgb = bits.map(f32::from_bits);
            for tone in [Tone::Ward(Ceiling::Human), Tone::Exposure { ev }] {
                let map = Display { tone, ..Display::default() }.map(&outdoors());
                let light = gamut::bounded(rgb);
                let luminance = gamut::luminance(light, LUMINANCE);
                let shown = gamut::shown(gamut::chroma(light, luminance), tone::share(&map, luminance), highlights);
                prop_assert!(shown.iter().all(|v| (0.0..=1.000_001).contains(v)), "{rgb:?} gives {shown:?}");
            }
        }
    }
}
