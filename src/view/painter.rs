//! What the eye shows, as the bytes that a page gets: JPEG without thinned colour while time runs, the exact PNG
//! when it rests.

use std::io;
use std::sync::Arc;

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};

use super::message::{Form, Head};
use crate::display::{Display, ToneMap};
use crate::frames;
use crate::light::Planes;

/// Quality of the JPEG pictures.
const QUALITY: u8 = 90;

/// One picture of the eye, still in its own light.
#[derive(Clone, Debug)]
pub struct Picture {
    /// All but the number and the form, which the painter knows.
    pub(crate) head: Head,
    /// Whether it stays on the page: then it is exact.
    pub(crate) lasts: bool,
    pub percept: Arc<Planes>,
    /// The percept's RGB -> linear sRGB in cd/m2.
    pub(crate) to_srgb: [[f32; 3]; 3],
    pub(crate) display: Display,
    pub(crate) map: Arc<ToneMap>,
}

impl Picture {
    /// The picture as sRGB, three bytes a pixel, as `display.####.png` has it.
    pub fn srgb(&self) -> Vec<u8> {
        let [width, height] = self.head.size;
        let mut rgb = vec![0; 3 * width * height];
        self.display.picture(&self.percept, &self.to_srgb, &self.map, &mut rgb);
        rgb
    }
}

/// A painter with its memory.
#[derive(Default)]
pub(crate) struct Painter {
    rgb: Vec<u8>,
}

impl Painter {
    /// The message of a picture: its head, then the encoded picture.
    ///
    /// # Errors
    /// A picture that its form cannot hold.
    pub(crate) fn paint(&mut self, seq: u32, picture: &Picture) -> io::Result<Vec<u8>> {
        let form = if picture.lasts { Form::Png } else { Form::Jpeg };
        let mut bytes = Head { seq, form, ..picture.head }.bytes();
        let Picture { percept, to_srgb, display, map, .. } = picture;
        let [width, height] = picture.head.size;
        self.rgb.resize(3 * width * height, 0);
        display.picture(percept, to_srgb, map, &mut self.rgb);
        match form {
            Form::Png => frames::encode_png(&mut bytes, width, height, &self.rgb)?,
            Form::Jpeg => {
                let side = |n: usize| u16::try_from(n).map_err(io::Error::other);
                let mut encoder = Encoder::new(&mut bytes, QUALITY);
                encoder.set_sampling_factor(SamplingFactor::F_1_1);
                let encoded =
                    encoder.encode(&self.rgb, side(width)?, side(height)?, ColorType::Rgb);
                encoded.map_err(io::Error::other)?;
            }
        }
        Ok(bytes)
    }
}
