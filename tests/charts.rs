//! What the charts claim, read from the tables that they write, and what their pictures say.

use std::path::Path;
use sungaze::chart::{CHARTS, observer};

/// Makes one chart and returns the rows of its table, without the header. Its SVG says `words`, and
/// its PNG is twice as large as the SVG, on white.
fn rows(name: &str, sets: &[&str], words: &[&str]) -> Vec<Vec<String>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let chart = CHARTS.iter().find(|chart| chart.name == name).expect("a chart of that name");
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let (mut lines, observer) = (0, observer(&sets).expect("an observer"));
    chart.write(folder.path(), &observer, &mut |_| lines += 1).expect("the chart is written");
    assert!(lines > 0, "progress is told");
    let stem = folder.path().join(name.replace('-', "_"));
    let svg = std::fs::read_to_string(stem.with_extension("svg")).expect("an SVG");
    for words in words {
        assert!(svg.contains(&format!(">{words}</text>")), "{name} says {words:?}");
    }
    let file = std::fs::File::open(stem.with_extension("png")).expect("a PNG");
    let mut png = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a header");
    let mut pixels = vec![0; png.output_buffer_size().expect("a size")];
    let info = png.next_frame(&mut pixels).expect("pixels");
    let size = format!("viewBox=\"0 0 {} {}\"", info.width / 2, info.height / 2);
    assert!(svg.contains(&size), "{size}");
    assert_eq!(pixels[..3], [255; 3]);
    read(&stem.with_extension("csv"))
}

fn read(path: &Path) -> Vec<Vec<String>> {
    let table = std::fs::read_to_string(path).expect("a table");
    table.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn number(field: &str) -> f64 {
    field.parse().expect("a number")
}

#[test]
fn every_measured_limit_is_within_one_percent_of_theory_and_every_order_within_a_tenth() {
    let rows = rows("stability", &[], &["forward-euler", "blows up: |R| &gt; 1"]);
    assert_eq!(rows.len(), sungaze::step::METHODS.len());
    for row in rows {
        if row[0] == "exact" {
            assert_eq!(row[1..3], ["exact", "exact"]);
        } else {
            assert!((number(&row[1]) - number(&row[2])).abs() < 0.1, "order of {row:?}");
        }
        for (theory, measured) in [(3, 4), (5, 6)] {
            let (theory, measured) = (number(&row[theory]), number(&row[measured]));
            assert!(
                theory == measured || (measured / theory - 1.0).abs() < 0.01,
                "limit of {row:?}"
            );
        }
    }
}

#[test]
fn the_pigment_chart_ends_at_the_steady_state() {
    let rows = rows("pigment", &[], &["L and M cones", "S cones", "Rods (scotopic td)"]);
    for receptor in ["LM", "S", "rod"] {
        let last = rows.iter().rfind(|row| row[0] == receptor && number(&row[1]) == 1e6);
        let last = last.expect("an onset under a million trolands");
        assert!((number(&last[3]) - number(&last[4])).abs() < 1e-6, "{last:?}");
    }
}

#[test]
fn the_pigment_chart_draws_the_constants_that_it_is_given() {
    let sets = ["observer.half_bleach_log_td=[4.0, 4.2, 5.0]", "observer.tau_s=[90, 100, 110]"];
    let words = ["L cones", "M cones", "first-order, half-bleach log td 4.20, τ 100 s"];
    let rows = rows("pigment", &sets, &words);
    for (receptor, half_bleach, tau) in [("L", 1e4, 90.0), ("M", 10f64.powf(4.2), 100.0)] {
        for row in rows.iter().filter(|row| row[0] == receptor) {
            let (light, time, bleached) = (number(&row[1]), number(&row[2]), number(&row[3]));
            let start = if light == 0.0 { 0.0 } else { 1.0 };
            let rest = 1.0 / (1.0 + light / half_bleach);
            let p = rest + (start - rest) * (-time * (1.0 + light / half_bleach) / tau).exp();
            assert!((bleached - (1.0 - p)).abs() < 1e-5, "{row:?}: {}", 1.0 - p);
        }
    }
}

#[test]
fn the_fundamentals_chart_draws_the_observer_that_it_is_given() {
    let peak = |rows: &[Vec<String>], column: usize| {
        let value = |row: &&Vec<String>| number(&row[column]);
        let top = rows.iter().max_by(|a, b| value(a).total_cmp(&value(b))).expect("rows");
        number(&top[0])
    };
    let standard = rows("fundamentals", &[], &["CIE 2006, 2°, 32 years", "SMJ 1993 (paper)"]);
    assert_eq!(standard.len(), 441);
    let old = rows("fundamentals", &["observer.age=70"], &["CIE 2006, 2°, 70 years"]);
    let wide = rows("fundamentals", &["observer.field_deg=10"], &["CIE 2006, 10°, 32 years"]);
    let paper = rows("fundamentals", &["observer.fundamentals=smj1993"], &["SMJ 1993, 10°"]);
    // CIE 170-1:2006: peaks of the 2-degree and the 10-degree set.
    assert_eq!([1, 2, 3].map(|k| peak(&standard, k)), [570.0, 543.0, 442.0]);
    assert_eq!([1, 2, 3].map(|k| peak(&wide, k)), [569.0, 541.0, 448.0]);
    assert_ne!(paper, wide);
    // At 420 nm an older S cone is less sensitive beside its peak, which moves to longer waves.
    assert!(peak(&old, 3) > peak(&standard, 3));
    assert!(number(&old[30][3]) < 0.9 * number(&standard[30][3]));
    // Half of the pigment: less than half is missing from a catch, as it screened itself.
    for row in &old {
        for k in 1..=3 {
            let (whole, half) = (number(&row[k]), number(&row[k + 3]));
            assert!(half <= 0.75 * whole && half >= 0.499_999 * whole, "{row:?}");
        }
    }
}

#[test]
fn charts_take_the_keys_of_an_observer_and_no_others() {
    let refused = observer(&["numerics.method=rk4".to_owned()]).expect_err("no observer's key");
    assert!(refused.to_string().contains("keys of observer only"), "{refused}");
}

#[test]
fn every_rung_of_the_ladder_keeps_the_bound_that_it_promises() {
    let rows = rows("ladder", &[], &[]);
    let promised: Vec<_> = rows.iter().filter(|row| !row[7].is_empty()).collect();
    assert!(promised.len() > 15, "{} rungs promise a bound", promised.len());
    for row in promised {
        let [p, catch, bound] = [3, 4, 7].map(|column| number(&row[column]));
        assert!(p <= bound && catch <= bound, "{} {}: {p} {catch} of {bound}", row[0], row[1]);
    }
}
