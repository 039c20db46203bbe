//! TOML -> a run. The only room that names `toml`; every message names its key and, where there is
//! one, its line.
//!
//! Precedence: preset < constants < keys of the file < `--set`.

mod check;
mod field;
mod named;
mod resolve;
pub mod settings;
mod source;
mod sweep;
#[cfg(feature = "view")]
mod viewing;
mod words;

use std::path::{Path, PathBuf};

pub use toml::{Table, Value};

use crate::constants;
use crate::error::{Error, Result};

pub(crate) use settings::Settings;
use source::Source;
pub use sweep::{Case, Sweep};

/// A configuration that has been read, with everything needed to speak of its keys.
#[derive(Clone, Debug)]
pub struct Config {
    /// Every key, as the run will use it.
    pub settings: Settings,
    /// File name without ending, or `sunset`.
    pub name: String,
    base: PathBuf,
    source: Source,
    /// Keys that were given by `--set`.
    set_keys: Vec<String>,
    keys: Table,
}

impl Config {
    /// Reads a configuration file (`None`: an empty one) and applies `KEY=VALUE` settings on top of
    /// it.
    pub fn load(path: Option<&Path>, sets: &[String]) -> Result<Config> {
        let Some(path) = path else {
            return Config::parse("", "the built-in defaults", "sunset", Path::new(""), sets);
        };
        let unreadable = |e: std::io::Error| {
            Error::config(path.display().to_string(), "CONFIG", format!("cannot read: {e}"))
        };
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        let name = path
            .file_stem()
            .map_or_else(|| "run".into(), |stem| stem.to_string_lossy().into_owned());
        Config::parse(
            &text,
            &path.display().to_string(),
            &name,
            path.parent().unwrap_or(Path::new("")),
            sets,
        )
    }

    /// Reads a configuration from text. `place` is what messages call it; relative paths are
    /// relative to `base`.
    pub fn parse(
        text: &str,
        place: &str,
        name: &str,
        base: &Path,
        sets: &[String],
    ) -> Result<Config> {
        Config::of_source(Source::new(place, text), name, base, sets)
    }

    /// A configuration from a table that a program has made, of the same keys as a file. `place` is
    /// what messages call it; relative paths are relative to `base`.
    ///
    /// # Errors
    /// A key is unknown, or its value is not accepted.
    pub fn of_table(table: &Table, place: &str, name: &str, base: &Path) -> Result<Config> {
        Config::of_source(Source::of_table(place, table), name, base, &[])
    }

    fn of_source(source: Source, name: &str, base: &Path, sets: &[String]) -> Result<Config> {
        let text = source.text();
        toml::from_str::<Settings>(text).map_err(|error| source.explain(&error))?;
        let mut keys: Table = toml::from_str(text).map_err(|error| source.explain(&error))?;
        let mut set_keys = Vec::new();
        let mut settings =
            effective(&keys).map_err(|(key, problem)| source.error(&key, &key, &problem))?;
        for set in sets {
            let (key, value) = parse_set(set)?;
            insert(&mut keys, &key, value)
                .map_err(|problem| Error::config("--set", &key, problem))?;
            settings =
                effective(&keys).map_err(|(_, problem)| Error::config("--set", &key, problem))?;
            set_keys.push(key);
        }
        let config = Config {
            settings,
            name: name.to_owned(),
            base: base.to_owned(),
            source,
            set_keys,
            keys,
        };
        check::check(&config.settings).map_err(|(key, problem)| config.wrong(&key, problem))?;
        Ok(config)
    }

    /// This configuration with some keys set to other values: one case of a sweep.
    pub fn with(&self, changes: &[(String, Value)]) -> Result<Config> {
        let mut config = self.clone();
        for (key, value) in changes {
            insert(&mut config.keys, key, value.clone())
                .map_err(|problem| self.wrong(key, problem))?;
            config.settings =
                effective(&config.keys).map_err(|(_, problem)| self.wrong(key, problem))?;
        }
        check::check(&config.settings).map_err(|(key, problem)| self.wrong(&key, problem))?;
        Ok(config)
    }

    /// The same for frames that a caller brings instead of a scene: silence about the optics then
    /// means none, as it does of files.
    ///
    /// # Errors
    /// None that the configuration did not have before.
    pub fn for_given_frames(&self) -> Result<Config> {
        let psf = "optics.psf";
        if self.gives(psf) {
            return Ok(self.clone());
        }
        self.with(&[(psf.to_owned(), Value::String("none".into()))])
    }

    /// The same with values as a page sends them; null takes a key back to its default.
    pub fn with_values(&self, changes: &[(String, serde_json::Value)]) -> Result<Config> {
        let mut config = self.clone();
        let (gone, changes): (Vec<_>, Vec<_>) = changes.iter().partition(|(_, v)| v.is_null());
        gone.iter().for_each(|(key, _)| remove(&mut config.keys, key));
        config.settings =
            effective(&config.keys).map_err(|(key, problem)| self.wrong(&key, problem))?;
        let value = |(key, v): &(String, serde_json::Value)| {
            let value = Value::try_from(v).map_err(|e| self.wrong(key, e.to_string()))?;
            Ok((key.clone(), value))
        };
        config.with(&changes.into_iter().map(value).collect::<Result<Vec<_>>>()?)
    }

