//! The text header of an ENVI picture.
//!
//! ENVI Header Files (NV5 Geospatial documentation): `key = value` lines after a line `ENVI`, lists
//! in braces over as many lines as they need, `;` comments.

use std::collections::BTreeMap;
use std::str::FromStr;

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
    U8,
    I16,
    I32,
    F32,
    F64,
    U16,
    U32,
}

impl Stored {
    pub(super) fn bytes(self) -> usize {
        match self {
            Stored::U8 => 1,
            Stored::I16 | Stored::U16 => 2,
            Stored::I32 | Stored::U32 | Stored::F32 => 4,
            Stored::F64 => 8,
        }
    }
}

/// What the header says of the data beside it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EnviHeader {
    pub(crate) samples: usize,
    pub(crate) lines: usize,
    pub(crate) bands: usize,
    pub(crate) offset: u64,
    pub(crate) stored: Stored,
    pub(crate) interleave: Interleave,
    pub(crate) big_endian: bool,
    /// Centre of each band in the file's order, nm.
    pub(crate) wavelengths: Vec<f64>,
    /// Full width at half maximum of each band, nm; empty where it is not told.
    pub(crate) fwhm: Vec<f64>,
    /// What stored numbers of each band are multiplied by; empty for 1.
    gains: Vec<f64>,
    /// What is added then; empty for 0.
    offsets: Vec<f64>,
    /// Whether each band is to be trusted (`bbl`); empty where it is not told.
    good: Vec<bool>,
    /// The stored number that means no data.
    ignore: Option<f64>,
    pub(crate) notes: Vec<String>,
}

impl EnviHeader {
    /// Factor and summand of a band of the file.
    pub(super) fn gain(&self, band: usize) -> (f64, f64) {
        let of = |list: &[f64], usual: f64| list.get(band).copied().unwrap_or(usual);
        (of(&self.gains, 1.0), of(&self.offsets, 0.0))
    }

    /// Whether a band of the file is to be trusted.
    pub(super) fn is_good(&self, band: usize) -> bool {
        self.good.get(band).copied().unwrap_or(true)
    }

    /// Whether a stored number means that nothing was measured.
    pub(super) fn ignores(&self, value: f64) -> bool {
        self.ignore.is_some_and(|ignore| value == ignore || (value.is_nan() && ignore.is_nan()))
    }
}

/// Reads a header. The problem, if there is one, is a message.
pub(super) fn parse(text: &str) -> Result<EnviHeader, String> {
    let fields = Fields::of(text)?;
    if let Some(factor) = fields.get("reflectance scale factor") {
        return Err(format!(
            "holds reflectances (`reflectance scale factor = {factor}`), not light; if its numbers \
             are radiances, take that line out and say `scale`"
        ));
    }
    let mut notes = Vec::new();
    let bands = fields.whole("bands", None)?;
    let (wavelengths, fwhm) = fields.wavelengths(bands, &mut notes)?;
    let (gains, offsets) = fields.gains(bands, &mut notes)?;
    let good = fields.good(bands, &mut notes)?;
    Ok(EnviHeader {
        samples: fields.whole("samples", None)?,
        lines: fields.whole("lines", None)?,
        bands,
        offset: fields.whole("header offset", Some(0))?,
        stored: stored(fields.whole("data type", None)?)?,
        interleave: interleave(fields.get("interleave").unwrap_or("bsq"))?,
        big_endian: fields.whole("byte order", Some(0u64))? == 1,
        wavelengths,
        fwhm,
        gains,
        offsets,
        good,
        ignore: fields.number("data ignore value")?,
        notes,
    })
}

/// Keys in lower case with single blanks, and their values.
struct Fields(BTreeMap<String, String>);

impl Fields {
    fn of(text: &str) -> Result<Fields, String> {
        let mut lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines();
        if lines.next().map(str::trim) != Some("ENVI") {
            return Err("is not an ENVI header: its first line is not ENVI".into());
        }
        let mut fields = BTreeMap::new();
        let mut lines = lines.filter(|line| !line.trim_start().starts_with(';'));
        while let Some(line) = lines.next() {
            let Some((key, value)) = line.split_once('=') else { continue };
            let key = key.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_lowercase();
            let value = whole_value(value, &mut lines)
                .ok_or_else(|| format!("has no closing brace after `{key}`"))?;
            fields.insert(key, value);
        }
        Ok(Fields(fields))
    }

