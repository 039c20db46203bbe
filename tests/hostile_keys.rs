//! Configurations, settings and gaze paths from somebody who means ill, or who slipped: a message,
//! never a panic.

use std::path::Path;

use proptest::prelude::*;

use sungaze::config::Config;
use sungaze::run::GazePath;

const SOUND: &str = r#"
[input]
frames = "sun.####.exr"
range = "1-100x2"
horizontal_fov_deg = 40.0
white_cd_m2 = 5000
channels = "S0_{nm}nm"
[time]
times_s = [0, 0.5, 60]
[gaze]
at = "brightest"
[observer]
preset = "paper"
constants = "hollins-alpern"
optical_density = [0.3, 0.3, 0.3]
[numerics]
method = "exact"
model = "steady"
[display]
smoothing_s = inf
[[output.probe]]
name = "sun"
at = [0.5, 0.5]
"#;

/// Bytes that are likely to matter to a parser.
const TELLING: &[u8] = b"[]{}=\"'.,-+#\n\\eE0_9 infa\0\xff\xc3";

fn mutated(text: &str, edits: &[(usize, usize, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for &(at, kind, byte) in edits {
        let at = at % bytes.len().max(1);
        match kind % 4 {
            0 if !bytes.is_empty() => bytes[at] = TELLING[usize::from(byte) % TELLING.len()],
            1 => bytes.insert(at.min(bytes.len()), TELLING[usize::from(byte) % TELLING.len()]),
            2 if !bytes.is_empty() => drop(bytes.remove(at)),
            _ => bytes.truncate(at.max(1)),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn config(text: &str, sets: &[String]) -> Result<Config, sungaze::error::Error> {
    Config::parse(text, "c.toml", "c", Path::new(""), sets)
}

#[test]
fn the_text_that_is_mutated_below_is_itself_accepted() {
    config(SOUND, &[]).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_mutated_configuration_is_read_or_refused_with_its_place(edits in prop::collection::vec((0usize..1000, 0usize..16, any::<u8>()), 1..6)) {
        match config(&mutated(SOUND, &edits), &[]) {
            // What was accepted must also resolve to an observer, pigments, a display and reading
            // options or say why.
            Ok(config) => {
                let _ = (config.pigments(), config.display(), config.read_options(), config.model(), config.compression());
            }
            Err(error) => {
                prop_assert_eq!(error.exit_code(), 2);
                prop_assert!(error.to_string().starts_with("c.toml"), "{}", error);
            }
        }
    }

    #[test]
    fn any_setting_is_applied_or_refused(set in "[a-z_.]{0,30}=?[ -~]{0,20}") {
        if let Err(error) = config("", &[set]) {
            prop_assert_eq!(error.exit_code(), 2);
        }
    }

    #[test]
    fn any_value_of_any_number_is_in_range_or_refused(key in 0usize..14, value in any::<f64>()) {
        let keys = [
            "observer.age", "observer.km", "observer.mm_per_degree", "gaze.fovea_deg", "gaze.surround_cd_m2", "time.fps",
            "time.duration_s", "input.scale", "input.sun_elevation_deg", "input.turbidity", "numerics.budget",
            "display.white_cd_m2", "display.highlights", "display.smoothing_s",
        ];
        let written = if value.is_nan() { "nan".into() } else { format!("{value:e}") };
        if let Ok(config) = config("", &[format!("{}={written}", keys[key])]) {
            prop_assert!(!value.is_nan());
            let _ = (config.pigments(), config.display());
        }
    }

    #[test]
    fn a_mutated_gaze_path_is_read_or_refused(edits in prop::collection::vec((0usize..100, 0usize..16, any::<u8>()), 0..6)) {
        let text = mutated("time_s,x,y\n0,0.5,0.5\n2,0.25,1\n3e1,0,0.125\n", &edits);
        if let Ok(GazePath { points, .. }) = GazePath::from_rows(&text) {
            prop_assert!(points.windows(2).all(|w| w[0].0 < w[1].0));
            prop_assert!(points.iter().all(|(t, at)| t.is_finite() && at.iter().all(|v| (0.0..=1.0).contains(v))));
        }
    }
}
