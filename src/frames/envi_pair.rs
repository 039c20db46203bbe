//! The two files of an ENVI picture: the header, and the data beside it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Extensions of data, in the order in which they are looked for. None at all comes first.
const DATA: [&str; 12] =
    ["", "img", "dat", "raw", "bsq", "bil", "bip", "bin", "cue", "rdn", "flt", "lan"];

/// Marks that some editors put before a text (UTF-8).
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Whether a text is an ENVI header.
pub(super) fn is_header(start: &[u8]) -> bool {
    start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start).starts_with(b"ENVI")
}

/// Whether a file of unknown name is data beside a header.
pub(super) fn has_header(path: &Path) -> bool {
    header_of(path).is_some_and(|header| {
        let mut start = Vec::new();
        let file = File::open(header).and_then(|file| file.take(16).read_to_end(&mut start));
        file.is_ok() && is_header(&start)
    })
}

/// The header and the data of a picture, given either.
pub(super) fn pair(path: &Path) -> Result<(PathBuf, PathBuf)> {
    let missing = |part: &str, names: String| {
        Error::file(path, format!("has no {part} beside it; looked for {names}"))
    };
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("hdr")) {
        let data = data_of(path).ok_or_else(|| {
            let stem = path.with_extension("");
            missing("data", format!("{} and {}.*", stem.display(), stem.display()))
        })?;
        return Ok((path.to_owned(), data));
    }
    let header = header_of(path).ok_or_else(|| {
        let names = headers(path).map(|name| name.display().to_string());
        missing("ENVI header", names.join(", "))
    })?;
    Ok((header, path.to_owned()))
}

/// Names of the header of a data file: `a.img.hdr` belongs to `a.img` alone and goes before `a.hdr`.
fn headers(data: &Path) -> [PathBuf; 2] {
    let mut appended = data.as_os_str().to_owned();
    appended.push(".hdr");
    [PathBuf::from(appended), data.with_extension("hdr")]
}

fn header_of(data: &Path) -> Option<PathBuf> {
    headers(data).into_iter().find_map(existing)
}

/// The data of a header: a file that has no header closer to its own name.
fn data_of(header: &Path) -> Option<PathBuf> {
    let named = DATA.iter().filter_map(|extension| existing(header.with_extension(extension)));
    named.into_iter().find(|data| {
        let [own, _] = headers(data);
        existing(own).is_none_or(|own| own == header)
    })
}

/// A file of that name, or of the name in other capitals.
fn existing(path: PathBuf) -> Option<PathBuf> {
    if path.is_file() {
        return Some(path);
    }
    let (folder, name) = (path.parent()?, path.file_name()?);
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let alike = std::fs::read_dir(folder).ok()?.flatten();
    let alike = alike.filter(|entry| entry.file_name().eq_ignore_ascii_case(name));
    alike.map(|entry| path.with_file_name(entry.file_name())).find(|path| path.is_file())
}
