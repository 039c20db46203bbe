//! Pixels by the block: arithmetic on whole planes, which compilers vectorise, between two passes
//! of table look-ups.

use super::{ToneMap, encode, gamut};

/// Pixels of a block.
pub(super) const BLOCK: usize = 64;

type Plane = [f32; BLOCK];

/// Encodes up to [`BLOCK`] pixels as sRGB; `scale` cd/m2 the unit, `weights` those of luminance.
pub(super) fn encode_block(
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
    for share in &mut shares {
        *share = map.share(*share);
    }
    to_shown(&mut colour, &shares, highlights);
    let srgb = encode::srgb();
    for (i, bytes) in out.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        *bytes = [srgb.code(colour[0][i]), srgb.code(colour[1][i]), srgb.code(colour[2][i])];
    }
}

/// Light in, chroma and luminance out.
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
fn to_shown([red, green, blue]: &mut [Plane; 3], shares: &Plane, highlights: f32) {
    for i in 0..BLOCK {
        [red[i], green[i], blue[i]] =
            gamut::shown([red[i], green[i], blue[i]], shares[i], highlights);
    }
}
