//! Names with a number in them: `####`, `%04d`, `$F4`, `@`.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::frames::sequence::absent;

/// A file name with a place for a number of at least `digits` digits.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pattern {
    path: PathBuf,
    before: String,
    after: String,
    digits: usize,
}

impl Pattern {
    /// The pattern in a file name; `None` for a plain name, a problem for more than one place.
    pub fn parse(path: &Path) -> Result<Option<Pattern>, String> {
        let name =
            path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let Some((start, length, digits)) = place(&name) else { return Ok(None) };
        let (before, after) = (name[..start].to_owned(), name[start + length..].to_owned());
        if place(&after).is_some() {
            return Err(format!("`{name}` has more than one place for the frame number"));
        }
        Ok(Some(Pattern { path: path.to_owned(), before, after, digits }))
    }

    /// The files on disk, by number. Numbers padded to another width are taken where no file has
    /// the pattern's.
    pub fn files(&self) -> Result<Vec<(u32, PathBuf)>> {
        let folder = match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
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

/// Start, length and digits of the first place for a number.
fn place(name: &str) -> Option<(usize, usize, usize)> {
    (0..name.len()).filter(|&start| name.is_char_boundary(start)).find_map(|start| {
        let rest = &name[start..];
        let run = |sign: char| rest.chars().take_while(|&c| c == sign).count();
        let digits_after = |prefix: &str| -> Option<(usize, usize)> {
            let rest = rest.strip_prefix(prefix)?;
            let length = rest.bytes().take_while(u8::is_ascii_digit).count().min(2);
            Some((length, rest[..length].parse().unwrap_or(1)))
        };
        let signs = run('#').max(run('@'));
        if signs > 0 {
            return Some((start, signs, signs));
        }
        if let Some((length, digits)) = digits_after("$F") {
            return Some((start, 2 + length, digits.max(1)));
        }
        let (length, digits) = digits_after("%")?;
        rest[1 + length..].starts_with('d').then_some((start, 2 + length, digits.max(1)))
    })
}
