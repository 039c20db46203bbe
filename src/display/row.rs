//! Pixels by the block: arithmetic on whole planes, which compilers vectorise, around one pass of
//! look-ups in the tone map's table.

use pulp::{Simd, WithSimd};

use super::{ToneMap, encode, gamut};

/// Pixels of a block.
const BLOCK: usize = 64;

type Plane = [f32; BLOCK];

/// A row that is encoded as sRGB, for whatever vectors the processor has.
pub(super) struct Encode<'a> {
    pub(crate) map: &'a ToneMap,
    pub(crate) rgb: [&'a [f32]; 3],
    /// The unit, cd/m2.
    pub(crate) scale: f32,
    /// Those of luminance.
    pub(crate) weights: [f32; 3],
    pub(crate) highlights: f32,
    /// Three bytes a pixel.
    pub(crate) out: &'a mut [u8],
}

impl WithSimd for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Encode { map, rgb, scale, weights, highlights, out } = self;
        let [red, green, blue] = rgb.map(|plane| plane.chunks(BLOCK));
        for (((red, green), blue), bytes) in red.zip(green).zip(blue).zip(out.chunks_mut(3 * BLOCK))
        {
            encode_block(map, [red, green, blue], (scale, weights), highlights, bytes);
        }
    }
}

/// Encodes up to [`BLOCK`] pixels.
#[inline(always)]
fn encode_block(
    map: &ToneMap,
    rgb: [&[f32]; 3],
    (scale, weights): (f32, [f32; 3]),
    highlights: f32,
    out: &mut [u8],
) {
    let (mut colour, mut shares) = ([[0.0; BLOCK]; 3], [0.0; BLOCK]);
    for (plane, pixels) in colour.iter_mut().zip(rgb) {
        plane[..pixels.len()].copy_from_slice(pixels);
    }
    to_chroma(&mut colour, &mut shares, scale, weights);
    map.share_each(&mut shares);
    to_shown(&mut colour, &shares, highlights);
    let ([red, green, blue], srgb) = (&colour, encode::srgb());
    // Not by `map`, whose closure would be compiled for any processor.
    let [red, green, blue] = [srgb.code_each(red), srgb.code_each(green), srgb.code_each(blue)];
    for (((bytes, r), g), b) in out.as_chunks_mut().0.iter_mut().zip(red).zip(green).zip(blue) {
        *bytes = [r, g, b];
    }
}

/// Light in, chroma and luminance out.
#[inline(always)]
fn to_chroma(
    [red, green, blue]: &mut [Plane; 3],
    luminance: &mut Plane,
    scale: f32,
    weights: [f32; 3],
) {
    for i in 0..BLOCK {
        let light = gamut::bounded([red[i] * scale, green[i] * scale, blue[i] * scale]);
        luminance[i] = gamut::luminance(light, weights);
        [red[i], green[i], blue[i]] = gamut::chroma(light, luminance[i]);
    }
}

/// Chroma in, linear RGB of the display out.
#[inline(always)]
fn to_shown([red, green, blue]: &mut [Plane; 3], shares: &Plane, highlights: f32) {
    for i in 0..BLOCK {
        [red[i], green[i], blue[i]] =
            gamut::shown([red[i], green[i], blue[i]], shares[i], highlights);
    }
}
