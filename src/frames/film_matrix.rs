//! Luma and chroma to red, green and blue (ITU-R BT.709, BT.601, BT.2020).

/// The weights of red and blue in luma, from which a matrix of YUV follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix {
    kr: f32,
    kb: f32,
}

impl Matrix {
    pub(crate) const BT709: Matrix = Matrix { kr: 0.2126, kb: 0.0722 };
    pub(crate) const BT601: Matrix = Matrix { kr: 0.299, kb: 0.114 };
    /// Of non-constant luminance.
    pub(crate) const BT2020: Matrix = Matrix { kr: 0.2627, kb: 0.0593 };

    /// Cr, Y', Cb to R', G', B' in place.
    #[inline(always)]
    pub(super) fn apply(self, red: &mut [f32], green: &mut [f32], blue: &mut [f32]) {
        let (kr, kb) = (self.kr, self.kb);
        let (of_red, of_blue) = (2.0 * (1.0 - kr), 2.0 * (1.0 - kb));
        let kg = 1.0 - kr - kb;
        let (g_red, g_blue) = (of_red * kr / kg, of_blue * kb / kg);
        for ((r, g), b) in red.iter_mut().zip(green).zip(blue) {
            let (y, cr, cb) = (*g, *r, *b);
            *r = y + of_red * cr;
            *g = y - g_red * cr - g_blue * cb;
            *b = y + of_blue * cb;
        }
    }
}
