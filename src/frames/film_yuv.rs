//! Codes of a film's frame to the signals R', G', B'.
//!
//! ITU-R BT.709, BT.601, BT.2020 and H.273: Y' = (code - 16 s)/(219 s) at limited range, code/top at
//! full range, likewise C = (code - middle)/(224 s); s = 2^(bits - 8). R' = Y' + 2 (1 - Kr) Cr, B' =
//! Y' + 2 (1 - Kb) Cb, and G' is what is left of Y'. Chroma of less than full size is interpolated
//! linearly between the places where its samples were taken (`chroma_location`; H.273, 8.7).

use crate::frames::film_layouts::{Planes, planes, unread};
use crate::frames::film_matrix::Matrix;
use crate::frames::film_probe::Stream;
use crate::frames::options::ReadOptions;

/// How the bytes of a frame are laid out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// The layout that ffmpeg is asked for: the stream's own, or the same codes in planes.
    pub(crate) pix_fmt: String,
    /// Whether that is another than the stream's own.
    pub(crate) repacked: bool,
    pub(crate) width: usize,
    pub(crate) height: usize,
    bits: u32,
    planes: Planes,
    /// Full range of codes, or the limited one.
    full: bool,
    matrix: Matrix,
    /// Where chroma is sampled between the luma samples: 0 on the first, 0.5 half way to the next.
    siting: [f32; 2],
}

impl Layout {
    /// The layout of a stream, and what had to be assumed. The problem, if there is one, is a
    /// message.
    pub(crate) fn of(
        stream: &Stream,
        options: &ReadOptions,
    ) -> Result<(Layout, Vec<String>), String> {
        let (planes, bits, pix_fmt) =
            planes(&stream.pix_fmt).ok_or_else(|| unread(&stream.pix_fmt))?;
        let mut notes = Vec::new();
        let matrix = match planes {
            Planes::Yuv(..) => options.matrix.map_or_else(|| matrix(stream, &mut notes), Ok)?,
            _ => Matrix::BT709,
        };
        let by_name = stream.pix_fmt.starts_with("yuvj");
        let full = match stream.color_range.as_deref() {
            _ if options.full_range.is_some() => options.full_range == Some(true),
            _ if planes == Planes::Gbr || by_name => true,
            Some("pc") => true,
            Some("tv") => false,
            _ => {
                notes.push("its range of codes is not told: taken as limited".into());
                false
            }
        };
        let siting = match stream.chroma_location.as_deref() {
            Some("center") => [0.5, 0.5],
            Some("topleft") => [0.0, 0.0],
            Some("top") => [0.5, 0.0],
            None | Some("unspecified") if by_name => [0.5, 0.5],
            _ => [0.0, 0.5],
        };
        let (width, height) = (stream.width, stream.height);
        let repacked = pix_fmt != stream.pix_fmt;
        let layout =
            Layout { pix_fmt, repacked, width, height, bits, planes, full, matrix, siting };
        Ok((layout, notes))
    }

    /// Bytes of a frame.
    pub(crate) fn bytes(&self) -> usize {
        let alpha = usize::from(self.pix_fmt.contains("yuva") || self.pix_fmt.contains("gbrap"));
        let luma = self.width * self.height;
        let samples = match self.planes {
            Planes::Grey => luma,
            Planes::Gbr => luma * 3,
            Planes::Yuv(..) => luma + 2 * self.chroma().0 * self.chroma().1,
        };
        (samples + alpha * luma) * self.bytes_per_sample()
    }

    /// Bits of a code.
    pub(crate) fn bits(&self) -> u32 {
        self.bits
    }

    fn bytes_per_sample(&self) -> usize {
        if self.bits > 8 { 2 } else { 1 }
    }

    /// Width and height of a plane of chroma.
    fn chroma(&self) -> (usize, usize) {
        match self.planes {
            Planes::Yuv(across, down) => (self.width.div_ceil(across), self.height.div_ceil(down)),
            _ => (self.width, self.height),
        }
    }

    /// R', G' and B' of row `y`: three runs of the frame's width. `room` is to work in.
    pub(crate) fn signals(&self, frame: &[u8], y: usize, out: &mut [f32], room: &mut Vec<f32>) {
        pulp::Arch::new().dispatch(Signals { layout: self, frame, y, out, room });
    }