    /// Whether the file or `--set` gives a key, dotted.
    pub fn gives(&self, key: &str) -> bool {
        let mut parts = key.split('.');
        let first = parts.next().and_then(|part| self.keys.get(part));
        parts.fold(first, |value, part| value?.get(part)).is_some()
    }

    /// An error about one of the keys: at its line if the file has it, or at the setting that gave
    /// it.
    pub fn wrong(&self, key: &str, problem: impl Into<String>) -> Error {
        let given = |set: &String| {
            key == set || key.starts_with(&format!("{set}.")) || set.starts_with(&format!("{key}."))
        };
        if self.set_keys.iter().any(given) {
            return Error::config("--set", key, problem);
        }
        self.source.error(key, key, &problem.into())
    }

    /// An error about a key, at the line of another path.
    fn wrong_at(&self, path: &str, key: &str, problem: &str) -> Error {
        self.source.error(path, key, problem)
    }

    /// A path of the configuration, relative to its file.
    pub(crate) fn path(&self, written: &str) -> PathBuf {
        self.base.join(written)
    }
}

/// A key and what is wrong with its value.
type Wrong = (String, String);

/// The keys on top of what their preset and their set of constants say, as typed settings.
fn effective(keys: &Table) -> std::result::Result<Settings, Wrong> {
    let word = |table: &Table, key: &str| -> Option<String> {
        Some(table.get("observer")?.get(key)?.as_str()?.to_owned())
    };
    let mut all = match word(keys, "preset").as_deref() {
        None | Some("standard") => Table::new(),
        Some("paper") => paper(),
        Some(other) => {
            return Err((
                "observer.preset".into(),
                format!("found {other:?}; accepted: standard, paper"),
            ));
        }
    };
    let named = word(keys, "constants").or_else(|| word(&all, "constants"));
    if let Some(name) = named {
        merge(&mut all, &constants_table(&name)?);
    }
    merge(&mut all, keys);
    let settings = all.try_into::<Settings>();
    settings
        .map(Settings::completed)
        .map_err(|error| ("settings".into(), source::plain(error.message())))
}

/// Preset `paper`: the observer of Gutierrez et al. 2005. With `numerics.model = "steady"` it is
/// their model.
fn paper() -> Table {
    toml::toml! {
        [observer]
        fundamentals = "smj1993"
        field_deg = 10
        pupil = "moon-spencer-as-printed"
        stiles_crawford = "paper"
        stiles_crawford_p = "lens-corrected"
        constants = "paper"
        narrowing = "narrowed"
        [gaze]
        surround_cd_m2 = 0
        [display]
        tone = "ward"
    }
}

fn constants_table(name: &str) -> std::result::Result<Table, Wrong> {
    let Some(set) = constants::named(name) else {
        let names: Vec<_> = constants::CONSTANTS.iter().map(|set| set.name).collect();
        return Err((
            "observer.constants".into(),
            format!("found {name:?}; accepted: {}", names.join(", ")),
        ));
    };
    let (half_bleach, tau) = (set.half_bleach_log_td.to_vec(), set.tau_s.to_vec());
    let mut observer = Table::new();
    observer.insert("half_bleach_log_td".into(), half_bleach.into());
    observer.insert("tau_s".into(), tau.into());
    observer.insert("kinetics".into(), set.law.into());
    observer.insert("km".into(), set.km.into());
    Ok(Table::from_iter([("observer".to_owned(), Value::Table(observer))]))
}

/// Lays `over` on top of `under`, table by table.
fn merge(under: &mut Table, over: &Table) {
    for (key, value) in over {
        match (under.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            _ => {
                under.insert(key.clone(), value.clone());
            }
        }
    }
}

/// Splits `KEY=VALUE`; VALUE is TOML, or a bare word.
fn parse_set(set: &str) -> Result<(String, Value)> {
    let Some((key, value)) = set.split_once('=') else {
        return Err(Error::config("--set", set, "must read KEY=VALUE, such as observer.age=60"));
    };
    let (key, value) = (key.trim(), value.trim());
    let as_toml = toml::from_str::<Table>(&format!("value = {value}"))
        .ok()
        .and_then(|mut t| t.remove("value"));
    Ok((key.to_owned(), as_toml.unwrap_or_else(|| Value::String(value.to_owned()))))
}

/// Takes a dotted key away.
fn remove(table: &mut Table, key: &str) {
    match key.split_once('.') {
        None => drop(table.remove(key)),
        Some((head, rest)) => {
            if let Some(Value::Table(inner)) = table.get_mut(head) {
                remove(inner, rest);
            }
        }
    }
}

/// Sets a dotted key.
fn insert(table: &mut Table, key: &str, value: Value) -> std::result::Result<(), String> {
    let (head, rest) = match key.split_once('.') {
        Some((head, rest)) => (head, Some(rest)),
        None => (key, None),
    };
    if head.is_empty() {
        return Err("a key is dotted words, such as observer.age".into());
    }
    let Some(rest) = rest else {
        table.insert(head.to_owned(), value);
        return Ok(());
    };
    match table.entry(head).or_insert_with(|| Value::Table(Table::new())) {
        Value::Table(inner) => insert(inner, rest, value),
        _ => Err(format!("{head} is not a table")),
    }
}
