//! The text header of an ENVI picture.
//!
//! ENVI Header Files (NV5 Geospatial documentation): `key = value` lines after a line `ENVI`, lists
//! in braces over as many lines as they need, `;` comments.

use std::collections::BTreeMap;

/// How samples follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interleave {
    /// Band after band.
    Bsq,
    /// Row after row, inside a row band after band.
    Bil,
    /// Pixel after pixel.
    Bip,
}

/// What a sample is stored as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stored {
    I16,
    F32,
    F64,
    U16,
}

impl Stored {
    pub fn bytes(self) -> usize {
        match self {
            Stored::I16 | Stored::U16 => 2,
            Stored::F32 => 4,
            Stored::F64 => 8,
        }
    }
}

/// What the header says of the data beside it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EnviHeader {
    pub samples: usize,
    pub lines: usize,
    pub offset: u64,
    pub stored: Stored,
    pub interleave: Interleave,
    pub big_endian: bool,
    /// Centre of each band in the file's order, nm.
    pub wavelengths: Vec<f64>,
    /// Full width at half maximum of each band, nm; empty where it is not told.
    pub fwhm: Vec<f64>,
    /// Stored numbers are divided by this.
    pub divisor: f64,
    /// The stored number that means no data.
    pub ignore: Option<f64>,
    pub notes: Vec<String>,
}

impl EnviHeader {
    /// Whether a stored number means that nothing was measured.
    pub fn ignores(&self, value: f64) -> bool {
        self.ignore.is_some_and(|ignore| value == ignore || (value.is_nan() && ignore.is_nan()))
    }
}

/// Reads a header. The problem, if there is one, is a message.
pub(super) fn parse(text: &str) -> Result<EnviHeader, String> {
    let fields = fields(text)?;
    let field = |key: &str| fields.get(key).map(String::as_str);
    let whole = |key: &str, default: Option<u64>| match field(key) {
        Some(text) => {
            text.parse().map_err(|_| format!("has `{key} = {text}`, which is no whole number"))
        }
        None => default.ok_or_else(|| format!("has no `{key}`")),
    };
    let number = |key: &str| match field(key) {
        Some(text) => match text.parse::<f64>() {
            Ok(number) => Ok(Some(number)),
            Err(_) => Err(format!("has `{key} = {text}`, which is no number")),
        },
        None => Ok(None),
    };
    let mut notes = Vec::new();
    let bands = whole("bands", None)?;
    let listed = list(
        field("wavelength").ok_or("has no `wavelength` list, so its bands cannot be placed")?,
    )?;
    if listed.len() as u64 != bands {
        return Err(format!("has {bands} bands but {} wavelengths", listed.len()));
    }
    let to_nm = nanometres(field("wavelength units"), &listed, &mut notes)?;
    let fwhm = field("fwhm").map_or(Ok(Vec::new()), list)?;
    let divisor = number("reflectance scale factor")?.unwrap_or(1.0);
    if !divisor.is_normal() {
        return Err(format!("has a `reflectance scale factor` of {divisor}"));
    }
    for key in ["data gain values", "data offset values"] {
        if fields.contains_key(key) {
            notes.push(format!("`{key}` is not applied; use `scale`"));
        }
    }
    Ok(EnviHeader {
        samples: whole("samples", None)?.try_into().map_err(|_| "is too wide")?,
        lines: whole("lines", None)?.try_into().map_err(|_| "is too high")?,
        offset: whole("header offset", Some(0))?,
        stored: stored(whole("data type", None)?)?,
        interleave: interleave(field("interleave").unwrap_or("bsq"))?,
        big_endian: whole("byte order", Some(0))? == 1,
        wavelengths: listed.iter().map(|wavelength| wavelength * to_nm).collect(),
        fwhm: if fwhm.len() == listed.len() {
            fwhm.iter().map(|width| width * to_nm).collect()
        } else {
            Vec::new()
        },
        divisor,
        ignore: number("data ignore value")?,
        notes,
    })
}