    #[inline(always)]
    fn each_signal(&self, frame: &[u8], y: usize, out: &mut [f32], room: &mut Vec<f32>) {
        let width = self.width;
        let luma = width * self.height;
        let (red, rest) = out.split_at_mut(width);
        let (green, blue) = rest.split_at_mut(width);
        match self.planes {
            Planes::Grey => {
                self.codes(frame, y * width, green, self.luma_scale());
                red.copy_from_slice(green);
                blue.copy_from_slice(green);
            }
            Planes::Gbr => {
                for (plane, out) in [green, blue, red].into_iter().enumerate() {
                    self.codes(frame, plane * luma + y * width, out, self.luma_scale());
                }
            }
            Planes::Yuv(..) => {
                self.codes(frame, y * width, green, self.luma_scale());
                let (columns, rows) = self.chroma();
                self.chroma_row(frame, luma, y, blue, room);
                self.chroma_row(frame, luma + columns * rows, y, red, room);
                self.matrix.apply(red, green, blue);
            }
        }
    }

    /// One plane of chroma in row `y`, interpolated to the frame's width.
    #[inline(always)]
    fn chroma_row(
        &self,
        frame: &[u8],
        plane: usize,
        y: usize,
        out: &mut [f32],
        room: &mut Vec<f32>,
    ) {
        let Planes::Yuv(across, down) = self.planes else { return };
        let (columns, rows) = self.chroma();
        room.resize(2 * columns, 0.0);
        let (above, below) = room.split_at_mut(columns);
        let (row, next, weight) = between(y, down, self.siting[1], rows);
        self.codes(frame, plane + row * columns, above, self.chroma_scale());
        if weight > 0.0 {
            self.codes(frame, plane + next * columns, below, self.chroma_scale());
            for (above, below) in above.iter_mut().zip(below) {
                *above += weight * (*below - *above);
            }
        }
        widened(above, across, self.siting[0], out);
    }

    /// Factor and offset from codes to signals.
    fn luma_scale(&self) -> (f32, f32) {
        let step = f32::from(1u16 << (self.bits - 8));
        let (low, span) =
            if self.full { (0.0, step * 256.0 - 1.0) } else { (16.0 * step, 219.0 * step) };
        (1.0 / span, -low / span)
    }

    fn chroma_scale(&self) -> (f32, f32) {
        let step = f32::from(1u16 << (self.bits - 8));
        let span = if self.full { step * 256.0 - 1.0 } else { 224.0 * step };
        (1.0 / span, -128.0 * step / span)
    }

    /// Scales codes from sample `first` of the frame on.
    #[inline(always)]
    fn codes(&self, frame: &[u8], first: usize, out: &mut [f32], (factor, offset): (f32, f32)) {
        if self.bits > 8 {
            let codes = frame[2 * first..][..2 * out.len()].as_chunks().0;
            for (out, code) in out.iter_mut().zip(codes) {
                *out = f32::from(u16::from_le_bytes(*code)) * factor + offset;
            }
        } else {
            for (out, code) in out.iter_mut().zip(&frame[first..]) {
                *out = f32::from(*code) * factor + offset;
            }
        }
    }
}

/// The two samples around place `at` of a plane that has one for every `step`, and the weight of
/// the second.
fn between(at: usize, step: usize, siting: f32, count: usize) -> (usize, usize, f32) {
    if step == 1 {
        return (at, at, 0.0);
    }
    let place = ((at as f32 - siting) / step as f32).clamp(0.0, (count - 1) as f32);
    let before = place as usize;
    (before, (before + 1).min(count - 1), place - before as f32)
}

/// A row of chroma interpolated to the width of luma.
#[inline(always)]
fn widened(row: &[f32], step: usize, siting: f32, out: &mut [f32]) {
    if step == 1 {
        return out.copy_from_slice(row);
    }
    if step == 2 && siting == 0.0 {
        // The common case: every second place is a sample, the others lie half way.
        let (pairs, last) = out.as_chunks_mut::<2>();
        for ((pair, here), next) in pairs.iter_mut().zip(row).zip(&row[1..]) {
            *pair = [*here, 0.5 * (here + next)];
        }
        // The last sample has none after it.
        let end = row[row.len() - 1];
        pairs[row.len() - 1..].iter_mut().for_each(|pair| *pair = [end; 2]);
        last.fill(end);
        return;
    }
    for (x, out) in out.iter_mut().enumerate() {
        let (before, after, weight) = between(x, step, siting, row.len());
        *out = row[before] + weight * (row[after] - row[before]);
    }
}

