//! The display window of a frame among the pixels that are seen of it.

use std::borrow::Cow;

use half::f16;

use super::{Planes, Samples};

/// The pixels that a display shows. A frame may reach beyond them (overscan); fractions of a
/// picture and its field of view go by this window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Its first column and row among those of the frame.
    pub corner: [usize; 2],
    /// Width and height.
    pub size: [usize; 2],
}

impl Window {
    /// That of a frame without overscan.
    pub fn whole(size: [usize; 2]) -> Window {
        Window { corner: [0; 2], size }
    }

    /// The place in pixels of the frame, whose centres are integers, of fractions of the window's
    /// width and height.
    pub(crate) fn pixel(&self, at: [f64; 2]) -> [f64; 2] {
        self.in_frame([0, 1].map(|i| at[i] * self.size[i] as f64 - 0.5))
    }

    /// The place in pixels of the frame of one in pixels of the window.
    pub(crate) fn in_frame(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.corner[i] as f64 + place[i])
    }

    /// The place in pixels of the window of one in pixels of the frame.
    pub(crate) fn in_window(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| place[i] - self.corner[i] as f64)
    }

    /// The fractions of a place in pixels of the frame: the inverse of [`Window::pixel`].
    pub(crate) fn fraction(&self, place: [f64; 2]) -> [f64; 2] {
        let place = self.in_window(place);
        [0, 1].map(|i| (place[i] + 0.5) / self.size[i] as f64)
    }

    /// The pixel of the window that holds fractions of it: floor(at * size).
    pub(crate) fn holding(&self, at: [f64; 2]) -> [usize; 2] {
        let pixel = |i: usize| ((at[i] * self.size[i] as f64) as usize).min(self.size[i] - 1);
        [0, 1].map(|i| self.corner[i] + pixel(i))
    }

    /// The part of a frame's planes that a display shows.
    pub(crate) fn of<'a>(&self, planes: &'a Planes) -> Cow<'a, Planes> {
        let ([width, height], count) = (self.size, planes.count);
        if self.size == [planes.width, planes.height] {
            return Cow::Borrowed(planes);
        }
        let samples = match &planes.samples {
            Samples::Half(samples) => Samples::Half(self.cut::<f16>(samples, planes)),
            Samples::Float(samples) => Samples::Float(self.cut::<f32>(samples, planes)),
        };
        Cow::Owned(Planes { width, height, count, samples })
    }

    fn cut<T: Copy>(&self, samples: &[T], planes: &Planes) -> Vec<T> {
        let ([left, top], [width, height]) = (self.corner, self.size);
        let rows = samples.chunks_exact(planes.width);
        let rows = rows.skip(top * planes.count).take(height * planes.count);
        rows.flat_map(|row| &row[left..][..width]).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_go_by_the_window_and_come_back() {
        let window = Window { corner: [3, 2], size: [10, 4] };
        assert_eq!(window.pixel([0.0, 0.0]), [2.5, 1.5]);
        assert_eq!(window.pixel([0.5, 0.5]), [7.5, 3.5]);
        assert_eq!(window.fraction(window.pixel([0.25, 0.75])), [0.25, 0.75]);
        assert_eq!(window.holding([0.25, 0.75]), [5, 5]);
        assert_eq!(window.holding([1.0, 1.0]), [12, 5]);
        assert_eq!(Window::whole([8, 6]).pixel([1.0, 0.5]), [7.5, 2.5]);
    }

    #[test]
    fn the_window_of_planes_is_cut_out_of_each() {
        let samples = Samples::Float((0..40).map(|i| i as f32).collect());
        let planes = Planes { width: 5, height: 4, count: 2, samples };
        let cut = Window { corner: [1, 2], size: [3, 2] }.of(&planes).into_owned();
        assert_eq!((cut.width, cut.height, cut.count), (3, 2, 2));
        for (x, y, plane) in [(0, 0, 0), (2, 1, 1), (1, 1, 0)] {
            assert_eq!(cut.at(x, y, plane), planes.at(x + 1, y + 2, plane));
        }
        assert!(matches!(Window::whole([5, 4]).of(&planes), Cow::Borrowed(_)));
    }
}
