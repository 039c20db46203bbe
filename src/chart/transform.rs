//! Convolution by the Fourier transform in single precision, for comparison: radix 2 (Cooley & Tukey
//! 1965), a picture in a field of zeros twice as large.

/// A complex number.
type Complex = [f32; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

/// Roots of unity: e^(-2 pi i k/n) for k below n/2.
fn roots(n: usize) -> Vec<Complex> {
    let angle = |k: usize| -std::f64::consts::TAU * k as f64 / n as f64;
    (0..n / 2).map(|k| [angle(k).cos() as f32, angle(k).sin() as f32]).collect()
}

/// The transform of a run whose length is a power of two, in place.
fn transform(run: &mut [Complex], roots: &[Complex]) {
    let n = run.len();
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - n.trailing_zeros());
        if i < j {
            run.swap(i, j);
        }
    }
    let mut half = 1;
    while half < n {
        for block in run.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((a, b), root) in low.iter_mut().zip(high).zip(roots.iter().step_by(n / 2 / half)) {
                let turned = times(*b, *root);
                *b = [a[0] - turned[0], a[1] - turned[1]];
                *a = [a[0] + turned[0], a[1] + turned[1]];
            }
        }
        half *= 2;
    }
}

/// Convolution of pictures of one size with a symmetric kernel.
pub(super) struct Convolution {
    size: [usize; 2],
    side: usize,
    roots: Vec<Complex>,
    kernel: Vec<Complex>,
}

impl Convolution {
    /// `kernel`: its value at a distance in columns and rows.
    pub(super) fn new(size: [usize; 2], kernel: impl Fn(usize, usize) -> f64) -> Convolution {
        let side = (2 * size[0].max(size[1]) - 1).next_power_of_two();
        let mut this = Convolution { size, side, roots: roots(side), kernel: Vec::new() };
        let distance = |i: usize, n: usize| Some(i.min(side - i)).filter(|d| *d < n);
        let value = |i: usize| match (distance(i % side, size[0]), distance(i / side, size[1])) {
            (Some(x), Some(y)) => [kernel(x, y) as f32, 0.0],
            _ => [0.0; 2],
        };
        let field = (0..side * side).map(value).collect();
        this.kernel = this.both_ways(field);
        this
    }

    /// Transforms rows, then columns; the result is transposed.
    fn both_ways(&self, mut field: Vec<Complex>) -> Vec<Complex> {
        let side = self.side;
        field.chunks_exact_mut(side).for_each(|row| transform(row, &self.roots));
        let mut turned: Vec<Complex> =
            (0..side * side).map(|i| field[i % side * side + i / side]).collect();
        turned.chunks_exact_mut(side).for_each(|row| transform(row, &self.roots));
        turned
    }

    /// The convolution of a picture.
    pub(super) fn of(&self, picture: &[f32]) -> Vec<f32> {
        let ([width, height], side) = (self.size, self.side);
        let mut field = vec![[0.0; 2]; side * side];
        for (row, from) in field.chunks_exact_mut(side).zip(picture.chunks_exact(width)) {
            row.iter_mut().zip(from).for_each(|(to, from)| *to = [*from, 0.0]);
        }
        let product =
            self.both_ways(field).into_iter().zip(&self.kernel).map(|(a, b)| times(a, *b));
        // The inverse is the transform of the conjugate; the real part is all that is wanted.
        let back = self.both_ways(product.map(|[re, im]| [re, -im]).collect());
        let scale = 1.0 / (side * side) as f32;
        (0..width * height).map(|i| scale * back[i / width * side + i % width][0]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_convolved_is_the_kernel_around_it() {
        let kernel = |x: usize, y: usize| 1.0 / (1.0 + x as f64 + 3.0 * y as f64);
        let mut picture = vec![0.0; 12 * 7];
        picture[2 * 12 + 5] = 2.0;
        let found = Convolution::new([12, 7], kernel).of(&picture);
        for (i, found) in found.into_iter().enumerate() {
            let expected = 2.0 * kernel((i % 12).abs_diff(5), (i / 12).abs_diff(2));
            assert!((f64::from(found) - expected).abs() < 1e-6, "{found} {expected}");
        }
    }
}
