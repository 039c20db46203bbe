//! `[sweep]`: exposure durations, and lists of values for any keys. The cases are the product of
//! the lists, numbered from 0, the last list running fastest.

use serde::Deserialize;
use toml::Value;

use super::Config;
use crate::error::{Error, Result};

/// `[sweep]` as it is written.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepKeys {
    pub durations_s: Durations,
    /// Whether every cell's percept and display picture are written.
    #[serde(default = "yes")]
    pub pictures: bool,
    #[serde(default)]
    pub vary: Vec<Vary>,
}

fn yes() -> bool {
    true
}

/// A list, or a logarithmic range.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a list of seconds, or { from, to, count } for logarithmic steps")]
pub enum Durations {
    Listed(Vec<f64>),
    Spaced(Spaced),
}

/// `count` durations from `from` to `to`, in even ratios.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spaced {
    pub from: f64,
    pub to: f64,
    pub count: usize,
}

/// `[[sweep.vary]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vary {
    pub key: String,
    pub values: Vec<Value>,
}

/// A sweep whose every case has been checked.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Rising, s.
    pub durations: Vec<f64>,
    pub pictures: bool,
    /// The varied keys.
    pub keys: Vec<String>,
    pub cases: Vec<Case>,
}

/// One combination of values.
#[derive(Clone, Debug)]
pub struct Case {
    pub number: usize,
    /// The value of each varied key, as TOML.
    pub values: Vec<String>,
    pub config: Config,
    /// Which value of each list it is.
    chosen: Vec<usize>,
}

/// More durations, or more cases, are a slip of the keyboard.
const MOST: usize = 10_000;