    /// Centres and widths of the bands, nm. Widths may be absent.
    fn wavelengths(
        &self,
        bands: usize,
        notes: &mut Vec<String>,
    ) -> Result<(Vec<f64>, Vec<f64>), String> {
        let listed = self.list("wavelength", bands)?;
        if listed.is_empty() {
            return Err("has no `wavelength` list, so its bands cannot be placed".into());
        }
        let to_nm = nanometres(self.get("wavelength units"), &listed, notes)?;
        let in_nm = |list: Vec<f64>| list.into_iter().map(|length| length * to_nm).collect();
        Ok((in_nm(listed), in_nm(self.list("fwhm", bands)?)))
    }

    /// Factors and summands of the bands, where they are told.
    fn gains(&self, bands: usize, notes: &mut Vec<String>) -> Result<(Vec<f64>, Vec<f64>), String> {
        let gains = self.list("data gain values", bands)?;
        let offsets = self.list("data offset values", bands)?;
        if !gains.is_empty() || !offsets.is_empty() {
            notes.push("its gains and offsets were applied".into());
        }
        Ok((gains, offsets))
    }

    /// Which bands are to be trusted, where it is told.
    fn good(&self, bands: usize, notes: &mut Vec<String>) -> Result<Vec<bool>, String> {
        let good: Vec<bool> =
            self.list("bbl", bands)?.into_iter().map(|good| good != 0.0).collect();
        let bad = good.iter().filter(|good| !**good).count();
        if bad > 0 {
            notes.push(format!("{bad} of its bands, marked bad by bbl, are left out"));
        }
        Ok(good)
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    fn whole<T: FromStr>(&self, key: &str, default: Option<T>) -> Result<T, String> {
        match self.get(key) {
            Some(text) => {
                let wrong = |_| format!("has `{key} = {text}`, which is no whole number it can be");
                text.parse().map_err(wrong)
            }
            None => default.ok_or_else(|| format!("has no `{key}`")),
        }
    }

    fn number(&self, key: &str) -> Result<Option<f64>, String> {
        let wrong = |text: &str| format!("has `{key} = {text}`, which is no number");
        self.get(key).map(|text| text.parse().map_err(|_| wrong(text))).transpose()
    }

    /// The numbers of a key, one a band; none where there is no such key.
    fn list(&self, key: &str, bands: usize) -> Result<Vec<f64>, String> {
        let numbers = self.get(key).map_or(Ok(Vec::new()), list)?;
        if numbers.is_empty() || numbers.len() == bands {
            return Ok(numbers);
        }
        Err(format!("has {bands} bands but {} numbers in `{key}`", numbers.len()))
    }
}

/// The value that begins on a line, with the lines that follow up to its closing brace.
fn whole_value<'a>(first: &str, lines: &mut impl Iterator<Item = &'a str>) -> Option<String> {
    let first = first.trim();
    if !first.starts_with('{') {
        // Some writers put a comment behind a number; in braces `;` is text.
        return Some(first.split(';').next().unwrap_or_default().trim_end().to_owned());
    }
    let mut value = first.to_owned();
    while !value.contains('}') {
        value.push(' ');
        value.push_str(lines.next()?.trim());
    }
    Some(value)
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
    match unit.map(str::to_lowercase).as_deref() {
        Some("nanometers" | "nanometer" | "nanometres" | "nm") => Ok(1.0),
        Some("micrometers" | "micrometer" | "micrometres" | "microns" | "um" | "µm" | "μm") => {
            Ok(1000.0)
        }
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
        1 => Ok(Stored::U8),
        2 => Ok(Stored::I16),
        3 => Ok(Stored::I32),
        4 => Ok(Stored::F32),
        5 => Ok(Stored::F64),
        12 => Ok(Stored::U16),
        13 => Ok(Stored::U32),
        _ => Err(format!(
            "has `data type = {code}`; read are 1 (u8), 2 (i16), 3 (i32), 4 (f32), 5 (f64), \
             12 (u16) and 13 (u32)"
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
            ("bands = 2", "bands = 3", "3 bands but 2 numbers in `wavelength`"),
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
