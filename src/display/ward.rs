//! Histogram adjustment.
//!
//! ```text
//! ln Ld = ln Ldmin + (ln Ldmax - ln Ldmin) P(ln Lw)        P: cumulative share of cells, linear within a bin
//! linear ceiling:  f(b) <= T db / ln(Ldmax/Ldmin)
//! human ceiling:   f(b) <= T db / ln(Ldmax/Ldmin) [dLt(Ld)/Ld] / [dLt(Lw)/Lw]
//! ```
//!
//! f: count of a bin, db: its width in ln Lw, T: total count, dLt: the least luminance step an
//! adapted eye can see. Bins are trimmed to their ceiling and the map is made anew until a pass
//! takes away 2.5 % of T or less. Where little is left, or the world's range fits the display, one
//! scale does.
//!
//! Counts are smoothed over a quarter of a decade or so before, which Ward does not: a halo of few
//! cells would show the contours of single ones.
//!
//! Ward, Rushmeier & Piatko 1997, IEEE TVCG 3(4), 291-306. Bins and limits are those of Radiance's
//! `pcond`.

use super::Ceiling;
use super::histogram::{Histogram, ln_cells, ln_range};
use crate::light::Survey;
use crate::units::Nits;

/// Share of the total that may stand above the ceiling when trimming ends.
const TOLERANCE: f64 = 0.025;

/// Passes of smoothing. A halo holds few cells: counted as they are, they would draw contours into it.
const PASSES: usize = 3;

/// The map of one frame, with ln of the display's black and white.
#[derive(Clone, Debug)]
pub(super) enum Adjustment {
    /// Display luminance is world luminance times e to this, up to white.
    Scale(f64, (f64, f64)),
    Histogram(Histogram, (f64, f64)),
}

impl Adjustment {
    pub(crate) fn new(survey: &Survey, ceiling: Ceiling, black: Nits, white: Nits) -> Self {
        Adjustment::smoothed(survey, ceiling, black, white, PASSES)
    }

    /// The same after so many passes of smoothing; Ward's own has none.
    fn smoothed(
        survey: &Survey,
        ceiling: Ceiling,
        black: Nits,
        white: Nits,
        passes: usize,
    ) -> Self {
        let display = (black.0.ln(), white.0.ln());
        if survey.greatest <= 0.0 {
            return Adjustment::Scale(0.0, display);
        }
        let fits = f64::from(survey.greatest) / f64::from(survey.least) <= white.0 / black.0;
        let trimmed =
            if fits { None } else { trimmed(Histogram::new(survey, passes), ceiling, display) };
        if let Some(histogram) = trimmed {
            return Adjustment::Histogram(histogram, display);
        }
        let bright = fits && survey.greatest >= white.0 as f32;
        let one = if bright { at_white(survey, display) } else { scale(survey, ceiling, display) };
        Adjustment::Scale(one, display)
    }

    /// ln display luminance of a ln world luminance.
    pub(crate) fn ln_display(&self, ln_world: f64) -> f64 {
        match self {
            Adjustment::Scale(ln_scale, (_, white)) => (ln_world + ln_scale).min(*white),
            Adjustment::Histogram(histogram, display) => equalised(histogram, *display, ln_world),
        }
    }
}

/// ln display luminance by a histogram. Below its range it goes on in proportion, above it is white.
fn equalised(histogram: &Histogram, (black, white): (f64, f64), ln_world: f64) -> f64 {
    if ln_world < histogram.bottom {
        black + ln_world - histogram.bottom
    } else {
        black + (white - black) * histogram.share_below(ln_world)
    }
}

/// A histogram trimmed to its ceiling; `None` when next to nothing is left of it.
fn trimmed(mut histogram: Histogram, ceiling: Ceiling, display: (f64, f64)) -> Option<Histogram> {
    let first_total = histogram.total();
    loop {
        let total = histogram.total();
        if total <= TOLERANCE * first_total {
            return None;
        }
        let most = |i: usize| most(&histogram, ceiling, display, i, total);
        let within: Vec<f64> =
            histogram.counts.iter().enumerate().map(|(i, f)| f.min(most(i))).collect();
        let left: f64 = within.iter().sum();
        if total - left <= TOLERANCE * total {
            return Some(histogram);
        }
        histogram = histogram.with(within);
    }
}

