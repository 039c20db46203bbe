//! A monotone map from world to display luminance, tabulated so that maps can be mixed and read
//! fast.
//!
//! ```text
//! ln Ld at 128 luminances to the octave from 2^-20 to 2^40 cd/m2: the bfloat16 numbers of that range
//! ```
//!
//! All maps share these luminances, so that maps of frames with different ranges mix knot by knot,
//! and a map that is mixed frame after frame never blurs. Between two knots Ld is linear in Lw;
//! below the first it is proportional, above the last it stays. Against a curve of slope s in
//! log-log that bends by ds at a point, the relative error is at most |s (s - 1)| 8e-6 + ds / 500.

use crate::units::Nits;

/// How world luminance becomes display luminance, both cd/m2.
#[derive(Clone, Debug, PartialEq)]
pub struct ToneMap {
    black: f64,
    white: f64,
    /// ln Ld at each knot.
    levels: Vec<f64>,
    /// (Ld - black) / (white - black) at each knot, and in proportion to Ld below [`TOE`].
    shares: Vec<f32>,
}

/// Display luminance, over its black, below which a pixel is shown in proportion to it: what is
/// darker than all of the world, as a bleached field is, goes on getting darker instead of black.
const TOE: f64 = 1.25;

/// log2 of the first and last knot.
const FIRST: i32 = -20;
const LAST: i32 = 40;

/// Knots to the octave: 2 to this.
const OCTAVE_BITS: u32 = 7;

/// Upper half of the bits of the first knot as an f32.
const BASE: u32 = ((127 + FIRST) as u32) << OCTAVE_BITS;
const KNOTS: usize = (((LAST - FIRST) as usize) << OCTAVE_BITS) + 1;

/// World luminance of knot `i`.
fn knot(i: usize) -> f64 {
    f64::from(f32::from_bits((BASE + i as u32) << 16))
}

impl ToneMap {
    /// The first knot, 2^-20 cd/m2: an absolute threshold of vision.
    pub(crate) const LEAST: f64 = 1.0 / (1 << -FIRST) as f64;
    /// The last knot, 2^40 cd/m2: 700 times the sun.
    pub(crate) const GREATEST: f64 = (1u64 << LAST) as f64;

    /// Tabulates a curve that never falls, from ln Lw to ln Ld.
    pub(super) fn tabulate(black: Nits, white: Nits, curve: impl Fn(f64) -> f64) -> Self {
        Self::with((0..KNOTS).map(|i| curve(knot(i).ln())).collect(), black.0, white.0)
    }

    /// The map with these levels; `None` unless they are as many as there are knots, finite, and
    /// never fall.
    pub(super) fn from_levels(levels: Vec<f64>, black: Nits, white: Nits) -> Option<Self> {
        let sound =
            levels.len() == KNOTS && levels.iter().all(|v| v.is_finite()) && levels.is_sorted();
        sound.then(|| Self::with(levels, black.0, white.0))
    }

    fn with(levels: Vec<f64>, black: f64, white: f64) -> Self {
        // Shares beyond 1e9 white are all the same to the display, and products of them stay
        // finite.
        let share = |ln_display: &f64| {
            let (shown, toe) = (ln_display.exp(), TOE * black);
            let share = (shown.max(toe) - black) / (white - black);
            (share * (shown / toe.max(f64::MIN_POSITIVE)).min(1.0)).clamp(0.0, 1e9) as f32
        };
        let shares = levels.iter().map(share).collect();
        ToneMap { black, white, levels, shares }
    }

    /// ln display luminance at each knot: all that a map remembers. Give it to
    /// `super::Display::restore`.
    pub fn levels(&self) -> &[f64] {
        &self.levels
    }

    /// This map, gone the `share` of the way to another in ln Ld.
    pub(super) fn toward(&self, other: ToneMap, share: f64) -> ToneMap {
        if share >= 1.0 {
            return other;
        }
        let mix = |(old, new): (&f64, &f64)| old * (1.0 - share) + new * share;
        Self::with(
            self.levels.iter().zip(&other.levels).map(mix).collect(),
            other.black,
            other.white,
        )
    }

