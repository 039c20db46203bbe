//! Reading between samples: light on its way to the retina, pigment on its way back, straight lines both ways.

/// Three planes, row by row, that can be read between their samples.
pub(super) struct Field<'a, T> {
    pub samples: &'a [T],
    pub width: usize,
    pub height: usize,
    /// What lies outside.
    pub around: [T; 3],
}

/// A number between two others; exactly theirs where they are equal.
pub(super) trait Between: Copy {
    fn between(self, other: Self, t: f64) -> Self;
}

impl Between for f32 {
    fn between(self, other: f32, t: f64) -> f32 {
        self + t as f32 * (other - self)
    }
}

impl Between for f64 {
    fn between(self, other: f64, t: f64) -> f64 {
        self + t * (other - self)
    }
}

impl<T: Between> Field<'_, T> {
    /// Reads a run of three planes that begins at `from` and goes on in steps of one sample. Whole steps are exact.
    pub fn resample(&self, from: [f64; 2], out: [&mut [T]; 3]) {
        let (left, top) = (from[0].floor(), from[1].floor());
        let (u, v) = (from[0] - left, from[1] - top);
        for (k, out) in out.into_iter().enumerate() {
            for (x, out) in out.iter_mut().enumerate() {
                let (x, y) = (left as i64 + x as i64, top as i64);
                let row = |y: i64| {
                    let here = self.sample(x, y, k);
                    if u == 0.0 { here } else { here.between(self.sample(x + 1, y, k), u) }
                };
                *out = if v == 0.0 { row(y) } else { row(y).between(row(y + 1), v) };
            }
        }
    }

    fn sample(&self, x: i64, y: i64, k: usize) -> T {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return self.around[k];
        }
        self.samples[(y as usize * 3 + k) * self.width + x as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(field: &Field<'_, f64>, from: [f64; 2]) -> [f64; 3] {
        let (mut a, mut b, mut c) = ([0.0], [0.0], [0.0]);
        field.resample(from, [&mut a, &mut b, &mut c]);
        [a[0], b[0], c[0]]
    }

    #[test]
    fn whole_steps_are_exact_and_outside_lies_what_is_around() {
        let samples: Vec<f64> = (0..12).map(|i| f64::from(i) / 7.0).collect();
        let field = Field { samples: &samples, width: 2, height: 2, around: [9.0, 8.0, 7.0] };
        assert_eq!(read(&field, [1.0, 1.0]), [samples[7], samples[9], samples[11]]);
        assert_eq!(read(&field, [-1.0, 0.0]), [9.0, 8.0, 7.0]);
        assert_eq!(read(&field, [0.5, 0.0])[0], samples[0] + 0.5 * (samples[1] - samples[0]));
    }
}