/// The most that bin `i` may hold.
fn most(histogram: &Histogram, ceiling: Ceiling, display: (f64, f64), i: usize, total: f64) -> f64 {
    let linear = total * histogram.bin / (display.1 - display.0);
    match ceiling {
        Ceiling::Linear => linear,
        Ceiling::Human => {
            let centre = histogram.bottom + histogram.bin * (i as f64 + 0.5);
            let shown = equalised(histogram, display, centre).exp();
            linear * (threshold(shown) / shown) / (threshold(centre.exp()) / centre.exp())
        }
    }
}

/// ln of the one scale that puts the greatest pixel at white: for a world brighter than the display
/// that fits its range. What is seen of it once it has bleached is then dim, not black.
fn at_white(survey: &Survey, display: (f64, f64)) -> f64 {
    display.1 - ln_range(survey).1
}

/// ln of the one scale that puts the middle of the display's range where the mean of the frame is:
/// with the human ceiling so that steps are as visible as in the world (Ward 1994), with the linear
/// one at the same place. Never so bright that the greatest pixel exceeds white, unless the least
/// would sink below black.
fn scale(survey: &Survey, ceiling: Ceiling, display: (f64, f64)) -> f64 {
    let (count, sum) = ln_cells(survey).fold((0.0, 0.0), |(n, sum), ln| (n + 1.0, sum + ln));
    let (world, middle) = (sum / f64::max(count, 1.0), (display.0 + display.1) / 2.0);
    let wanted = match ceiling {
        Ceiling::Human => (threshold(middle.exp()) / threshold(world.exp())).ln(),
        Ceiling::Linear => middle - world,
    };
    let (least, greatest) = ln_range(survey);
    wanted.min((display.1 - greatest).max(display.0 - least))
}

/// The least visible step of luminance at an adapting luminance, both cd/m2: the better of rods and
/// cones (Ferwerda, Pattanaik, Shirley & Greenberg 1996, as fitted in Ward et al. 1997).
fn threshold(luminance: f64) -> f64 {
    let x = luminance.log10();
    let log_step = match x {
        x if x < -3.94 => return 1.38e-3,
        x if x < -1.44 => (0.405 * x + 1.6).powf(2.18) - 2.86,
        x if x < -0.0184 => x - 0.395,
        x if x < 1.9 => (0.249 * x + 0.65).powf(2.7) - 0.72,
        x => x - 1.255,
    };
    10f64.powf(log_step)
}

#[cfg(test)]
mod tests {
    use super::super::histogram::BINS;
    use super::*;
    use proptest::prelude::*;

    const WHITE: Nits = Nits(100.0);
    const BLACK: Nits = Nits(1.0);

    fn survey(cells: Vec<f32>, least: f32, greatest: f32) -> Survey {
        Survey { cells, least, greatest, mean: 0.0, edge: 0.0, brightest: (0, 0) }
    }

    fn of(cells: Vec<f32>) -> Survey {
        let least = cells.iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = cells.iter().copied().fold(0.0, f32::max);
        survey(cells, least, greatest)
    }

    /// Columns of the table that Radiance's `pcond` gave for a flat histogram from 10^-2 to 10^4.1
    /// cd/m2.
    fn pcond() -> Vec<[f64; 3]> {
        let lines = include_str!("../../data/ward_flat.csv").lines().skip(2);
        let number = |field: &str| field.parse().expect("a number");
        lines
            .map(|line| {
                line.split(',').map(number).collect::<Vec<f64>>().try_into().expect("three columns")
            })
            .collect()
    }

    #[test]
    fn a_flat_histogram_gets_the_map_that_radiance_gives_it() {
        let flat = survey(
            (0..=60).map(|i| 10f32.powf(-2.0 + 0.1 * i as f32)).collect(),
            0.01,
            10f32.powf(4.1),
        );
        let table = pcond();
        assert_eq!(table.len(), BINS);
        for (ceiling, column) in [(Ceiling::Human, 1), (Ceiling::Linear, 2)] {
            for (passes, near) in [(0, 0.03), (PASSES, 0.1)] {
                let map = Adjustment::smoothed(&flat, ceiling, BLACK, WHITE, passes);
                for row in &table {
                    let display = map.ln_display(row[0].ln()).exp();
                    approx::assert_relative_eq!(display, row[column], max_relative = near);
                }
            }
        }
    }