    /// World luminances in, out the shares of the display's range from black to white that they get;
    /// never negative or NaN.
    #[inline(always)]
    pub(super) fn share_each<const N: usize>(&self, lights: &mut [f32; N]) {
        let (mut knots, mut ends) = ([0; N], [[0.0; N]; 2]);
        let bits = |world: f32| {
            world.max(Self::LEAST as f32).min(Self::GREATEST as f32 * 0.999_999).to_bits()
        };
        for (knot, world) in knots.iter_mut().zip(&*lights) {
            *knot = (bits(*world) >> 16) - BASE;
        }
        let [low, high] = &mut ends;
        for ((low, high), knot) in low.iter_mut().zip(high).zip(knots) {
            let shares = &self.shares[knot as usize..][..2];
            [*low, *high] = [shares[0], shares[1]];
        }
        for i in 0..N {
            let (world, [low, high]) = (lights[i], [ends[0][i], ends[1][i]]);
            let share = low + (high - low) * ((bits(world) & 0xffff) as f32 / 65536.0);
            lights[i] = share * (world * (1 << -FIRST) as f32).clamp(0.0, 1.0);
        }
    }
}

/// The share of one luminance.
#[cfg(test)]
pub(super) fn share(map: &ToneMap, world: f32) -> f32 {
    let mut share = [world];
    map.share_each(&mut share);
    share[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    impl ToneMap {
        /// Display luminance of a world luminance. No light, or less than none, is dark.
        pub(crate) fn display_luminance(&self, world: Nits) -> Nits {
            let level = |i: usize| self.levels[i].exp();
            Nits(match world.0 {
                w if w >= Self::GREATEST => level(KNOTS - 1),
                w if w >= Self::LEAST => {
                    let i = (((w as f32).to_bits() >> 16) - BASE) as usize;
                    let i = if knot(i) > w { i - 1 } else { i };
                    level(i) + (level(i + 1) - level(i)) * (w - knot(i)) / (knot(i + 1) - knot(i))
                }
                w if w > 0.0 => level(0) * (w / Self::LEAST),
                _ => 0.0,
            })
        }
    }

    /// Slopes of 1, 3 and 0, from 1 to 100 cd/m2.
    fn bent(ln_world: f64) -> f64 {
        (if ln_world < 2.0 { ln_world - 2.0 } else { 3.0 * (ln_world - 2.0) }).min(f64::ln(100.0))
    }

    fn map() -> ToneMap {
        ToneMap::tabulate(Nits(1.0), Nits(100.0), bent)
    }

    #[test]
    fn the_table_is_as_near_to_its_curve_as_the_head_of_the_module_says() {
        let map = map();
        let off = |ln: f64| (map.display_luminance(Nits(ln.exp())).0.ln() - bent(ln)).abs();
        let worst = (0..200_000).map(|i| off(-13.0 + 0.0002 * f64::from(i))).fold(0.0, f64::max);
        assert!(worst <= 6.0 * 8e-6 + 3.0 / 500.0, "{worst}");
        assert!(off(2.5) <= 6.0 * 8e-6, "{}", off(2.5));
    }

    #[test]
    fn below_its_first_knot_a_map_is_proportional_and_above_its_last_it_stays() {
        let map = map();
        let at = |world| map.display_luminance(Nits(world)).0;
        approx::assert_relative_eq!(at(1e-9), at(1e-8) / 10.0, max_relative = 1e-12);
        assert_eq!(at(1e13), at(1e300));
        assert_eq!((at(0.0), at(-3.0)), (0.0, 0.0));
    }

    #[test]
    fn a_falling_or_endless_curve_is_no_map() {
        let mut levels = map().levels().to_vec();
        levels[0] = f64::NEG_INFINITY;
        assert_eq!(ToneMap::from_levels(levels.clone(), Nits(1.0), Nits(100.0)), None);
        levels[0] = levels[1] + 1.0;
        assert_eq!(ToneMap::from_levels(levels, Nits(1.0), Nits(100.0)), None);
    }

    proptest! {
        #[test]
        fn pixels_are_mapped_as_numbers_are(world in any::<f32>()) {
            prop_assume!(world.is_finite());
            let map = map();
            let shown = map.display_luminance(Nits(f64::from(world))).0;
            let expected = (shown.max(TOE) - 1.0) / 99.0 * (shown / TOE).min(1.0);
            // Where black lies between two knots, the table's line starts at the lower one.
            prop_assert!((f64::from(share(&map, world)) - expected.max(0.0)).abs() <= 2e-5);
        }

        #[test]
        fn mixtures_of_maps_rise(share in 0.0..=1.0, shift in -10.0..10.0) {
            let other = ToneMap::tabulate(Nits(1.0), Nits(100.0), |ln| bent(ln + shift));
            prop_assert!(map().toward(other, share).levels().is_sorted());
        }
    }
}
