//! Names with a number in them: `####`, `%04d`, `$F4`, `@`.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A file name with a place for a number of at least `digits` digits.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pattern {
    path: PathBuf,
    before: String,
    after: String,
    digits: usize,
}

impl Pattern {
    /// The pattern in a file name; `None` for a plain name, a problem for more than one place. A
    /// lone `#` or `@` beside a place that is certain stands for itself, as in `sun@2x.####.exr`.
    pub(super) fn parse(path: &Path) -> Result<Option<Pattern>, String> {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_default();
        let mut places = places(&name);
        if places.len() > 1 {
            places.retain(|&(_, length, _)| length > 1);
        }
        match places[..] {
            [] if self::places(&name).is_empty() => Ok(None),
            [(start, length, digits)] => {
                let (before, after) = (name[..start].into(), name[start + length..].into());
                Ok(Some(Pattern { path: path.to_owned(), before, after, digits }))
            }
            _ => Err(format!(
                "`{name}` has more than one place for the frame number, or none that is certain; \
                 write the one as ## or %02d"
            )),
        }
    }

    /// The files on disk, by number. Numbers padded to another width are taken where no file has
    /// the pattern's.
    pub(super) fn files(&self) -> Result<Vec<(u32, PathBuf)>> {
        let folder = self.folder();
        let entries =
            std::fs::read_dir(folder).map_err(|_| Error::file(&self.path, absent(&self.path)))?;
        let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        let mut found: Vec<(u32, bool, String)> = names
            .filter_map(|name| {
                let (number, padded) = self.number(&name)?;
                Some((number, padded, name))
            })
            .collect();
        found.sort();
        let clash = |a: &(u32, bool, String), b: &(u32, bool, String)| {
            let problem =
                format!("fits both {} and {}; write the number as one of them has it", a.2, b.2);
            Err(Error::file(&self.path, problem))
        };
        if let (Some(a), Some(b)) =
            (found.iter().find(|file| file.1), found.iter().find(|file| !file.1))
        {
            return clash(a, b);
        }
        if let Some(pair) = found.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return clash(&pair[0], &pair[1]);
        }
        if found.is_empty() {
            return Err(Error::file(&self.path, absent(&self.path)));
        }
        Ok(found.into_iter().map(|(number, _, name)| (number, folder.join(name))).collect())
    }

    /// A file with a negative number, which no frame has.
    pub(super) fn negative(&self) -> Option<String> {
        let entries = std::fs::read_dir(self.folder()).ok()?;
        let mut names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        names.find(|name| {
            let number = name.strip_prefix(&self.before).and_then(|n| n.strip_suffix(&self.after));
            let digits = number.and_then(|number| number.strip_prefix('-')).unwrap_or_default();
            !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
        })
    }

    fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// The number in a name, and whether it is padded as the pattern says.
    fn number(&self, name: &str) -> Option<(u32, bool)> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let plain = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
        let number = plain.then(|| digits.parse().ok())??;
        let padded =
            digits.len() == self.digits || (digits.len() > self.digits && !digits.starts_with('0'));
        Some((number, padded))
    }
}

/// Start, length and digits of every place for a number.
fn places(name: &str) -> Vec<(usize, usize, usize)> {
    let mut found: Vec<(usize, usize, usize)> = Vec::new();
    for start in (0..name.len()).filter(|&start| name.is_char_boundary(start)) {
        if found.last().is_some_and(|(last, length, _)| start < last + length) {
            continue;
        }
        found.extend(place(&name[start..]).map(|(length, digits)| (start, length, digits)));
    }
    found
}

/// Length and digits of the place that a text begins with.
fn place(text: &str) -> Option<(usize, usize)> {
    let run = |sign: char| text.chars().take_while(|&c| c == sign).count();
    let digits_after = |prefix: &str| -> Option<(usize, usize)> {
        let rest = text.strip_prefix(prefix)?;
        let length = rest.bytes().take_while(u8::is_ascii_digit).count().min(2);
        Some((length, rest[..length].parse().unwrap_or(1).max(1)))
    };
    let signs = run('#').max(run('@'));
    if signs > 0 {
        return Some((signs, signs));
    }
    if let Some((length, digits)) = digits_after("$F") {
        return Some((2 + length, digits));
    }
    let (length, digits) = digits_after("%")?;
    text[1 + length..].starts_with('d').then_some((2 + length, digits))
}

/// What stands instead of a file that is not there.
pub(super) fn absent(path: &Path) -> String {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else {
        return format!("not found: there is no folder {}", folder.display());
    };
    let alike = |name: &String| Path::new(name).extension() == path.extension();
    let names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(alike).collect();
    names.sort();
    let more =
        if names.len() > 4 { format!(" and {} more", names.len() - 4) } else { String::new() };
    names.truncate(4);
    let found = if names.is_empty() { "no file of that kind".into() } else { names.join(", ") };
    format!("not found; in {} there is {found}{more}", folder.display())
}
