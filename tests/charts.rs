//! What the charts claim, read from the tables that they write.

use std::path::Path;
use sungaze::chart::CHARTS;

/// Make one chart and return the rows of its table, without the header.
fn rows(name: &str) -> Vec<Vec<String>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let chart = CHARTS.iter().find(|chart| chart.name == name).expect("a chart of that name");
    let mut lines = 0;
    (chart.write)(folder.path(), &mut |_| lines += 1).expect("the chart is written");
    assert!(lines > 0, "progress is told");
    let stem = name.replace('-', "_");
    for picture in ["svg", "png"] {
        let bytes =
            std::fs::read(folder.path().join(&stem).with_extension(picture)).expect("a picture");
        assert!(bytes.len() > 10_000, "{picture} of {} bytes", bytes.len());
    }
    read(&folder.path().join(stem).with_extension("csv"))
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
    let rows = rows("stability");
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
fn the_work_precision_chart_shows_what_it_says() {
    let rows = rows("work-precision");
    let of = |scene: &str, method: &str| -> Vec<&Vec<String>> {
        rows.iter()
            .filter(|row| row[0] == scene && row[1] == "first-order" && row[2] == method)
            .collect()
    };
    for scene in
        ["indoor", "street", "headlamp", "sun-glance", "time-lapse", "flicker", "dark-recovery"]
    {
        let exact = of(scene, "exact");
        assert!(exact.len() == 1 && number(&exact[0][4]) <= 1e-14, "{exact:?}");
        assert_eq!(exact[0][7], "");
    }
    assert!(of("sun-glance", "forward-euler").iter().all(|row| row[7] == "blow-up"));
    assert!(
        of("indoor", "forward-euler").iter().all(|row| row[7].is_empty() && number(&row[4]) < 1e-6)
    );
    let bound = 0.197 / 24.0 / 120.0;
    let ramp = number(&of("ramp", "exact")[0][4]);
    assert!(ramp <= bound && ramp > 0.99 * bound, "{ramp:e} against {bound:e}");
}

#[test]
fn the_pigment_chart_ends_at_the_steady_state() {
    let rows = rows("pigment");
    for receptor in ["LM", "S", "rod"] {
        let last = rows.iter().rfind(|row| row[0] == receptor && number(&row[1]) == 1e6);
        let last = last.expect("an onset under a million trolands");
        assert!((number(&last[3]) - number(&last[4])).abs() < 1e-6, "{last:?}");
    }
}
