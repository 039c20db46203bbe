//! The pyramid again, in double precision and as plainly as it can be written.

use super::gaussians::Gaussians;
use super::levels::{BINOMIAL, Depth, HALF, Placed, VARIANCE};
use super::shape::MARGIN;
use crate::light::Planes;

/// One level: places from -[`MARGIN`] on.
struct Level {
    size: [i64; 2],
    samples: Vec<f64>,
}

impl Level {
    fn of(size: [i64; 2], value: impl Fn(i64, i64) -> f64) -> Level {
        let margin = MARGIN as i64;
        let columns = || -margin..size[0] + margin;
        let rows = -margin..size[1] + margin;
        let samples = rows.flat_map(|y| columns().map(move |x| (x, y)));
        Level { size, samples: samples.map(|(x, y)| value(x, y)).collect() }
    }

    fn at(&self, x: i64, y: i64) -> f64 {
        let margin = MARGIN as i64;
        let [x, y] = [x + margin, y + margin];
        let [width, height] = self.size.map(|n| n + 2 * margin);
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        if inside { self.samples[(y * width + x) as usize] } else { 0.0 }
    }

    fn reduced(&self) -> Level {
        let taps = || (-HALF..=HALF).map(|k| (k, BINOMIAL[k.unsigned_abs() as usize]));
        Level::of(self.size.map(|n| (n + 1) / 2), |x, y| {
            let row = |v: i64| taps().map(|(u, b)| b * self.at(2 * x + u, v)).sum::<f64>();
            taps().map(|(v, b)| b * row(2 * y + v)).sum()
        })
    }

    /// The value that this level gives a place of the finer one.
    fn expanded(&self, x: i64, y: i64) -> f64 {
        let near = |x: i64| {
            let cells = (x - HALF).div_euclid(2)..=(x + HALF).div_euclid(2) + 1;
            let tap = move |c: i64| BINOMIAL.get((x - 2 * c).unsigned_abs() as usize).copied();
            cells.filter_map(move |c| tap(c).map(|b| (c, 2.0 * b)))
        };
        let row = |v: i64| near(x).map(|(u, b)| b * self.at(u, v)).sum::<f64>();
        near(y).map(|(v, b)| b * row(v)).sum()
    }

    fn blurred(&self, gaussian: &Placed) -> Level {
        let radius = gaussian.taps.len() as i64 - 1;
        let taps = || (-radius..=radius).map(|k| (k, gaussian.taps[k.unsigned_abs() as usize]));
        let along = Level::of(self.size, |x, y| taps().map(|(u, t)| t * self.at(x + u, y)).sum());
        Level::of(self.size, |x, y| {
            gaussian.weight * taps().map(|(v, t)| t * along.at(x, y + v)).sum::<f64>()
        })
    }
}

/// K s of a picture of one plane, place by place.
pub(super) fn veil_in_double(sum: &Gaussians, depth: &Depth, s: &Planes) -> Vec<f64> {
    let size = [s.width as i64, s.height as i64];
    let placed = depth.place(sum);
    let top = placed.iter().map(|gaussian| gaussian.level).max().unwrap_or(0);
    let inside = |x: i64, y: i64| (0..size[0]).contains(&x) && (0..size[1]).contains(&y);
    let of_place = |x, y| if inside(x, y) { s.at(x as usize, y as usize, 0) } else { 0.0 };
    let mut levels = vec![Level::of(size, of_place)];
    while levels.len() <= top {
        levels.extend(levels.last().map(Level::reduced));
    }
    let mut veil = whole(sum, &levels[top], top);
    for (level, light) in levels.iter().enumerate().rev() {
        if level < top {
            veil = Level::of(light.size, |x, y| veil.expanded(x, y));
        }
        for gaussian in placed.iter().filter(|gaussian| gaussian.level == level) {
            let blurred = light.blurred(gaussian);
            veil.samples.iter_mut().zip(blurred.samples).for_each(|(sum, v)| *sum += v);
        }
    }
    let rows = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    rows.map(|(x, y)| veil.at(x, y)).collect()
}

/// What every place of the coarsest level gets from all: the constant and the square, place by
/// place.
fn whole(sum: &Gaussians, light: &Level, top: usize) -> Level {
    let scale = 4f64.powi(top as i32);
    let constant = sum.constant - sum.quadratic * 4.0 * VARIANCE * (scale - 1.0) / 3.0;
    let margin = MARGIN as i64;
    let width = light.size[0] + 2 * margin;
    Level::of(light.size, |x, y| {
        let of = |(i, here): (usize, &f64)| {
            let [u, v] = [i as i64 % width - margin - x, i as i64 / width - margin - y];
            let square = scale * (u * u + v * v) as f64;
            scale * here * (constant + sum.quadratic * square)
        };
        light.samples.iter().enumerate().map(of).sum()
    })
}
