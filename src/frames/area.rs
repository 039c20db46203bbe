//! A smaller picture: each of its pixels is the mean of the area that it covers.

use rayon::prelude::*;

use crate::light::{Planes, Samples};

/// The size of a picture that fits into a square, never larger than it was.
pub(crate) fn size([width, height]: [usize; 2], side: usize) -> [usize; 2] {
    let scale = (side as f64 / width.max(height) as f64).min(1.0);
    [width, height].map(|pixels| ((pixels as f64 * scale).round() as usize).max(1))
}

/// The pixels of a picture that lie under one of a smaller picture, with their shares of it.
pub(crate) fn covered(
    [x, y]: [usize; 2],
    from: [usize; 2],
    to: [usize; 2],
) -> impl Iterator<Item = ([usize; 2], f64)> {
    let [columns, rows] = [0, 1].map(|i| Shares::new(from[i], to[i]));
    let columns: Vec<_> = columns.of(x).collect();
    rows.of(y).flat_map(move |(row, of_row)| {
        let of_row = f64::from(of_row);
        let pixel = move |(column, share): (usize, f32)| ([column, row], of_row * f64::from(share));
        columns.clone().into_iter().map(pixel)
    })
}

/// The means of all planes over the pixels of a smaller picture.
pub(crate) fn reduced(planes: &Planes, [width, height]: [usize; 2]) -> Planes {
    let (columns, rows) = (Shares::new(planes.width, width), Shares::new(planes.height, height));
    let mut means = vec![0.0; width * height * planes.count];
    let scratch =
        || (vec![0.0; planes.width * planes.count], vec![0.0; planes.width * planes.count]);
    means.par_chunks_exact_mut(width * planes.count).enumerate().for_each_init(
        scratch,
        |(sum, light), (y, out)| {
            sum.fill(0.0);
            for (row, share) in rows.of(y) {
                let row = planes.row(row);
                sum.iter_mut().zip(row.as_f32(light)).for_each(|(sum, v)| *sum += share * v);
            }
            for (out, sum) in out.chunks_exact_mut(width).zip(sum.chunks_exact(planes.width)) {
                for (x, out) in out.iter_mut().enumerate() {
                    *out = columns.of(x).map(|(column, share)| share * sum[column]).sum();
                }
            }
        },
    );
    Planes { width, height, count: planes.count, samples: Samples::Float(means) }
}

/// How many pixels along one side share each of fewer pixels.
struct Shares {
    from: f64,
    last: usize,
}

impl Shares {
    fn new(from: usize, to: usize) -> Self {
        Shares { from: from as f64 / to as f64, last: from - 1 }
    }

    /// The pixels that pixel `i` covers, with their shares of it.
    fn of(&self, i: usize) -> impl Iterator<Item = (usize, f32)> + use<> {
        let (begin, end, across) = (i as f64 * self.from, (i + 1) as f64 * self.from, self.from);
        let last = ((end - 1e-9).floor() as usize).min(self.last);
        (begin.floor() as usize..=last).map(move |pixel| {
            let covered = end.min((pixel + 1) as f64) - begin.max(pixel as f64);
            (pixel, (covered / across) as f32)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: usize, height: usize) -> Planes {
        let samples = (0..width * height * 2).map(|i| (i * i % 37) as f32).collect();
        Planes { width, height, count: 2, samples: Samples::Float(samples) }
    }

    fn mean(planes: &Planes, i: usize) -> f64 {
        let all = (0..planes.height).flat_map(|y| (0..planes.width).map(move |x| (x, y)));
        all.map(|(x, y)| planes.at(x, y, i)).sum::<f64>() / (planes.width * planes.height) as f64
    }

    #[test]
    fn no_light_is_lost_whatever_the_size() {
        for (from, to) in
            [([30, 20], [10, 10]), ([31, 17], [7, 5]), ([9, 9], [9, 9]), ([16, 9], [15, 8])]
        {
            let planes = ramp(from[0], from[1]);
            let small = reduced(&planes, to);
            for i in 0..2 {
                approx::assert_relative_eq!(mean(&small, i), mean(&planes, i), max_relative = 1e-5);
            }
        }
    }

    #[test]
    fn a_picture_of_its_own_size_stays_bit_for_bit() {
        let planes = ramp(13, 7);
        assert_eq!(reduced(&planes, [13, 7]), planes);
    }

    #[test]
    fn a_picture_is_made_to_fit_and_never_enlarged() {
        assert_eq!(size([1920, 1080], 480), [480, 270]);
        assert_eq!(size([100, 4000], 400), [10, 400]);
        assert_eq!(size([64, 36], 480), [64, 36]);
        assert_eq!(size([4000, 1], 400), [400, 1]);
    }
}