    /// The steps of a map along a halo around a lamp, relative to those beside them.
    #[test]
    fn a_halo_of_few_cells_has_no_contours() {
        // A dark street, and a lamp whose veil falls with the square of the distance.
        let veil = |r: f64| (0.05 + 400.0 / (r * r)) as f32;
        let cells = (1..40).flat_map(|y| (1..25).map(move |x| f64::from(x * x + y * y).sqrt()));
        let street = survey(cells.map(veil).collect(), 0.05, 1e6);
        let map = Adjustment::new(&street, Ceiling::Human, BLACK, WHITE);
        let along = |i: u32| map.ln_display(f64::from(veil(1.0 + 0.05 * f64::from(i))).ln());
        let falls: Vec<f64> = (0..200).map(|i| along(i) - along(i + 1)).collect();
        for beside in falls.windows(7) {
            let (least, most) =
                beside.iter().fold((f64::INFINITY, 0.0), |(a, b), &f| (f.min(a), f64::max(b, f)));
            assert!(most <= 1.6 * least + 1e-3, "{beside:?}");
        }
    }

    #[test]
    fn the_linear_ceiling_never_shows_more_contrast_than_the_world_has() {
        let cells = (0..3000)
            .map(|i| if i < 2700 { 3e3 + i as f32 / 10.0 } else { 20.0 + i as f32 })
            .collect();
        let map = Adjustment::new(&survey(cells, 10.0, 7e5), Ceiling::Linear, BLACK, WHITE);
        for i in 0..400 {
            let ln = 2.0 + 0.03 * i as f64;
            // The last pass may leave 2.5 % of the total above the ceiling.
            assert!(map.ln_display(ln + 0.15) - map.ln_display(ln) <= 0.15 + 0.03 * f64::ln(100.0));
        }
    }

    #[test]
    fn a_world_that_fits_the_display_is_shown_in_one_scale_and_within_white() {
        for ceiling in [Ceiling::Human, Ceiling::Linear] {
            for (least, greatest) in [(30.0, 2900.0), (0.01, 0.5), (5e4, 5e4)] {
                let map = Adjustment::new(
                    &of(vec![least, (least * greatest).sqrt(), greatest]),
                    ceiling,
                    BLACK,
                    WHITE,
                );
                let ratio =
                    |world: f32| map.ln_display(f64::from(world).ln()) - f64::from(world).ln();
                approx::assert_relative_eq!(ratio(least), ratio(greatest), epsilon = 1e-12);
                assert!(map.ln_display(f64::from(greatest).ln()) <= f64::ln(100.0) + 1e-12);
            }
        }
    }

    #[test]
    fn a_sun_in_a_sky_that_would_fit_the_display_does_not_darken_that_sky() {
        let sky: Vec<f32> = (0..990).map(|i| 1000.0 + 4.0 * i as f32).chain([7e5; 10]).collect();
        for ceiling in [Ceiling::Human, Ceiling::Linear] {
            let map = Adjustment::new(&survey(sky.clone(), 250.0, 7e5), ceiling, BLACK, WHITE);
            assert!(map.ln_display(f64::ln(3000.0)) > f64::ln(10.0));
            assert!(map.ln_display(f64::ln(7e5)) >= f64::ln(100.0) - 1e-12);
        }
    }

    #[test]
    fn a_night_that_is_hard_to_see_is_shown_dark_under_the_human_ceiling() {
        let night = of(vec![1e-3, 1e-2, 5e-2]);
        let shown = |ceiling| {
            Adjustment::new(&night, ceiling, BLACK, WHITE).ln_display(f64::ln(0.01)).exp()
        };
        assert!(shown(Ceiling::Human) < 0.5 * shown(Ceiling::Linear));
    }

    #[test]
    fn the_pieces_of_the_threshold_meet_within_the_rounding_of_their_coefficients() {
        for x in [-3.94, -1.44, -0.0184, 1.9] {
            let (below, above) = (threshold(10f64.powf(x - 1e-9)), threshold(10f64.powf(x + 1e-9)));
            approx::assert_relative_eq!(below, above, max_relative = 0.03);
        }
        approx::assert_relative_eq!(threshold(1000.0), 10f64.powf(1.745), max_relative = 1e-12);
    }

    proptest! {
        #[test]
        fn any_histogram_gives_a_rising_map_from_black_to_white(
            logs in prop::collection::vec(-8f32..12.0, 1..300), human in any::<bool>()
        ) {
            let ceiling = if human { Ceiling::Human } else { Ceiling::Linear };
            let map = Adjustment::new(&of(logs.iter().map(|x| 10f32.powf(*x)).collect()), ceiling, BLACK, WHITE);
            let levels: Vec<f64> = (0..2000).map(|i| map.ln_display(-25.0 + 0.03 * f64::from(i))).collect();
            prop_assert!(levels.is_sorted());
            prop_assert!(levels.iter().all(|v| v.is_finite() && *v <= f64::ln(100.0) + 1e-12));
        }
    }
}
