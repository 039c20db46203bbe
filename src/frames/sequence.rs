//! Which file shows which frame: patterns, lists, ranges and gaps.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::frames::pattern::{Pattern, absent};
use crate::frames::range;

/// What a number without a file is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Missing {
    /// An error that names the numbers.
    #[default]
    Error,
    /// The frame before is held.
    Hold,
}

/// Numbered frames and the files that show them.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// The number of each frame, rising.
    pub numbers: Vec<u32>,
    /// The files, each once.
    pub files: Vec<PathBuf>,
    /// For each frame the index of its file.
    pub shows: Vec<usize>,
    /// The numbers that had no file and show the one before.
    pub(crate) held: Vec<u32>,
    /// One file that is stared at. The only file of a pattern is a frame of its own number.
    pub(crate) is_still: bool,
    /// The range that was asked for.
    range: String,
}

impl Sequence {
    /// Finds the files of one pattern, one still, or a list of files. A still counts as 1, a list
    /// from 1 on. An empty `range` is all that are there, from the first to the last in even steps.
    pub fn find(
        frames: &[String],
        folder: &Path,
        range: &str,
        missing: Missing,
    ) -> Result<Sequence> {
        let found = match frames {
            [] => return Err(Error::config("[input]", "frames", "names no file")),
            [one] => numbered(one, folder, range)?,
            list => {
                let paths = list.iter().map(|name| existing(folder.join(name)));
                (1..).zip(paths).map(|(number, path)| Ok((number, path?))).collect::<Result<_>>()?
            }
        };
        let is_still = frames.len() == 1 && pattern(&frames[0], folder)?.is_none();
        // A film's numbers are known when it has been opened.
        let wanted = if range.is_empty() || is_still {
            even_steps(&found)?
        } else {
            range::parse(range).map_err(|problem| Error::config("[input]", "range", problem))?
        };
        let name = folder.join(&frames[0]);
        Ok(Sequence { is_still, range: range.into(), ..laid_out(&name, &found, wanted, missing)? })
    }
}

impl Sequence {
    /// The same, where one file may be a film of many frames, which are numbered from 1. The
    /// problem, if there is one, is a message about the range.
    pub(crate) fn of_film(mut self, frames: usize) -> Result<Sequence, String> {
        if self.is_still && !self.range.is_empty() {
            self.numbers = range::parse(&self.range)?;
        } else if self.is_still {
            self.numbers = (1..=frames as u32).collect();
        } else {
            return Ok(self);
        }
        let lacks = |number: &&u32| !(1..=frames).contains(&(**number as usize));
        if let Some(number) = self.numbers.iter().find(lacks) {
            return Err(format!("frame {number} is not in the file, which has {frames}"));
        }
        self.shows = self.numbers.iter().map(|number| *number as usize - 1).collect();
        self.is_still = frames == 1;
        Ok(self)
    }
}

/// The numbered files of a pattern, or the one file of that name.
fn numbered(name: &str, folder: &Path, range: &str) -> Result<Vec<(u32, PathBuf)>> {
    let Some(pattern) = pattern(name, folder)? else {
        return Ok(vec![(1, existing(folder.join(name))?)]);
    };
    if let (Some(negative), true) = (pattern.negative(), range.is_empty()) {
        let problem = format!(
            "has frames with negative numbers, such as {negative}, which cannot be run; say which \
             of the others in `range`"
        );
        return Err(Error::file(folder.join(name), problem));
    }
    pattern.files()
}

/// The pattern of a name that is no file's.
fn pattern(name: &str, folder: &Path) -> Result<Option<Pattern>> {
    let path = folder.join(name);
    if path.is_file() {
        return Ok(None);
    }
    Pattern::parse(&path).map_err(|problem| Error::config("[input]", "frames", problem))
}

fn existing(path: PathBuf) -> Result<PathBuf> {
    if path.is_file() {
        return Ok(path);
    }
    let problem = if path.is_dir() {
        "is a folder; name a file or a pattern in it".into()
    } else {
        absent(&path)
    };
    Err(Error::file(path, problem))
}

