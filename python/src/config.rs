//! A configuration from what Python gives: nothing, a file, or a dictionary of the same keys.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use sungaze::config::{Config, Table, Value};

use crate::errors::{raised, refused};

/// The configuration that an argument names.
pub(crate) fn config_of(given: Option<&Bound<'_, PyAny>>) -> PyResult<Config> {
    let Some(given) = given else { return Config::load(None, &[]).map_err(raised) };
    if let Ok(keys) = given.cast::<PyDict>() {
        let table = table_of("config", keys)?;
        return Config::of_table(&table, "config", "run", Path::new("")).map_err(raised);
    }
    let path: PathBuf = given.extract().map_err(|_| {
        refused("config", described(given), "the path of a TOML file, a dict of its keys, or None")
    })?;
    Config::load(Some(&path), &[]).map_err(raised)
}

/// A value and its type, for messages.
pub(crate) fn described(value: &Bound<'_, PyAny>) -> String {
    let kind = value.get_type().name().map_or_else(|_| "object".into(), |name| name.to_string());
    value.repr().map_or(kind.clone(), |repr| format!("{repr} ({kind})"))
}

/// A dictionary as a table; keys whose value is `None` are left out.
fn table_of(place: &str, keys: &Bound<'_, PyDict>) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, value) in keys.iter().filter(|(_, value)| !value.is_none()) {
        let word: String = key
            .extract()
            .map_err(|_| refused(place, format!("the key {}", described(&key)), "words"))?;
        let value = value_of(&format!("{place}: {word}"), &value)?;
        table.insert(word, value);
    }
    Ok(table)
}

/// A value of TOML. Arrays and scalars of NumPy count as lists and numbers.
fn value_of(place: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if value.hasattr("tolist")? {
        return value_of(place, &value.call_method0("tolist")?);
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(value.extract()?));
    }
    if let (true, Ok(whole)) = (value.is_instance_of::<PyInt>(), value.extract()) {
        return Ok(Value::Integer(whole));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(value.extract()?));
    }
    if let Ok(word) = value.cast::<PyString>() {
        return Ok(Value::String(word.to_str()?.to_owned()));
    }
    if let Ok(keys) = value.cast::<PyDict>() {
        return Ok(Value::Table(table_of(place, keys)?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| value_of(place, &item?));
        return Ok(Value::Array(items.collect::<PyResult<_>>()?));
    }
    let path: Result<PathBuf, _> = value.extract();
    path.map(|path| Value::String(path.to_string_lossy().into_owned())).map_err(|_| {
        refused(place, described(value), "numbers, words, paths, lists and dicts of them")
    })
}
