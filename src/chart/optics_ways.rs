//! What computing scatter costs and errs: by the pyramid at each depth, beside ways that others
//! take.

use super::Progress;
use super::machine::{RUNS, median, nanoseconds};
use super::transform::Convolution;
use crate::error::{Error, Result};
use crate::light::{Planes, Samples};
use crate::optics::{DEPTHS, Depth, Optics, Psf, Scatter};
use crate::plot::palette::{BLUE, ORANGE, PURPLE, VERMILION};
use crate::plot::{Ink, Marker};

/// A picture of a noon sun over a dark wall, and its width in degrees.
const SIZE: [usize; 2] = [480, 270];
const ACROSS: f64 = 40.0;

/// Every so many pixels on both axes the error is measured.
const STRIDE: usize = 15;

/// A wider pyramid whose Gaussians have three taps: the bloom of games.
const BLOOM: Depth = Depth { low: 1.0, reach: 0.5 };

/// One way to compute scatter.
pub(super) struct Way {
    pub(crate) name: String,
    pub(crate) ink: Ink,
    pub(crate) marker: Marker,
    /// Milliseconds per megapixel of one plane.
    pub(crate) ms_per_megapixel: f64,
    /// The largest relative error at the places.
    pub(crate) error: f64,
    pub(crate) certificate: Option<f64>,
}

/// Light above this is bright, cd/m2.
const BRIGHT: f64 = 5e5;

pub(super) fn cie() -> Scatter {
    Scatter { psf: Psf::Cie, ..Scatter::default() }
}

/// A sun of 1.6e9 cd/m2 in a sky over land, a wall of 25 cd/m2 in it.
fn noon() -> Planes {
    let [width, height] = SIZE;
    let degrees = ACROSS / width as f64;
    let light = |i: usize| {
        let [x, y] = [i % width, i / width].map(|v| v as f64 * degrees);
        let r = (x - 25.0).hypot(y - 6.0);
        match (r, (6.0..12.0).contains(&x) && y > 8.0, y > 15.0) {
            (r, ..) if r < 0.2665 => 1.6e9,
            (_, true, _) => 25.0,
            (_, _, true) => 900.0,
            (r, ..) => 5e3 + 2e4 * (-r / 2.0).exp() + 1e4 * (-r / 10.0).exp(),
        }
    };
    let samples = Samples::Float((0..width * height).map(|i| light(i) as f32).collect());
    Planes { width, height, count: 1, samples }
}

/// r = s (1 - c) + K s at every pixel from a table of the kernel, of the light of some pixels only.
fn direct(kernel: &[f64], from: &[(usize, f64)], at: usize) -> f64 {
    let width = SIZE[0];
    let share = |(i, light): &(usize, f64)| {
        light * kernel[(i / width).abs_diff(at / width) * width + (i % width).abs_diff(at % width)]
    };
    from.iter().map(share).sum()
}

fn places() -> impl Iterator<Item = usize> {
    let rows = (STRIDE / 2..SIZE[1]).step_by(STRIDE);
    rows.flat_map(|y| (STRIDE / 2..SIZE[0]).step_by(STRIDE).map(move |x| y * SIZE[0] + x))
}

fn optics(depth: Depth) -> Result<Optics> {
    let optics = Optics::at_depth(&cie(), SIZE, ACROSS / SIZE[0] as f64, 1, depth);
    optics.map_err(Error::light)?.ok_or_else(|| Error::light("nothing is scattered"))
}

/// A picture and the light on its retina by direct summation.
struct Truth {
    picture: Planes,
    /// The share that goes to a pixel so many columns and rows away.
    kernel: Vec<f64>,
    /// Pixels and their light.
    light: Vec<(usize, f64)>,
    /// The share of its light that each place keeps.
    kept: Vec<f64>,
    retinal: Vec<f64>,
}

