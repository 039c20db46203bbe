//! `[sweep]`: exposure durations, and lists of values for any keys. The cases are the product of
//! the lists, numbered from 0, the last list running fastest.

use std::collections::HashSet;

use toml::Value;

use super::Config;
use super::settings::{MOST, Values, Vary, Wrong};
use crate::error::{Error, Result};

/// A value as it stands in a table: TOML, a word without its quotes.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// A sweep whose every case has been checked.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Rising, s.
    pub(crate) durations: Vec<f64>,
    pub(crate) pictures: bool,
    /// The varied keys.
    pub keys: Vec<String>,
    pub cases: Vec<Case>,
}

/// One combination of values.
#[derive(Clone, Debug)]
pub struct Case {
    pub number: usize,
    /// The value of each varied key, as it stands in a table.
    pub values: Vec<String>,
    pub(crate) config: Config,
    /// Which value of each list it is.
    chosen: Vec<usize>,
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
        let count = keys.vary.iter().map(Vary::len).fold(1, usize::saturating_mul);
        if count > MOST {
            return Err(wrong((
                "vary",
                format!("makes {count} cases; at most {MOST} are accepted"),
            )));
        }
        let cases =
            (0..count).map(|number| self.case(&keys.vary, number)).collect::<Result<_>>()?;
        let names = keys.vary.iter().flat_map(|vary| vary.key.names().to_vec()).collect();
        Ok(Sweep { durations, pictures: keys.pictures, keys: names, cases })
    }

    fn check_lists(&self, lists: &[Vary]) -> Result<()> {
        for (i, vary) in lists.iter().enumerate() {
            let names = vary.key.names();
            let label = names.join(", ");
            let wrong = |part: &str, problem: &str| {
                Err(self.wrong_at(&format!("sweep.vary.{i}.{part}"), &label, problem))
            };
            if names.is_empty() || vary.len() == 0 {
                let part = if names.is_empty() { "key" } else { "values" };
                return wrong(part, "has an empty list of values; give at least one");
            }
            if let Values::Spaced(spaced) = &vary.values
                && let Err(problem) = spaced.check()
            {
                return wrong("values", &problem);
            }
            if (0..vary.len().min(MOST)).any(|j| vary.at(j).len() != names.len()) {
                return wrong("values", "need one value for each of the keys that move together");
            }
            if names.iter().any(|name| name.split('.').next() == Some("sweep")) {
                return wrong("key", "cannot be varied: a sweep has one [sweep]");
            }
            let before = lists[..i].iter().flat_map(|other| other.key.names());
            let mut seen: HashSet<&String> = before.collect();
            if !names.iter().all(|name| seen.insert(name)) {
                return wrong("key", "is varied twice; one list a key");
            }
        }
        Ok(())
    }

    fn case(&self, lists: &[Vary], number: usize) -> Result<Case> {
        let mut rest = number;
        let mut chosen: Vec<usize> =
            lists.iter().rev().map(|vary| take(&mut rest, vary.len())).collect();
        chosen.reverse();
        let changes: Vec<(String, Value)> =
            lists.iter().zip(&chosen).flat_map(|(vary, &j)| vary.at(j)).collect();
        let values = changes.iter().map(|(_, value)| plain(value)).collect();
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
    pub(crate) fn located(&self, error: Error) -> Error {
        let Error::Config { key, problem, .. } = &error else { return error };
        let lists = self.config.settings.sweep.as_ref().map_or(&[][..], |sweep| &sweep.vary);
        let Some(i) = lists.iter().position(|vary| vary.key.names().contains(key)) else {
            return error;
        };
        let path = match lists[i].values {
            _ if problem.starts_with("unknown field") => format!("sweep.vary.{i}.key"),
            Values::Spaced(_) => format!("sweep.vary.{i}.values"),
            Values::Listed(_) => format!("sweep.vary.{i}.values.{}", self.chosen[i]),
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
    fn keys_may_move_together_and_values_may_be_spaced() {
        let text = "[sweep]\ndurations_s = [1]\n[[sweep.vary]]\n\
                    key = [\"observer.age\", \"numerics.method\"]\n\
                    values = [[20, \"exact\"], [70, \"rk4\"]]\n[[sweep.vary]]\n\
                    key = \"observer.km\"\nvalues = { from = 0.1, to = 10, count = 3 }\n";
        let sweep = sweep(text).unwrap();
        assert_eq!(sweep.keys, ["observer.age", "numerics.method", "observer.km"]);
        let values: Vec<_> = sweep.cases.iter().map(|case| case.values.join(" ")).collect();
        assert_eq!(values[..3], ["20 exact 0.1", "20 exact 1.0", "20 exact 10.0"]);
        assert_eq!(values[3..], ["70 rk4 0.1", "70 rk4 1.0", "70 rk4 10.0"]);
        assert_eq!(sweep.cases[5].config.settings.observer.km, 10.0);
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
            (vary("\"observer.km\"", "{ from = 0, to = 1, count = 3 }"), ":8", "from 0 to 1"),
            (vary("\"observer.km\"", "{ from = 1, to = 1e9, count = 3 }"), ":8", "observer.km"),
            (vary("[\"observer.km\", \"observer.eyes\"]", "[[1, 2], [1]]"), ":8", "one value"),
            (vary("[\"observer.km\", \"observer.km\"]", "[[1, 2]]"), ":7", "twice"),
        ] {
            let told_us = sweep(&text).unwrap_err().to_string();
            assert!(
                told_us.starts_with(&format!("s.toml{line}: ")) && told_us.contains(told),
                "{text}\n{told_us}"
            );
        }
    }
}
