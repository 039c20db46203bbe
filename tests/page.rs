//! `report.html` as runs and sweeps leave it: what its data say is what their files hold.

use std::path::Path;

use serde_json::Value;
use sungaze::config::Config;
use sungaze::run::{self, Unwatched};
use sungaze::sweep;

/// The data in a page.
fn data(folder: &Path) -> Value {
    let html = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let (_, rest) = html.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn config(toml: &str) -> Config {
    Config::parse(toml, "test", "small", Path::new(""), &[]).unwrap()
}

fn run_into(folder: &Path, toml: &str) {
    run::run(&config(toml), folder, Default::default(), &Unwatched).unwrap();
}

const SMALL: &str = "input = { width = 16 }\ntime = { times_s = [0, 0.5, 1, 8] }\n";

#[test]
fn a_runs_page_has_a_picture_for_every_frame_and_every_row_of_its_probes() {
    let folder = tempfile::tempdir().unwrap();
    run_into(folder.path(), SMALL);
    let (data, report) = (data(folder.path()), folder.path().join("report.json"));
    let case = &data["cases"][0];
    let frames = case["frames"].as_array().unwrap();
    assert_eq!(
        frames.iter().map(|f| f["time_s"].as_f64().unwrap()).collect::<Vec<_>>(),
        [0.5, 1.0, 8.0]
    );
    for picture in frames.iter().map(|f| &f["picture"]).chain([&case["before"]]) {
        assert!(folder.path().join(picture.as_str().unwrap()).is_file(), "{picture}");
    }
    let probes = std::fs::read_to_string(folder.path().join("probes.csv")).unwrap();
    let columns: Vec<_> = probes.lines().next().unwrap().split(',').collect();
    assert_eq!(case["probes"]["columns"], serde_json::json!(columns));
    assert_eq!(case["probes"]["rows"].as_array().unwrap().len(), probes.lines().count() - 1);
    let report: Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert_eq!(data["report"]["plan"], report["plan"]);
    assert_eq!(data["report"]["config"], report["config"]);
}

#[test]
fn a_run_without_pictures_has_a_page_of_curves_and_one_that_wants_none_has_none() {
    let folder = tempfile::tempdir().unwrap();
    run_into(&folder.path().join("curves"), &format!("{SMALL}output = {{ display = \"none\" }}"));
    let case = &data(&folder.path().join("curves"))["cases"][0];
    assert!(case["before"].is_null() && case["frames"][0]["picture"].is_null());
    assert_eq!(case["probes"]["rows"].as_array().unwrap().len(), 3);
    run_into(&folder.path().join("none"), &format!("{SMALL}output = {{ page = false }}"));
    assert!(!folder.path().join("none/report.html").exists());
}

#[test]
fn a_sweeps_page_has_its_cases_by_their_keys() {
    let folder = tempfile::tempdir().unwrap();
    let toml = "input = { width = 16 }\n[sweep]\ndurations_s = [1, 10]\n[[sweep.vary]]\nkey = \"observer.age\"\nvalues = [20, 60]\n";
    let part = sweep::Part::All;
    sweep::sweep(&config(toml), folder.path(), Default::default(), part, &Unwatched).unwrap();
    let data = data(folder.path());
    let cases = data["cases"].as_array().unwrap();
    let names: Vec<_> = cases.iter().map(|case| case["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["observer.age = 20", "observer.age = 60"]);
    let picture = cases[1]["frames"][1]["picture"].as_str().unwrap();
    assert!(picture.starts_with("case.0001/") && folder.path().join(picture).is_file());
}
