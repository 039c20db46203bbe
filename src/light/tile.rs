//! A run of places in one row of all planes: what a loop works on.

use super::{Row, widen};

/// A run of places in a row of planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneTile<'a> {
    samples: &'a [f32],
    stride: usize,
    from: usize,
    width: usize,
}

impl<'a> PlaneTile<'a> {
    /// Planes of `width` samples one after the other.
    pub(crate) fn whole(samples: &'a [f32], width: usize) -> Self {
        PlaneTile { samples, stride: width, from: 0, width }
    }

    /// The run of `width` places that begins at `from`. Halves are widened into `room`, which must
    /// be as long as all planes of the run (`kernel::tiles` sees to that).
    pub(crate) fn of(
        row: Row<'a>,
        count: usize,
        from: usize,
        width: usize,
        room: &'a mut [f32],
    ) -> Self {
        match row {
            Row::Float(samples) => {
                PlaneTile { samples, stride: samples.len() / count, from, width }
            }
            Row::Half(samples) => {
                let stride = samples.len() / count;
                let room = &mut room[..count * width];
                for (plane, out) in samples.chunks_exact(stride).zip(room.chunks_exact_mut(width)) {
                    widen(&plane[from..from + width], out);
                }
                PlaneTile { samples: room, stride: width, from: 0, width }
            }
        }
    }

    /// How many places.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// How far behind place `at` of a plane its place `at` + `places` is stored: in the next row,
    /// if this one ends before.
    #[inline(always)]
    pub(crate) fn ahead(&self, at: usize, places: usize) -> usize {
        let in_row = self.from + at + places < self.stride;
        if in_row { places } else { places + self.samples.len() - self.stride }
    }

    /// The run of one plane.
    #[inline(always)]
    pub(crate) fn plane(&self, i: usize) -> &'a [f32] {
        &self.samples[i * self.stride + self.from..][..self.width]
    }
}