/// Keys in lower case with single blanks, and their values.
fn fields(text: &str) -> Result<BTreeMap<String, String>, String> {
    let mut lines = text.lines();
    if lines.next().map(str::trim) != Some("ENVI") {
        return Err("is not an ENVI header: its first line is not ENVI".into());
    }
    let mut fields = BTreeMap::new();
    while let Some(line) = lines.next() {
        let line = without_comment(line);
        let Some((key, value)) = line.split_once('=') else { continue };
        let key = key.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_lowercase();
        let mut value = value.trim().to_owned();
        while value.starts_with('{') && !value.contains('}') {
            let next = lines.next().ok_or_else(|| format!("has no closing brace after `{key}`"))?;
            value.push(' ');
            value.push_str(without_comment(next).trim());
        }
        fields.insert(key, value);
    }
    Ok(fields)
}

fn without_comment(line: &str) -> &str {
    line.split(';').next().unwrap_or_default()
}

/// The numbers of a list in braces.
fn list(text: &str) -> Result<Vec<f64>, String> {
    let inside = text.trim().trim_start_matches('{').split('}').next().unwrap_or_default();
    let words = inside.split([',', ' ', '\t']).filter(|word| !word.is_empty());
    let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
    words
        .map(|word| number(word).ok_or_else(|| format!("has `{word}` in a list of numbers")))
        .collect()
}

/// The factor to nm.
fn nanometres(
    unit: Option<&str>,
    wavelengths: &[f64],
    notes: &mut Vec<String>,
) -> Result<f64, String> {
    match unit.map(str::to_ascii_lowercase).as_deref() {
        Some("nanometers" | "nanometer" | "nanometres" | "nm") => Ok(1.0),
        Some("micrometers" | "micrometer" | "micrometres" | "microns" | "um") => Ok(1000.0),
        None | Some("unknown") => {
            let micrometres = wavelengths.iter().all(|wavelength| *wavelength < 100.0);
            let unit = if micrometres { "micrometres" } else { "nanometres" };
            notes.push(format!("`wavelength units` are not told: taken as {unit}"));
            Ok(if micrometres { 1000.0 } else { 1.0 })
        }
        Some(other) => {
            Err(format!("has wavelengths in `{other}`; nanometers and micrometers are read"))
        }
    }
}

fn stored(code: u64) -> Result<Stored, String> {
    match code {
        2 => Ok(Stored::I16),
        4 => Ok(Stored::F32),
        5 => Ok(Stored::F64),
        12 => Ok(Stored::U16),
        _ => Err(format!(
            "has `data type = {code}`; read are 2 (i16), 4 (f32), 5 (f64) and 12 (u16)"
        )),
    }
}

fn interleave(text: &str) -> Result<Interleave, String> {
    match text.to_ascii_lowercase().as_str() {
        "bsq" => Ok(Interleave::Bsq),
        "bil" => Ok(Interleave::Bil),
        "bip" => Ok(Interleave::Bip),
        _ => Err(format!("has `interleave = {text}`; bsq, bil and bip are read")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "ENVI\n; made by hand\nSamples = 2\nlines=3 ; three\nbands = 2\ndata type = 12\n\
                         interleave = BIL\nwavelength units = Micrometers\nWavelength = {0.7,\n 0.5 }\nfwhm = {.01, .01}\n";

    #[test]
    fn keys_in_any_case_comments_and_lists_over_lines_are_read() {
        let header = parse(SMALL).unwrap();
        assert_eq!((header.samples, header.lines, header.stored), (2, 3, Stored::U16));
        assert_eq!((header.interleave, header.wavelengths), (Interleave::Bil, vec![700.0, 500.0]));
        assert_eq!(header.fwhm, [10.0, 10.0]);
    }

    #[test]
    fn what_is_wrong_is_said_with_what_is_accepted() {
        for (from, to, expected) in [
            ("data type = 12", "data type = 6", "4 (f32)"),
            ("BIL", "bi", "bsq, bil and bip"),
            ("Micrometers", "GHz", "nanometers and micrometers"),
            ("bands = 2", "bands = 3", "3 bands but 2 wavelengths"),
            ("bands = 2\n", "", "has no `bands`"),
            ("0.7", "0,7x", "`7x`"),
            ("ENVI", "ENVY", "not an ENVI header"),
            (".01}", ".01", "no closing brace"),
        ] {
            let problem = parse(&SMALL.replacen(from, to, 1)).unwrap_err();
            assert!(problem.contains(expected), "{problem}");
        }
    }
}
