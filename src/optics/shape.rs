//! How a level of the pyramid lies in memory.

/// Samples of a plane's row are a whole multiple of this: four of the longest vectors.
pub(super) const BLOCK: usize = 64;

/// Samples around a picture that carry light on coarser levels. The binomial filter reaches three;
/// four keep even places even.
pub(super) const MARGIN: usize = 4;

/// Floats of a cache line.
const LINE: usize = 16;

/// Rows of `count` planes, with a margin around each plane. Column `x` of plane `i` in row `y` is
/// sample `(y + MARGIN) * stride + i * plane + MARGIN + x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) count: usize,
    /// Samples of a plane in one row, the rest zeros: whole blocks.
    pub(crate) plane: usize,
    /// Samples of a row. An odd number of lines: columns of rows share no set of the cache.
    pub(crate) stride: usize,
}

impl Shape {
    pub(super) fn new(width: usize, height: usize, count: usize) -> Shape {
        let plane = (width + 2 * MARGIN).next_multiple_of(BLOCK);
        Shape { width, height, count, plane, stride: count * plane + LINE }
    }

    /// The next coarser level.
    pub(super) fn halved(&self) -> Shape {
        Shape::new(self.width.div_ceil(2), self.height.div_ceil(2), self.count)
    }

    /// Rows with the margins.
    pub(super) fn rows(&self) -> usize {
        self.height + 2 * MARGIN
    }

    pub(super) fn samples(&self) -> usize {
        self.rows() * self.stride
    }
}
