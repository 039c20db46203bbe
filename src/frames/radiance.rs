//! Radiance pictures (`.hdr`, `.pic`): shared-exponent RGB or XYZ.
//!
//! The Radiance reference manual, "File Formats". Stored numbers are divided by the product of all
//! EXPOSURE lines and by the product of all COLORCORR lines. Then RGB times 179 is cd/m2, and the Y
//! of XYZ is cd/m2 as it stands (manual of `ra_xyze`). A line that begins with a blank is the
//! history of another picture that this one was made of, and says nothing of this one: so do
//! `pcomb`, `pcompos` and `pinterp` write the headers of their sources.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::format::{Footage, Format};
use crate::frames::options::{ReadOptions, Wanted};
use crate::frames::picture::{DENSEST, Header, Kind, View, ViewProjection, believable, examined};
use crate::frames::rgbe;
use crate::light::{Frame, Planes};
use crate::units::Nits;
use crate::vision::Projection;

/// Header lines beyond this are no header, bytes.
const LONGEST_HEADER: u64 = 1 << 20;

/// XYZ to linear RGB of Rec. 709, D65 (IEC 61966-2-1, inverse of the RGB to XYZ matrix).
const XYZ_TO_REC709: [[f32; 3]; 3] = [
    [3.240_97, -1.537_383_2, -0.498_610_8],
    [-0.969_243_6, 1.875_967_5, 0.041_555_1],
    [0.055_630_1, -0.203_977, 1.056_971_5],
];

/// The primaries that Radiance means where it writes none (`color.h`, STDPRIMS).
const OF_RADIANCE: Primaries = Primaries {
    red: [0.640, 0.330],
    green: [0.290, 0.600],
    blue: [0.150, 0.060],
    white: [1.0 / 3.0, 1.0 / 3.0],
};

/// Luminance of (1, 1, 1) in the unit of Radiance, W m^-2 sr^-1: its luminous efficacy of equal
/// energy white (`color.h`, WHTEFFICACY).
const WHITE_OF_RADIANCE: Nits = Nits(179.0);

/// What the lines before the pixels say.
#[derive(Clone, Debug, Default, PartialEq)]
struct Lines {
    width: usize,
    height: usize,
    from_right: bool,
    from_bottom: bool,
    /// What each of R, G, B is divided by.
    gain: [f64; 3],
    /// Height of a pixel over its width, or the inverse.
    aspect: f64,
    primaries: Option<Primaries>,
    is_xyz: bool,
    /// A renderer of Radiance wrote the file.
    is_rendered: bool,
    /// Options of all VIEW lines.
    view: Vec<String>,
}

pub(super) static FORMAT: Format = Format {
    name: "Radiance",
    extensions: &["hdr", "pic"],
    recognise: |_, start| start.starts_with(b"#?"),
    open: |path, options| Ok(Box::new(RadiancePicture::open(path, options)?)),
    outline: |_| None,
};

struct RadiancePicture {
    path: PathBuf,
    lines: Lines,
    header: Header,
    options: ReadOptions,
}

impl RadiancePicture {
    fn open(path: &Path, options: &ReadOptions) -> Result<RadiancePicture> {
        if options.wanted == Wanted::Spectral {
            let problem = "is a Radiance picture, RGB; `kind` asks for spectral light";
            return Err(Error::file(path, problem));
        }
        let (lines, _) = opened(path)?;
        believable(path, (lines.width, lines.height), 12, DENSEST, options.max_pixels)?;
        let header = lines.header(options.primaries);
        Ok(RadiancePicture { path: path.to_owned(), lines, header, options: options.clone() })
    }
}

/// Opens the file and reads up to the first pixel.
fn opened(path: &Path) -> Result<(Lines, BufReader<File>)> {
    let mut reader = BufReader::new(File::open(path).map_err(Error::io(path, "read"))?);
    let lines = read_lines(&mut reader).map_err(|problem| Error::file(path, problem))?;
    Ok((lines, reader))
}