type Wrong = (&'static str, String);

impl Durations {
    fn seconds(&self) -> Result<Vec<f64>, Wrong> {
        let key = "durations_s";
        match *self {
            Durations::Listed(ref list) => rising(list).map_err(|problem| (key, problem)),
            Durations::Spaced(Spaced { from, to, count }) => {
                if !(from > 0.0 && from < to && to.is_finite() && (2..=MOST).contains(&count)) {
                    let found = format!("found from {from} to {to}, {count} of them");
                    return Err((
                        key,
                        format!("{found}; accepted: 0 < from < to in seconds, 2 to {MOST} of them"),
                    ));
                }
                let at = |i: usize| from * (to / from).powf(i as f64 / (count - 1) as f64);
                Ok((0..count - 1).map(at).chain([to]).collect())
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

impl Config {
    /// The sweep of `[sweep]`, every case's configuration read and checked. No frame is looked for
    /// yet.
    pub fn sweep(&self) -> Result<Sweep> {
        let Some(keys) = &self.settings.sweep else {
            return Err(self.wrong("sweep", "is missing: a sweep needs [sweep] with durations_s"));
        };
        let wrong = |(key, problem): Wrong| self.wrong(&format!("sweep.{key}"), problem);
        let durations = keys.durations_s.seconds().map_err(wrong)?;
        self.check_lists(&keys.vary)?;
        let count = keys.vary.iter().map(|vary| vary.values.len()).fold(1, usize::saturating_mul);
        if count > MOST {
            return Err(wrong((
                "vary",
                format!("makes {count} cases; at most {MOST} are accepted"),
            )));
        }
        let cases =
            (0..count).map(|number| self.case(&keys.vary, number)).collect::<Result<_>>()?;
        let names = keys.vary.iter().map(|vary| vary.key.clone()).collect();
        Ok(Sweep { durations, pictures: keys.pictures, keys: names, cases })
    }

    fn check_lists(&self, lists: &[Vary]) -> Result<()> {
        for (i, vary) in lists.iter().enumerate() {
            let wrong = |part: &str, problem: &str| {
                Err(self.wrong_at(&format!("sweep.vary.{i}.{part}"), &vary.key, problem))
            };
            if vary.values.is_empty() {
                return wrong("values", "has an empty list of values; give at least one");
            }
            if vary.key.split('.').next() == Some("sweep") {
                return wrong("key", "cannot be varied: a sweep has one [sweep]");
            }
            if lists[..i].iter().any(|other| other.key == vary.key) {
                return wrong("key", "is varied twice; one list a key");
            }
        }
        Ok(())
    }

    fn case(&self, lists: &[Vary], number: usize) -> Result<Case> {
        let mut rest = number;
        let mut chosen: Vec<usize> =
            lists.iter().rev().map(|vary| take(&mut rest, vary.values.len())).collect();
        chosen.reverse();
        let picked = || lists.iter().zip(&chosen).map(|(vary, &j)| (&vary.key, &vary.values[j]));
        let changes: Vec<(String, Value)> =
            picked().map(|(key, value)| (key.clone(), value.clone())).collect();
        let values = picked().map(|(_, value)| value.to_string()).collect();
        let mut case = Case { number, values, config: self.clone(), chosen };
        case.config = self.with(&changes).map_err(|error| case.located(error))?;
        Ok(case)
    }
}

/// The last digit of a number written in base `base`, and the number without it.
fn take(number: &mut usize, base: usize) -> usize {
    let digit = *number % base;
    *number /= base;
    digit
}

impl Case {
    /// The same error at the value that brought it about, if one of the varied keys did.
    pub fn located(&self, error: Error) -> Error {
        let Error::Config { key, problem, .. } = &error else { return error };
        let lists = self.config.settings.sweep.as_ref().map_or(&[][..], |sweep| &sweep.vary);
        let Some(i) = lists.iter().position(|vary| vary.key == *key) else { return error };
        let path = if problem.starts_with("unknown field") {
            format!("sweep.vary.{i}.key")
        } else {
            format!("sweep.vary.{i}.values.{}", self.chosen[i])
        };
        self.config.wrong_at(&path, key, problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn sweep(toml: &str) -> Result<Sweep> {
        Config::parse(toml, "s.toml", "s", Path::new(""), &[])?.sweep()
    }

    #[test]
    fn cases_are_the_product_of_the_lists_and_the_last_runs_fastest() {
        let text = "[sweep]\ndurations_s = [0, 1]\n[[sweep.vary]]\nkey = \"observer.age\"\nvalues = [20, 70]\n\
                    [[sweep.vary]]\nkey = \"observer.tau_s\"\nvalues = [[1, 1, 1], [2, 2, 2], [3, 3, 3]]\n";
        let sweep = sweep(text).unwrap();
        assert_eq!(sweep.cases.len(), 6);
        assert_eq!(sweep.cases[4].values, ["70", "[2, 2, 2]"]);
        assert_eq!(sweep.cases[4].config.settings.observer.tau_s, [2.0; 3]);
        assert_eq!(sweep.keys, ["observer.age", "observer.tau_s"]);
    }

    #[test]
    fn logarithmic_durations_have_even_ratios_and_exact_ends() {
        let durations = sweep("[sweep]\ndurations_s = { from = 0.01, to = 1000, count = 6 }")
            .unwrap()
            .durations;
        assert_eq!((durations[0], durations[5]), (0.01, 1000.0));
        assert!(durations.windows(2).all(|w| (w[1] / w[0] - 10.0).abs() < 1e-12));
    }

    #[test]
    fn a_wrong_sweep_is_refused_at_its_line() {
        let vary = |key: &str, values: &str| {
            format!(
                "[sweep]\ndurations_s = [1]\n[[sweep.vary]]\nkey = \"observer.age\"\nvalues = [30]\n[[sweep.vary]]\nkey = {key}\nvalues = {values}\n"
            )
        };
        for (text, line, told) in [
            ("[input]\nwidth = 16\n".into(), "", "[sweep]"),
            ("[sweep]\ndurations_s = []\n".into(), ":2", "empty list"),
            ("[sweep]\ndurations_s = [1, -2]\n".into(), ":2", "-2"),
            (
                "\n[sweep]\npictures = false\ndurations_s = [3, 1]\n".into(),
                ":4",
                "found 3 before 1",
            ),
            ("[sweep]\ndurations_s = [1, nan]\n".into(), ":2", "NaN"),
            (
                "[sweep]\ndurations_s = { from = 0, to = 1, count = 4 }\n".into(),
                ":2",
                "from 0 to 1",
            ),
            ("[sweep]\ndurations_s = \"long\"\n".into(), ":2", "list of seconds"),
            ("[sweep]\ndurations_s = [1]\npicture = true\n".into(), ":3", "picture"),
            (vary("\"observer.agee\"", "[3]"), ":7", "observer.agee"),
            (vary("\"observer.km\"", "[]"), ":8", "empty list"),
            (vary("\"observer.km\"", "[0.2,\n\"much\"]"), ":9", "observer.km"),
            (vary("\"observer.km\"", "[0.2,\n0.3, 1e9]"), ":9", "found 1e9"),
            (vary("\"observer.km\"", "0.2"), ":8", "sweep"),
            (vary("\"observer.age\"", "[3]"), ":7", "twice"),
            (vary("\"sweep.pictures\"", "[true]"), ":7", "one [sweep]"),
        ] {
            let told_us = sweep(&text).unwrap_err().to_string();
            assert!(
                told_us.starts_with(&format!("s.toml{line}: ")) && told_us.contains(told),
                "{text}\n{told_us}"
            );
        }
    }
}
