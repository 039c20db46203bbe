//! Frames wider than `input.width` are reduced to it, light for light.

use std::path::Path;

use serde_json::Value;
use sungaze::config::Config;
use sungaze::run::{self, Unwatched};

/// The report of a short run of Mitsuba's render with these settings on top.
fn report(folder: &Path, sets: &[&str]) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/sunset_mitsuba.toml");
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let config = Config::load(Some(&path), &sets).unwrap();
    run::run(&config, folder, Default::default(), &Unwatched).unwrap().report
}

#[test]
fn reduced_bands_are_checked_at_full_model_as_whole_ones_are() {
    let folder = tempfile::tempdir().unwrap();
    let report = report(
        folder.path(),
        &["input.width=50", "numerics.model=tracked", "time.times_s=[0, 0.5, 2, 10]"],
    );
    let check = &report["check"];
    assert!(check["samples"].as_u64().unwrap() > 200, "{check}");
    for error in ["max_error_p", "max_error_catch"] {
        assert!(check[error].as_f64().unwrap() < 1e-3, "{check}");
    }
    assert_eq!(report["frames"]["width"], 50);
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("reduced from"), "{warnings}");
}