impl Truth {
    fn new() -> Result<Truth> {
        let picture = noon();
        let finest = optics(DEPTHS[DEPTHS.len() - 1])?;
        let at = |i: usize| (i % SIZE[0], i / SIZE[0]);
        let pixels = 0..SIZE[0] * SIZE[1];
        let share = |(x, y): (usize, usize)| finest.share(x as f64, y as f64);
        let kernel: Vec<f64> = pixels.clone().map(|i| share(at(i))).collect();
        let of_pixel = |i: usize| (i, picture.at(at(i).0, at(i).1, 0));
        let light: Vec<(usize, f64)> = pixels.clone().map(of_pixel).collect();
        let ones: Vec<(usize, f64)> = pixels.map(|i| (i, 1.0)).collect();
        let kept: Vec<f64> = places().map(|at| 1.0 - direct(&kernel, &ones, at)).collect();
        let of_place = |(at, kept): (usize, &f64)| light[at].1 * kept + direct(&kernel, &light, at);
        let retinal = places().zip(&kept).map(of_place).collect();
        Ok(Truth { picture, kernel, light, kept, retinal })
    }

    /// The largest relative error of what a way finds at a place that keeps a share of its light.
    fn error(&self, found: impl Fn(usize, f64) -> f64) -> f64 {
        let all = places().zip(&self.kept).zip(&self.retinal);
        all.map(|((at, kept), truth)| (found(at, *kept) / truth - 1.0).abs()).fold(0.0, f64::max)
    }

    fn pyramid(&self, name: String, depth: Depth) -> Result<Way> {
        let (mut optics, mut out) = (optics(depth)?, Planes::float(0, 0, 0));
        let ms_per_megapixel = ms(|| optics.exchange(&self.picture, None, &mut out));
        let (ink, marker) =
            if depth == BLOOM { (ORANGE, Marker::Square) } else { (BLUE, Marker::Disc) };
        Ok(Way {
            name,
            ink,
            marker,
            ms_per_megapixel,
            error: self.error(|at, _| out.at(at % SIZE[0], at / SIZE[0], 0)),
            certificate: (depth != BLOOM).then(|| optics.bound()),
        })
    }

    fn bright_pixels(&self) -> Way {
        let bright: Vec<(usize, f64)> =
            self.light.iter().copied().filter(|(_, light)| *light > BRIGHT).collect();
        let veil = |at: usize| direct(&self.kernel, &bright, at);
        let mut sum = 0.0;
        let ms_per_megapixel = ms(|| sum += (0..self.light.len()).map(veil).sum::<f64>());
        std::hint::black_box(sum);
        Way {
            name: format!("only the {} bright pixels", bright.len()),
            ink: VERMILION,
            marker: Marker::Triangle,
            ms_per_megapixel,
            error: self.error(|at, kept| {
                let own = self.light[at].1;
                own * if own > BRIGHT { kept } else { 1.0 } + veil(at)
            }),
            certificate: None,
        }
    }

    fn fourier(&self) -> Way {
        let convolution = Convolution::new(SIZE, |x, y| self.kernel[y * SIZE[0] + x]);
        let single: Vec<f32> = self.light.iter().map(|(_, light)| *light as f32).collect();
        let mut veil = convolution.of(&single);
        Way {
            name: "Fourier transform, single precision".to_owned(),
            ink: PURPLE,
            marker: Marker::Diamond,
            ms_per_megapixel: ms(|| veil = convolution.of(&single)),
            error: self.error(|at, kept| self.light[at].1 * kept + f64::from(veil[at])),
            certificate: None,
        }
    }
}

/// Milliseconds per megapixel of some work on the picture, a median.
fn ms(mut work: impl FnMut()) -> f64 {
    let runs = (0..RUNS).map(|_| nanoseconds(&mut work)).collect();
    median(runs) / (SIZE[0] * SIZE[1]) as f64
}

/// Every way on the same picture.
pub(super) fn ways(progress: Progress) -> Result<Vec<Way>> {
    progress("optics: direct summation");
    let truth = Truth::new()?;
    let names = DEPTHS.iter().map(|depth| (format!("pyramid from {} px", depth.low), *depth));
    let mut ways = Vec::new();
    for (name, depth) in names.chain([("bloom of three taps".to_owned(), BLOOM)]) {
        progress(&format!("optics: {name}"));
        ways.push(truth.pyramid(name, depth)?);
    }
    progress("optics: other ways");
    ways.extend([truth.bright_pixels(), truth.fourier()]);
    Ok(ways)
}
