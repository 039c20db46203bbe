//! Where a key stands in the text it was written in.

use toml::de::{DeArray, DeTable, DeValue};

use crate::error::Error;

/// The text of a configuration and what messages call it.
#[derive(Clone, Debug)]
pub(super) struct Source {
    place: String,
    text: String,
    /// Whether somebody wrote it, so that a line of it says something.
    has_lines: bool,
}

impl Source {
    pub(super) fn new(place: &str, text: &str) -> Self {
        Source { place: place.to_owned(), text: text.to_owned(), has_lines: true }
    }

    /// A table that was made by a program.
    pub(super) fn of_table(place: &str, table: &toml::Table) -> Self {
        Source { place: place.to_owned(), text: table.to_string(), has_lines: false }
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// An error about a key, at the line of a dotted path if the text has it.
    pub(super) fn error(&self, path: &str, key: &str, problem: &str) -> Error {
        let start =
            DeTable::parse(&self.text).ok().and_then(|table| start_of(table.get_ref(), path));
        let place = start.map_or_else(|| self.place.clone(), |start| self.place_of(start));
        Error::config(place, key, problem)
    }

    /// A parser's or a type's error, with its line and key.
    pub(super) fn explain(&self, error: &toml::de::Error) -> Error {
        let problem = plain(error.message());
        let Some(span) = error.span() else { return Error::config(&self.place, "TOML", problem) };
        let key =
            DeTable::parse(&self.text).ok().and_then(|table| key_at(table.get_ref(), span.start));
        let place = self.place_of(span.start);
        Error::config(place, key.unwrap_or_else(|| "TOML".into()), problem)
    }

    fn place_of(&self, offset: usize) -> String {
        if !self.has_lines {
            return self.place.clone();
        }
        let line = self.text.bytes().take(offset).filter(|&b| b == b'\n').count() + 1;
        format!("{}:{line}", self.place)
    }
}

/// A type's complaint without the words of programmers.
pub(super) fn plain(message: &str) -> String {
    let words = [
        ("\n", "; "),
        ("floating point", "number"),
        ("sequence", "list"),
        ("u64", "a whole number"),
        ("u32", "a whole number"),
        ("u8", "a whole number"),
        ("f64", "a number"),
        ("struct ", "the table "),
        ("ObserverKeys", "[observer]"),
        ("DisplayKeys", "[display]"),
        ("wanted string or table", "accepted: a word in quotes"),
        ("invalid type: unit variant, expected string only", "accepted: a word"),
    ];
    words.iter().fold(message.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// Byte offset of a dotted path: keys, and numbers of the items of a list. Without a number, the
/// first that fits.
fn start_of(table: &DeTable<'_>, key: &str) -> Option<usize> {
    let (head, rest) = key.split_once('.').map_or((key, None), |(head, rest)| (head, Some(rest)));
    let (name, value) = table.iter().find(|(name, _)| name.get_ref() == head)?;
    let here = Some(name.span().start);
    match (rest, value.get_ref()) {
        (Some(rest), DeValue::Table(inner)) => start_of(inner, rest).or(here),
        (Some(rest), DeValue::Array(list)) => start_in(list, rest).or(here),
        _ => here,
    }
}

/// Byte offset of a path that begins in a list.
fn start_in(list: &DeArray<'_>, path: &str) -> Option<usize> {
    let (head, rest) = path.split_once('.').map_or((path, None), |(head, rest)| (head, Some(rest)));
    let Ok(number) = head.parse::<usize>() else {
        return list.iter().find_map(|item| start_of(item.get_ref().as_table()?, path));
    };
    let item = list.get(number)?;
    let inner = rest.and_then(|rest| start_of(item.get_ref().as_table()?, rest));
    inner.or(Some(item.span().start))
}

/// The dotted key whose name or value covers a byte offset.
fn key_at(table: &DeTable<'_>, offset: usize) -> Option<String> {
    table.iter().find_map(|(name, value)| {
        let covers = |span: std::ops::Range<usize>| span.contains(&offset);
        let deeper = match value.get_ref() {
            DeValue::Table(inner) => key_at(inner, offset),
            DeValue::Array(list) => {
                list.iter().find_map(|item| key_at(item.get_ref().as_table()?, offset))
            }
            _ => None,
        };
        let name_of = |rest: String| format!("{}.{rest}", name.get_ref());
        deeper.map(name_of).or_else(|| {
            (covers(name.span()) || covers(value.span())).then(|| name.get_ref().to_string())
        })
    })
}
