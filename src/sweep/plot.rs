//! `sweep.svg`: how the cases of a sweep fare with time, as families of curves ([`family`]).

use std::path::Path;

use crate::config::{Case, Sweep};
use crate::error::Result;
use crate::frames::atomic;
use crate::plot::Ink;
use crate::plot::axes::written;
use crate::plot::family::{self, Family, Member, Scale};
use crate::plot::moment::{Cones, Moment};
use crate::plot::palette::{APART, ordered};
use crate::sweep::folder::Left;

/// Cases beyond these are in the table only.
pub(super) const MOST_CASES: usize = 400;

/// Draws the plot of a sweep.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write(path: &Path, sweep: &Sweep, left: &[Left]) -> Result<()> {
    let shown = &sweep.cases[..left.len().min(sweep.cases.len()).min(MOST_CASES)];
    let values: Vec<Vec<String>> = shown.iter().map(|case| case.values.clone()).collect();
    let (looks, scale) = looks(&sweep.keys, &values);
    let mut families: Vec<Family> = Vec::new();
    for ((case, left), look) in shown.iter().zip(left).zip(looks) {
        for (probe, (name, member)) in members(case, left, look).into_iter().enumerate() {
            if families.len() <= probe {
                families.push(Family { name, members: Vec::new() });
            }
            families[probe].members.push(member);
        }
    }
    if shown.len() < sweep.cases.len() {
        let words = format!(" (the first {} of {} cases)", shown.len(), sweep.cases.len());
        families.iter_mut().for_each(|family| family.name += &words);
    }
    atomic::write_text(path, &family::drawn(&families, &scale).svg())
}

/// A case as a member of the family of each probe, with the probe's name.
fn members(case: &Case, left: &Left, (ink, dash): (Ink, usize)) -> Vec<(String, Member)> {
    let config = &case.config;
    let cones = Cones { kinetics: config.pigments(), lms_to_xyz: config.observer().lms_to_xyz };
    let steady = |probe: usize| {
        left.steady.get(probe).map(|steady| {
            let ([l, m, s], [x, y]) = (steady.bleached, steady.chromaticity);
            [l, m, s, x, y]
        })
    };
    let member = |(probe, (probes_name, rows)): (usize, (String, Vec<Moment>))| {
        let name = plain(&case.values);
        (probes_name, Member { name, ink, dash, rows, cones, steady: steady(probe) })
    };
    rows(&left.rows).into_iter().enumerate().map(member).collect()
}

/// Longer numbers are rounded where they name a case.
const MOST_DIGITS: usize = 8;

/// Values as a person writes them, without the quotes of TOML.
pub(super) fn plain(values: &[String]) -> String {
    let bare = |value: &String| match value.parse() {
        Ok(number) if value.ends_with("0000.0") || value.len() > MOST_DIGITS => written(number),
        _ => value.trim_matches('"').trim_end_matches(".0").to_owned(),
    };
    values.iter().map(bare).collect::<Vec<_>>().join(", ")
}

/// The last words of keys.
pub(super) fn short(keys: &[String]) -> String {
    let last = |key: &String| key.rsplit('.').next().unwrap_or(key).to_owned();
    keys.iter().map(last).collect::<Vec<_>>().join(", ")
}

/// The rows of each probe of a case's table, in the order of its probes. Columns are found by name,
/// counted from the right, because values to the left may hold commas.
fn rows(table: &str) -> Vec<(String, Vec<Moment>)> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap_or("").rsplit(',').collect();
    let column = |name: &str| names.iter().position(|other| *other == name);
    let mut probes: Vec<(String, Vec<Moment>)> = Vec::new();
    for line in lines {
        let fields: Vec<&str> = line.rsplit(',').collect();
        let field = |name: &str| fields.get(column(name)?).copied();
        let number = |name: &str| field(name).and_then(|field| field.parse().ok());
        let three = |names: [&str; 3]| names.map(|name| number(name).unwrap_or(f64::NAN));
        let Some(time) = line.split(',').nth(1).and_then(|field| field.parse().ok()) else {
            continue;
        };
        let name = field("probe").unwrap_or("").to_owned();
        let [light, p] = [three(["I_L", "I_M", "I_S"]), three(["p_L", "p_M", "p_S"])];
        let moment = Moment { time, light, p, xyz: three(["X", "Y", "Z"]) };
        match probes.iter_mut().find(|(other, _)| *other == name) {
            Some((_, rows)) => rows.push(moment),
            None => probes.push((name, vec![moment])),
        }
    }
    probes
}

/// Colour and dashes of each case, and what they mean. Colours go with the first key whose values
/// are numbers, dashes with the others; without one, colours go with the case.
fn looks(keys: &[String], values: &[Vec<String>]) -> (Vec<(Ink, usize)>, Scale) {
    let named = values.len() <= family::MOST_NAMED;
    let numbers = |key: usize| -> Option<Vec<f64>> {
        let all: Option<Vec<f64>> = values.iter().map(|v| v.get(key)?.parse().ok()).collect();
        all.filter(|all| all.iter().any(|v| *v != all[0]))
    };
    let Some((key, along)) = (0..keys.len()).find_map(|key| Some((key, numbers(key)?))) else {
        let (places, labels) = spaced(&(0..values.len()).map(|i| i as f64).collect::<Vec<_>>());
        let few = values.len() <= APART.len();
        let ink = |(i, place): (usize, f64)| (if few { APART[i] } else { ordered(place) }, 0);
        let name = if named { short(keys) } else { "case".to_owned() };
        let looks = places.into_iter().enumerate().map(ink).collect();
        return (looks, Scale { name, labels, dashes: Vec::new() });
    };
    let (dash, dashes) = numbered(values.iter().map(|values| {
        let others = values.iter().enumerate().filter(|(i, _)| *i != key);
        plain(&others.map(|(_, value)| value.clone()).collect::<Vec<_>>())
    }));
    let (places, labels) = spaced(&along);
    let name = short(if named { keys } else { &keys[key..=key] });
    let looks = places.into_iter().map(ordered).zip(dash).collect();
    (looks, Scale { name, labels, dashes })
}

