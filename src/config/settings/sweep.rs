//! `[sweep]`: durations, and lists of values for any keys.

use serde::Deserialize;
use toml::Value;

/// `[sweep]` as it is written.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SweepKeys {
    pub(crate) durations_s: Durations,
    /// Whether every cell's percept and display picture are written.
    #[serde(default = "yes")]
    pub(crate) pictures: bool,
    #[serde(default)]
    pub(crate) vary: Vec<Vary>,
}

fn yes() -> bool {
    true
}

/// A list, or a logarithmic range.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a list of seconds, or { from, to, count } for logarithmic steps")]
pub(crate) enum Durations {
    Listed(Vec<f64>),
    Spaced(Spaced),
}

/// `count` durations from `from` to `to`, in even ratios.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Spaced {
    from: f64,
    to: f64,
    count: usize,
}

/// `[[sweep.vary]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Vary {
    pub(crate) key: Keys,
    pub(crate) values: Values,
}

/// One key, or several that move together.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a key, or a list of keys that move together")]
pub(crate) enum Keys {
    One(String),
    Together(Vec<String>),
}

/// A list of values (of lists, one value a key, where several move together), or logarithmic steps.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a list of values, or { from, to, count } for logarithmic steps")]
pub(crate) enum Values {
    // First: a list of three would do for a `Spaced` as well.
    Listed(Vec<Value>),
    Spaced(Spaced),
}

impl Keys {
    /// The keys, in their order.
    pub(crate) fn names(&self) -> &[String] {
        match self {
            Keys::One(key) => std::slice::from_ref(key),
            Keys::Together(keys) => keys,
        }
    }
}

impl Vary {
    /// How many values there are.
    pub(in crate::config) fn len(&self) -> usize {
        match &self.values {
            Values::Listed(list) => list.len(),
            Values::Spaced(spaced) => spaced.count,
        }
    }

    /// Value `i`, and what it gives to each key.
    pub(in crate::config) fn at(&self, i: usize) -> Vec<(String, Value)> {
        let value = match &self.values {
            Values::Listed(list) => list[i].clone(),
            Values::Spaced(spaced) => Value::Float(spaced.at(i)),
        };
        match (&self.key, value) {
            (Keys::One(key), value) => vec![(key.clone(), value)],
            (Keys::Together(keys), Value::Array(row)) => keys.iter().cloned().zip(row).collect(),
            (Keys::Together(_), _) => Vec::new(),
        }
    }
}

/// More durations, or more cases, are a slip of the keyboard.
pub(in crate::config) const MOST: usize = 10_000;

pub(in crate::config) type Wrong = (&'static str, String);

impl Spaced {
    pub(in crate::config) fn check(self) -> Result<(), String> {
        let Spaced { from, to, count } = self;
        if from > 0.0 && from < to && to.is_finite() && (2..=MOST).contains(&count) {
            return Ok(());
        }
        let found = format!("found from {from} to {to}, {count} of them");
        Err(format!("{found}; accepted: 0 < from < to, 2 to {MOST} of them"))
    }

    /// Step `i` in twelve digits, so that decades are whole; the ends are exact.
    fn at(self, i: usize) -> f64 {
        let Spaced { from, to, count } = self;
        let share = i as f64 / (count - 1) as f64;
        let value = from * (to / from).powf(share);
        match i {
            0 => from,
            i if i + 1 == count => to,
            _ => format!("{value:.11e}").parse().unwrap_or(value),
        }
    }
}

impl Durations {
    pub(in crate::config) fn seconds(&self) -> Result<Vec<f64>, Wrong> {
        let key = "durations_s";
        match *self {
            Durations::Listed(ref list) => rising(list).map_err(|problem| (key, problem)),
            Durations::Spaced(spaced) => {
                spaced.check().map_err(|problem| (key, problem))?;
                Ok((0..spaced.count).map(|i| spaced.at(i)).collect())
            }
        }
    }
}

fn rising(list: &[f64]) -> Result<Vec<f64>, String> {
    let accepted = "accepted: rising seconds, 0 or more";
    match list {
        [] => Err(format!("is an empty list; {accepted}")),
        _ if list.len() > MOST => {
            Err(format!("has {} durations; at most {MOST} are accepted", list.len()))
        }
        _ => match list.iter().find(|d| !(d.is_finite() && **d >= 0.0)) {
            Some(wrong) => Err(format!("found {wrong}; {accepted}")),
            None => match list.windows(2).find(|w| w[0] >= w[1]) {
                Some(pair) => Err(format!("found {} before {}; {accepted}", pair[0], pair[1])),
                None => Ok(list.to_vec()),
            },
        },
    }
}
