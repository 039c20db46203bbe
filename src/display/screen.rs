//! A screen on which looks are shown one after the other: its tone map follows their light.

use rayon::prelude::*;

use super::{Display, ToneMap};
use crate::error::{Error, Result};
use crate::eye::Look;
use crate::kernel;
use crate::light::{PlaneTile, Planes};

/// A display and the tone map that it has come to.
#[derive(Clone, Debug, Default)]
pub struct Screen {
    display: Display,
    map: Option<ToneMap>,
}

impl Screen {
    /// A screen that has shown nothing yet.
    pub fn new(display: Display) -> Self {
        Screen { display, map: None }
    }

    /// Shows a look. `srgb`: 8-bit R, G, B of each pixel, row by row, which is written.
    ///
    /// # Errors
    /// `srgb` is not three bytes a pixel.
    pub fn show(&mut self, look: &Look, srgb: &mut [u8]) -> Result<()> {
        let Planes { width, height, .. } = look.percept;
        if srgb.len() != 3 * width * height {
            let (found, wanted) = (srgb.len(), 3 * width * height);
            return Err(Error::light(format!("found {found} bytes for a picture of {wanted}")));
        }
        let display = self.display;
        let map = self.follow(look);
        display.picture(&look.percept, &look.to_srgb, map, srgb);
        Ok(())
    }

    /// The tone map for a look, shown or not: it follows the light of every look.
    pub fn follow(&mut self, look: &Look) -> &ToneMap {
        let map = self.display.follow(self.map.as_ref(), &look.survey, look.duration);
        self.map.insert(map)
    }

    /// The display.
    pub fn display(&self) -> &Display {
        &self.display
    }

    /// The tone map that it has come to; none before the first look.
    pub fn map(&self) -> Option<&ToneMap> {
        self.map.as_ref()
    }

    /// Goes on from a tone map's levels ([`ToneMap::levels`]); empty ones are none.
    ///
    /// # Errors
    /// They are no tone map's.
    pub fn restore(&mut self, levels: Vec<f64>) -> Result<()> {
        let unknown = || Error::light("the state holds no tone map");
        self.map = match levels.is_empty() {
            true => None,
            false => Some(self.display.restore(levels).ok_or_else(unknown)?),
        };
        Ok(())
    }
}

impl Display {
    /// A percept as 8-bit sRGB under a tone map. `to_srgb`: its RGB -> linear sRGB in cd/m2.
    pub fn picture(
        &self,
        percept: &Planes,
        to_srgb: &[[f32; 3]; 3],
        map: &ToneMap,
        srgb: &mut [u8],
    ) {
        let width = percept.width;
        let scratch = || (vec![0.0; 3 * width], vec![0.0; 3 * width]);
        let rows = srgb.par_chunks_exact_mut(3 * width).enumerate();
        rows.for_each_init(scratch, |(light, linear), (y, bytes)| {
            let row = percept.row(y);
            let light = PlaneTile::whole(row.as_f32(light), width);
            for (weights, out) in to_srgb.iter().zip(linear.chunks_exact_mut(width)) {
                kernel::combine(light, weights, out);
            }
            let [r, g, b] = [0, 1, 2].map(|i| &linear[i * width..][..width]);
            self.encode_row(map, [r, g, b], 1.0, bytes);
        });
    }
}