/// The work of [`Layout::signals`], for whatever vectors the processor has.
struct Signals<'a> {
    layout: &'a Layout,
    frame: &'a [u8],
    y: usize,
    out: &'a mut [f32],
    room: &'a mut Vec<f32>,
}

impl pulp::WithSimd for Signals<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.layout.each_signal(self.frame, self.y, self.out, self.room);
    }
}

/// The matrix of a stream; where it does not tell, that of its size, as players take it.
fn matrix(stream: &Stream, notes: &mut Vec<String>) -> Result<Matrix, String> {
    match stream.color_space.as_deref() {
        Some("bt709") => Ok(Matrix::BT709),
        Some("bt2020nc") => Ok(Matrix::BT2020),
        Some("smpte170m" | "bt470bg") => Ok(Matrix::BT601),
        None | Some("unknown" | "reserved") => {
            let (name, matrix) = if stream.height < 720 {
                ("BT.601", Matrix::BT601)
            } else {
                ("BT.709", Matrix::BT709)
            };
            notes.push(format!("its matrix is not told: taken as {name}, by its size"));
            Ok(matrix)
        }
        Some(other) => Err(format!(
            "has the matrix `{other}`; bt709, bt2020nc, smpte170m and bt470bg are read. If that is \
             wrong, say input.matrix"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(pix_fmt: &str, width: usize, height: usize) -> Stream {
        let text = |text: &str| Some(text.to_owned());
        Stream {
            width,
            height,
            pix_fmt: pix_fmt.into(),
            color_range: text("tv"),
            color_space: text("bt2020nc"),
            chroma_location: text("left"),
            ..Stream::default()
        }
    }

    fn signals(layout: &Layout, frame: &[u8], y: usize) -> Vec<f32> {
        let mut out = vec![0.0; 3 * layout.width];
        layout.signals(frame, y, &mut out, &mut Vec::new());
        out
    }

    /// BT.2100-2, table 9: black and white are 64 and 940, chroma 512 +- 448 in 10 bits.
    #[test]
    fn published_codes_become_black_white_and_full_red() {
        let (layout, notes) =
            Layout::of(&stream("yuv444p10le", 3, 1), &ReadOptions::default()).unwrap();
        assert!(notes.is_empty(), "{notes:?}");
        // Red at full: Y' = Kr, Cr = .5, Cb = -Kr / (2 (1 - Kb)).
        let cb = -0.2627 / (2.0 * (1.0 - 0.0593));
        let red = [64.0 + 876.0 * 0.2627, 512.0 + 896.0 * cb, 960.0f64];
        let codes: Vec<u16> = [64.0, 940.0, red[0], 512.0, 512.0, red[1], 512.0, 512.0, red[2]]
            .map(|code: f64| code.round() as u16)
            .into();
        let frame: Vec<u8> = codes.iter().flat_map(|code| code.to_le_bytes()).collect();
        assert_eq!(frame.len(), layout.bytes());
        let found = signals(&layout, &frame, 0);
        let expected = [0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0];
        let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(near, "{found:?}");
    }

    #[test]
    fn chroma_is_interpolated_between_the_places_where_it_was_sampled() {
        // A ramp of chroma along x and y stays a ramp, whatever the siting.
        for (location, at) in
            [("left", [0.0, 0.5]), ("center", [0.5, 0.5]), ("topleft", [0.0, 0.0])]
        {
            let told = Stream {
                chroma_location: Some(location.into()),
                color_range: Some("pc".into()),
                ..stream("yuv420p", 8, 8)
            };
            let (layout, _) = Layout::of(&told, &ReadOptions::default()).unwrap();
            let mut frame = vec![0; layout.bytes()];
            for (i, code) in frame[64..80].iter_mut().enumerate() {
                *code = (128 + 8 * (i % 4) + 4 * (i / 4)) as u8;
            }
            let (mut row, mut room) = (vec![0.0; 8], Vec::new());
            for y in 2..6 {
                layout.chroma_row(&frame, 64, y, &mut row, &mut room);
                for (x, value) in row.iter().enumerate().take(6).skip(2) {
                    let place = |at: usize, siting: f32| (at as f32 - siting) / 2.0;
                    let code = 8.0 * place(x, at[0]) + 4.0 * place(y, at[1]);
                    assert!((value * 255.0 - code).abs() < 1e-3, "{location} {x} {y}: {value}");
                }
            }
        }
    }
}
