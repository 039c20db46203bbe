//! `report.html` as runs and sweeps leave it: what its data say is what their files hold.

use std::path::{Path, PathBuf};

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

/// The report that the README shows: the page of the default run, and its pictures.
fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/report")
}

/// A page without its data.
fn code(folder: &Path) -> String {
    let html = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let (before, rest) = html.split_once("id=\"data\">").unwrap();
    before.to_owned() + rest.split_once("</script>").unwrap().1
}

/// The keys of an object.
fn keys(value: &Value) -> Vec<&String> {
    value.as_object().unwrap().keys().collect()
}

const STALE: &str =
    "data/report is of another day: `cargo test --release --test page -- --ignored` makes it anew";

#[test]
fn the_example_report_has_the_code_and_the_keys_of_todays_page_and_all_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    run_into(folder.path(), "input = { width = 16 }");
    assert!(code(&example()) == code(folder.path()), "{STALE}");
    let [shown, made] = [example().as_path(), folder.path()].map(data);
    let [case, made_case] = [&shown, &made].map(|data| &data["cases"][0]);
    assert_eq!(keys(&shown["report"]), keys(&made["report"]), "{STALE}");
    assert_eq!(keys(&case["frames"][0]), keys(&made_case["frames"][0]), "{STALE}");
    assert_eq!(case["probes"]["columns"], made_case["probes"]["columns"], "{STALE}");
    let frames = case["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 60);
    for picture in frames.iter().map(|f| &f["picture"]).chain([&case["before"]]) {
        let png = std::fs::read(example().join(picture.as_str().unwrap())).unwrap();
        let (width, height, _) = sungaze::frames::decode_png(&png).unwrap();
        assert_eq!((width, height), (480, 270), "{picture}");
    }
    assert_eq!(std::fs::read_dir(example()).unwrap().count(), 62, "the page and 61 pictures");
}

/// The same picture, packed as closely as PNG can.
fn packed(png: &[u8]) -> Vec<u8> {
    let (width, height, rgb) = sungaze::frames::decode_png(png).unwrap();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header().unwrap().write_image_data(&rgb).unwrap();
    bytes
}

#[test]
#[ignore = "makes data/report anew"]
fn the_example_report_is_made_anew() {
    let run = tempfile::tempdir().unwrap();
    let config = Config::load(None, &[]).unwrap();
    run::run(&config, run.path(), Default::default(), &Unwatched).unwrap();
    std::fs::create_dir_all(example()).unwrap();
    for entry in std::fs::read_dir(run.path()).unwrap() {
        let (path, to) = entry.map(|e| (e.path(), example().join(e.file_name()))).unwrap();
        match path.extension().and_then(|e| e.to_str()) {
            Some("html") => drop(std::fs::copy(path, to).unwrap()),
            Some("png") => std::fs::write(to, packed(&std::fs::read(path).unwrap())).unwrap(),
            _ => {}
        }
    }
}