/// The number of each of many words in the order of their first appearance, and that order.
fn numbered(words: impl Iterator<Item = String>) -> (Vec<usize>, Vec<String>) {
    let mut order: Vec<String> = Vec::new();
    let number = |word: String| {
        order.iter().position(|seen| *seen == word).unwrap_or_else(|| {
            order.push(word);
            order.len() - 1
        })
    };
    (words.map(number).collect(), order)
}

/// Places from 0 to 1 for values, by their logarithm where they span more than a factor of twenty,
/// and labels for values that are not too near to each other.
fn spaced(values: &[f64]) -> (Vec<f64>, Vec<(f64, String)>) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let (Some(&least), Some(&most)) = (sorted.first(), sorted.last()) else {
        return (Vec::new(), Vec::new());
    };
    let logarithmic = least > 0.0 && most > 20.0 * least;
    let on_axis = |v: f64| if logarithmic { v.log10() } else { v };
    let span = (on_axis(most) - on_axis(least)).max(f64::MIN_POSITIVE);
    let place = |v: f64| (on_axis(v) - on_axis(least)) / span;
    let mut labels: Vec<(f64, String)> = vec![(1.0, written(most))];
    for &value in &sorted {
        let near = |label: &(f64, String)| (label.0 - place(value)).abs() < 0.08;
        if !labels.iter().any(near) {
            labels.push((place(value), written(value)));
        }
    }
    (values.iter().map(|v| place(*v)).collect(), labels)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "case,duration_s,\"observer.tau_s\",probe,I_L,I_M,I_S,p_L,p_M,p_S,X,Y,Z,x,y,pupil_mm\n\
        2,0.3,\"[4.3, 4.3, 5.0]\",sun,1,2,3,.5,.6,.7,8,9,10,.1,.2,3\n\
        2,0.3,\"[4.3, 4.3, 5.0]\",sky,1,2,3,.5,.6,.7,8,9,10,.1,.2,3\n\
        2,1,\"[4.3, 4.3, 5.0]\",sun,1,2,3,.1,.2,.3,8,9,10,.1,.2,3\n";

    #[test]
    fn rows_are_read_by_the_names_of_their_columns_whatever_values_and_columns_beside_them() {
        let probes = rows(TABLE);
        assert_eq!(
            probes.iter().map(|(name, rows)| (name.as_str(), rows.len())).collect::<Vec<_>>(),
            [("sun", 2), ("sky", 1)]
        );
        let last = probes[0].1[1];
        assert_eq!(
            last,
            Moment { time: 1.0, light: [1.0, 2.0, 3.0], p: [0.1, 0.2, 0.3], xyz: [8.0, 9.0, 10.0] }
        );
    }

    fn text(values: &[&[&str]]) -> Vec<Vec<String>> {
        values.iter().map(|case| case.iter().map(|v| (*v).to_owned()).collect()).collect()
    }

    #[test]
    fn colours_go_with_numbers_by_decades_and_dashes_with_words() {
        let keys = ["observer.constants".to_owned(), "input.white_cd_m2".to_owned()];
        let values =
            text(&[&["\"a\"", "10.0"], &["\"a\"", "100.0"], &["\"a\"", "1e3"], &["\"b\"", "10.0"]]);
        let (looks, scale) = looks(&keys, &values);
        let [dark, middle, bright] = [0.0, 0.5, 1.0].map(ordered);
        assert_eq!(looks, [(dark, 0), (middle, 0), (bright, 0), (dark, 1)]);
        assert_eq!(
            (scale.name.as_str(), &scale.dashes[..]),
            ("constants, white_cd_m2", &["a".to_owned(), "b".to_owned()][..])
        );
    }

    #[test]
    fn a_few_words_take_colours_that_stay_apart_and_many_take_them_in_order() {
        let key = ["observer.pupil".to_owned()];
        let words =
            |count: usize| (0..count).map(|i| vec![format!("\"w{i}\"")]).collect::<Vec<_>>();
        let (few, scale) = looks(&key, &words(3));
        assert_eq!(few, [(APART[0], 0), (APART[1], 0), (APART[2], 0)]);
        assert_eq!(scale.name, "pupil");
        let (many, scale) = looks(&key, &words(30));
        assert_eq!(
            (many[0].0, many[29].0, scale.name.as_str()),
            (ordered(0.0), ordered(1.0), "case")
        );
    }

    #[test]
    fn labels_are_short_and_apart() {
        let many: Vec<f64> = (0..400).map(|i| 1e2 * 1e6f64.powf(f64::from(i) / 399.0)).collect();
        let (places, labels) = spaced(&many);
        assert_eq!((places[0], places[399], labels[0].1.as_str()), (0.0, 1.0, "10⁸"));
        assert!(
            labels.len() <= 13 && labels.iter().all(|(_, label)| label.chars().count() <= 8),
            "{labels:?}"
        );
    }
}