/// Reads the header's lines. The problem, if there is one, is a message.
fn read_lines(reader: &mut impl BufRead) -> Result<Lines, String> {
    let mut limited = reader.take(LONGEST_HEADER);
    let mut line = || -> Result<String, String> {
        let mut bytes = Vec::new();
        limited
            .read_until(b'\n', &mut bytes)
            .map_err(|error| format!("cannot be read: {error}"))?;
        if bytes.pop() != Some(b'\n') {
            return Err("is cut short inside its header".into());
        }
        Ok(String::from_utf8_lossy(&bytes).trim_end().to_owned())
    };
    if !line()?.starts_with("#?") {
        return Err("is not a Radiance picture: it does not begin with #?".into());
    }
    let mut lines = Lines { gain: [1.0; 3], aspect: 1.0, ..Lines::default() };
    loop {
        let text = line()?;
        match text.split_once('=') {
            _ if text.is_empty() => break,
            Some((key, value)) => lines.heed(key.trim_end(), value.trim())?,
            None => {}
        }
    }
    if lines.gain.iter().any(|gain| !gain.is_normal() || *gain < 0.0) {
        let gain = lines.gain;
        return Err(format!("has an EXPOSURE or COLORCORR that cannot be divided by: {gain:?}"));
    }
    lines.resolution(&line()?)?;
    Ok(lines)
}

fn format_is_xyz(format: &str) -> Result<bool, String> {
    match format {
        "32-bit_rle_rgbe" => Ok(false),
        "32-bit_rle_xyze" => Ok(true),
        other => {
            Err(format!("is in the format `{other}`; 32-bit_rle_rgbe and 32-bit_rle_xyze are read"))
        }
    }
}

fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split_whitespace().map_while(|word| word.parse().ok()).collect();
    <[f64; N]>::try_from(numbers)
        .map_err(|_| format!("has `{text}` in its header where {N} numbers belong"))
}

impl Lines {
    /// Takes in one line `key=value`.
    fn heed(&mut self, key: &str, value: &str) -> Result<(), String> {
        match key {
            "EXPOSURE" => {
                let [exposure] = numbers(value)?;
                self.gain = self.gain.map(|gain| gain * exposure);
            }
            "COLORCORR" => {
                let factors: [f64; 3] = numbers(value)?;
                self.gain.iter_mut().zip(factors).for_each(|(gain, factor)| *gain *= factor);
            }
            "PIXASPECT" => self.aspect *= numbers::<1>(value)?[0],
            "PRIMARIES" => {
                let [a, b, c, d, e, f, g, h] = numbers(value)?;
                let (red, green, blue, white) = ([a, b], [c, d], [e, f], [g, h]);
                self.primaries = Some(Primaries { red, green, blue, white });
            }
            "FORMAT" => self.is_xyz = format_is_xyz(value)?,
            "SOFTWARE" => self.is_rendered |= value.starts_with("RADIANCE"),
            "VIEW" => self.view.extend(value.split_whitespace().map(str::to_owned)),
            _ => {}
        }
        Ok(())
    }