/// Numbers from the first to the last in the largest step that meets them all.
fn even_steps(found: &[(u32, PathBuf)]) -> Result<Vec<u32>> {
    let (Some(first), Some(last)) = (found.first(), found.last()) else { return Ok(Vec::new()) };
    let step = found.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(0, gcd).max(1);
    let count = (last.0 - first.0) / step;
    if count as usize >= range::LONGEST {
        let problem = format!(
            "runs from number {} to {}; at most {} frames are read",
            first.0,
            last.0,
            range::LONGEST
        );
        return Err(Error::file(&last.1, problem));
    }
    Ok((0..=count).map(|i| first.0 + i * step).collect())
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Gives each wanted number its file, and each gap the policy's.
fn laid_out(
    name: &Path,
    found: &[(u32, PathBuf)],
    wanted: Vec<u32>,
    missing: Missing,
) -> Result<Sequence> {
    let file_of = |number: u32| found.binary_search_by_key(&number, |found| found.0).ok();
    let held: Vec<u32> =
        wanted.iter().copied().filter(|&number| file_of(number).is_none()).collect();
    let nothing_to_hold = !held.is_empty() && held.first() == wanted.first();
    if !held.is_empty() && (missing == Missing::Error || nothing_to_hold) {
        let hint = if nothing_to_hold {
            "the first of them has none before it to hold"
        } else {
            "missing = \"hold\" shows the one before"
        };
        let there = match (found.first(), found.last()) {
            (Some(first), Some(last)) => {
                format!("{} are there, {} to {}", found.len(), first.0, last.0)
            }
            _ => "none is there".into(),
        };
        return Err(Error::file(
            name,
            format!("numbers {} have no file ({there}); {hint}", range::show(&held)),
        ));
    }
    let mut files: Vec<PathBuf> = Vec::new();
    let mut shows = Vec::with_capacity(wanted.len());
    for &number in &wanted {
        if let Some(at) = file_of(number) {
            files.push(found[at].1.clone());
        }
        shows.push(files.len() - 1);
    }
    Ok(Sequence { numbers: wanted, files, shows, held, is_still: false, range: String::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        folder
    }

    fn find(
        folder: &tempfile::TempDir,
        frames: &[&str],
        range: &str,
        missing: Missing,
    ) -> Result<Sequence, String> {
        let frames: Vec<String> = frames.iter().map(|name| name.to_string()).collect();
        Sequence::find(&frames, folder.path(), range, missing).map_err(|error| error.to_string())
    }

    const SUN: [&str; 6] = [
        "sun.0001.exr",
        "sun.0002.exr",
        "sun.0004.exr",
        "sun.10000.exr",
        "sun.x.exr",
        "other.0003.exr",
    ];

    #[test]
    fn every_way_to_write_four_digits_finds_the_same_files() {
        let folder = folder(&SUN);
        for name in ["sun.####.exr", "sun.%04d.exr", "sun.$F4.exr", "sun.@@@@.exr"] {
            let found = find(&folder, &[name], "1-2,4,10000", Missing::Error).unwrap();
            assert_eq!(found.numbers, [1, 2, 4, 10000], "{name}");
            assert!(found.files[3].ends_with("sun.10000.exr"));
        }
    }

    #[test]
    fn a_gap_is_an_error_that_names_it_or_shows_the_frame_before() {
        let folder = folder(&SUN[..3]);
        let message = find(&folder, &["sun.####.exr"], "", Missing::Error).unwrap_err();
        assert!(
            message.contains("numbers 3 have no file") && message.contains("sun.####.exr"),
            "{message}"
        );
        let held = find(&folder, &["sun.####.exr"], "", Missing::Hold).unwrap();
        assert_eq!(
            (held.numbers, held.shows, held.held),
            (vec![1, 2, 3, 4], vec![0, 1, 1, 2], vec![3])
        );
        let message = find(&folder, &["sun.####.exr"], "0-2", Missing::Hold).unwrap_err();
        assert!(message.contains("none before it"), "{message}");
    }

    #[test]
    fn every_second_frame_is_a_sequence_without_gaps() {
        let folder = folder(&["a.1.exr", "a.3.exr", "a.7.exr", "a.5.exr"]);
        assert_eq!(find(&folder, &["a.@.exr"], "", Missing::Error).unwrap().numbers, [1, 3, 5, 7]);
    }

    #[test]
    fn four_signs_take_other_lengths_only_where_there_is_no_doubt() {
        let short = folder(&["a.1.exr", "a.2.exr", "a.12.exr"]);
        assert_eq!(find(&short, &["a.####.exr"], "1-2", Missing::Error).unwrap().files.len(), 2);
        for both in [["a.0001.exr", "a.2.exr"], ["a.1.exr", "a.01.exr"]] {
            let message = find(&folder(&both), &["a.####.exr"], "", Missing::Error).unwrap_err();
            assert!(both.iter().all(|name| message.contains(name)), "{message}");
        }
    }

    #[test]
    fn the_only_file_of_a_pattern_is_a_frame_of_its_number_and_a_lone_file_a_still() {
        let folder = folder(&["a.1001.exr", "a.1005.exr", "b.0007.exr"]);
        let one = find(&folder, &["a.####.exr"], "1005", Missing::Error).unwrap();
        assert_eq!((one.numbers, one.is_still), (vec![1005], false));
        let one = find(&folder, &["b.%04d.exr"], "", Missing::Error).unwrap();
        assert_eq!((one.numbers, one.is_still), (vec![7], false));
        let still = find(&folder, &["b.0007.exr"], "", Missing::Error).unwrap();
        assert_eq!((still.numbers, still.is_still), (vec![1], true));
    }

    #[test]
    fn a_lone_sign_beside_a_certain_place_stands_for_itself() {
        let folder = folder(&["sun@2x.0001.exr", "sun@2x.0002.exr", "cut#3.0001.exr"]);
        for name in ["sun@2x.####.exr", "sun@2x.%04d.exr", "sun@2x.$F4.exr"] {
            let found = find(&folder, &[name], "", Missing::Error).unwrap();
            assert_eq!(found.numbers, [1, 2], "{name}");
        }
        assert_eq!(find(&folder, &["cut#3.@@@@.exr"], "", Missing::Error).unwrap().numbers, [1]);
        for name in ["sun@2x.#.exr", "a.##.@@.exr"] {
            let message = find(&folder, &[name], "", Missing::Error).unwrap_err();
            assert!(message.contains("more than one place"), "{message}");
        }
    }

    #[test]
    fn frames_with_negative_numbers_are_never_left_out_in_silence() {
        let folder = folder(&["a.-002.exr", "a.0000.exr", "a.0001.exr"]);
        let message = find(&folder, &["a.####.exr"], "", Missing::Error).unwrap_err();
        assert!(message.contains("a.-002.exr") && message.contains("`range`"), "{message}");
        assert_eq!(find(&folder, &["a.####.exr"], "0-1", Missing::Error).unwrap().numbers, [0, 1]);
    }

    #[test]
    fn a_film_is_numbered_from_one_and_nothing_beyond_it_is_asked_for() {
        let folder = folder(&["a.mov"]);
        let found = |range| find(&folder, &["a.mov"], range, Missing::Error).unwrap();
        let all = found("").of_film(3).unwrap();
        assert_eq!((all.numbers, all.shows, all.is_still), (vec![1, 2, 3], vec![0, 1, 2], false));
        let some = found("2-6x2").of_film(6).unwrap();
        assert_eq!((some.numbers, some.shows), (vec![2, 4, 6], vec![1, 3, 5]));
        assert!(found("0-2").of_film(3).unwrap_err().contains("frame 0 is not in the file"));
        assert!(found("4").of_film(3).unwrap_err().contains("which has 3"));
        assert!(found("").of_film(1).unwrap().is_still);
    }

    #[test]
    fn stills_and_lists_count_from_one() {
        let folder = folder(&["b.exr", "a#1.exr", "c.exr"]);
        assert_eq!(find(&folder, &["a#1.exr"], "", Missing::Error).unwrap().numbers, [1]);
        let list = find(&folder, &["c.exr", "b.exr"], "", Missing::Error).unwrap();
        assert!(list.files[0].ends_with("c.exr"));
        assert_eq!(list.numbers, [1, 2]);
    }

    #[test]
    fn what_is_not_there_is_answered_with_what_is() {
        let folder = folder(&SUN);
        let message = find(&folder, &["sin.exr"], "", Missing::Error).unwrap_err();
        assert!(
            message.contains("not found; in ") && message.contains("other.0003.exr"),
            "{message}"
        );
        let message = find(&folder, &["moon.####.exr"], "", Missing::Error).unwrap_err();
        assert!(message.contains("moon.####.exr") && message.contains("sun.0001.exr"), "{message}");
        let message = find(&folder, &["no/folder/sun.####.exr"], "", Missing::Error).unwrap_err();
        assert!(message.contains("there is no folder"), "{message}");
    }
}