    /// Reads the line `-Y 480 +X 640`.
    fn resolution(&mut self, text: &str) -> Result<(), String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let size = |text: &str| text.parse().ok().filter(|&size: &u32| size > 0);
        let read = match words[..] {
            [y @ ("-Y" | "+Y"), height, x @ ("+X" | "-X"), width] => {
                size(height).zip(size(width)).map(|size| (size, y == "+Y", x == "-X"))
            }
            _ => None,
        };
        let Some(((height, width), from_bottom, from_right)) = read else {
            return Err(format!(
                "has the resolution line `{text}`; rows from top or bottom are read, as in \
                 -Y 480 +X 640"
            ));
        };
        (self.width, self.height) = (width as usize, height as usize);
        (self.from_bottom, self.from_right) = (from_bottom, from_right);
        Ok(())
    }

    /// Primaries of a picture that names none. A renderer of Radiance (it writes a SOFTWARE line)
    /// means its own. Most others come from cameras and other programs, which mean those of Rec.
    /// 709, even where a VIEW line was added for `evalglare`.
    fn primaries(&self) -> (Primaries, Option<&'static str>) {
        match self.primaries {
            _ if self.is_xyz => (Primaries::REC709, Some("XYZ, read as linear RGB of Rec. 709")),
            Some(primaries) => (primaries, None),
            None if self.is_rendered => (
                OF_RADIANCE,
                Some("no PRIMARIES line: taken as those of Radiance, whose SOFTWARE line it has"),
            ),
            None => (Primaries::REC709, Some("no PRIMARIES line: taken as Rec. 709")),
        }
    }

    /// Luminance of (1, 1, 1), where the unit is certain: a VIEW line is only written by Radiance
    /// or for its tools, which all take 179.
    fn white(&self) -> Option<Nits> {
        let of_radiance = self.is_rendered || !self.view.is_empty();
        if self.is_xyz { Some(Nits(1.0)) } else { of_radiance.then_some(WHITE_OF_RADIANCE) }
    }

    /// The last word on the view: type (`-vtv`) and width (`-vh 60`).
    fn view(&self) -> Option<View> {
        let kind = self.view.iter().rev().find_map(|word| word.strip_prefix("-vt"));
        let projection = match kind.unwrap_or("v") {
            "v" => ViewProjection::Perspective,
            // A cylinder's columns are angles, too.
            "a" | "c" => ViewProjection::Angular,
            _ => return None,
        };
        let at = self.view.iter().rposition(|word| word == "-vh")?;
        let horizontal_fov_deg = self.view.get(at + 1)?.parse().ok()?;
        View { horizontal_fov_deg, projection }.possible()
    }

    /// `asked`: the configuration's primaries.
    fn header(&self, asked: Option<Primaries>) -> Header {
        let (primaries, note) = match asked.filter(|_| !self.is_xyz) {
            Some(asked) => (asked, None),
            None => self.primaries(),
        };
        let mut notes: Vec<String> = note.into_iter().map(str::to_owned).collect();
        if self.aspect != 1.0 {
            let aspect = self.aspect;
            notes.push(format!("its pixels are not square (PIXASPECT {aspect}); read as square"));
        }
        let (white, view) = (self.white(), self.view());
        Header { white, view, notes, ..Header::new(self.width, self.height, Kind::Rgb(primaries)) }
    }

    /// Stored numbers to light.
    fn light(&self, stored: [f32; 3]) -> [f32; 3] {
        let light = [0, 1, 2].map(|i| (f64::from(stored[i]) / self.gain[i]) as f32);
        if !self.is_xyz {
            return light;
        }
        XYZ_TO_REC709.map(|row| row[0] * light[0] + row[1] * light[1] + row[2] * light[2])
    }
}

impl Footage for RadiancePicture {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, _: usize, _: Option<&Projection>, _: Option<Planes>) -> Result<Frame> {
        let (lines, mut reader) = opened(&self.path)?;
        if lines != self.lines {
            return Err(Error::file(&self.path, "changed while it was read"));
        }
        let (width, height) = (lines.width, lines.height);
        let mut line = vec![[0; 4]; width];
        let mut planes = vec![0.0; width * height * 3];
        for row in 0..height {
            rgbe::read_line(&mut reader, &mut line).map_err(|error| {
                Error::file(&self.path, format!("is damaged or cut short: {error}"))
            })?;
            let y = if lines.from_bottom { height - 1 - row } else { row };
            let out = &mut planes[y * width * 3..][..width * 3];
            for (column, &pixel) in line.iter().enumerate() {
                let x = if lines.from_right { width - 1 - column } else { column };
                let rgb = lines.light(rgbe::numbers(pixel));
                (0..3).for_each(|plane| out[plane * width + x] = rgb[plane]);
            }
        }
        examined(&self.path, planes, (width, height), &self.options)
    }
}
