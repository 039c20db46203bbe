//! Uniform fields: published experiments as runs, without a file.

use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Output};

use sungaze::kinetics::Kinetics;
use sungaze::units::Trolands;

fn sungaze(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

/// Runs `command` over a configuration into `o`.
fn done(folder: &Path, command: &str, config: &str) {
    let out = sungaze(folder, &[command, config, "--out", "o", "--quiet"]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

fn refused(folder: &Path, config: &str) -> String {
    std::fs::write(folder.join("c.toml"), config).unwrap();
    let out = sungaze(folder, &["run", "c.toml", "--out", "o", "--quiet"]);
    assert_eq!(out.status.code(), Some(2), "{config}");
    assert!(!folder.join("o").exists());
    String::from_utf8(out.stderr).unwrap()
}

/// The rows of a table by the names of its columns; words are NaN.
fn table(path: &Path) -> Vec<HashMap<String, f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let row = |line: &str| {
        let cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
        names.iter().cloned().zip(cells).collect()
    };
    lines.map(row).collect()
}

/// First-order pigment after some seconds of a light.
fn closed_form(pigment: &Kinetics, p: f64, light: f64, seconds: f64) -> f64 {
    let speed = 1.0 + light / pigment.half_bleach.0;
    let steady = 1.0 / speed;
    steady + (p - steady) * (-seconds * speed / pigment.tau.0).exp()
}

fn shipped(name: &str) -> String {
    format!("{}/configs/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn eight_levels_by_forty_durations_are_the_closed_form_from_eleven_lines() {
    let folder = tempfile::tempdir().unwrap();
    let config = r#"[input]
scene = "field"
level = 1e3

[sweep]
durations_s = { from = 0.01, to = 1000, count = 40 }
pictures = false

[[sweep.vary]]
key = "input.level"
values = { from = 316, to = 3.16e9, count = 8 }
"#;
    assert!(config.lines().count() <= 12);
    std::fs::write(folder.path().join("c.toml"), config).unwrap();
    done(folder.path(), "sweep", "c.toml");
    let rows = table(&folder.path().join("o/sweep.csv"));
    assert_eq!(rows.len(), 320);
    let pigments = Kinetics::standard();
    for row in rows {
        for (pigment, cone) in pigments.iter().zip(["L", "M", "S"]) {
            let light = row["input.level"];
            let exact = closed_form(pigment, 1.0, light, row["duration_s"]);
            let p = row[&format!("p_{cone}")];
            assert!((p - exact).abs() <= 1e-14, "{light} td, {} s: {p} {exact}", row["duration_s"]);
        }
    }
}

#[test]
fn the_flash_train_has_its_six_published_numbers() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), "run", &shipped("flash_train.toml"));
    let rows = table(&folder.path().join("o/probes.csv"));
    assert_eq!(rows.len(), 39);
    let report = std::fs::read_to_string(folder.path().join("o/report.json")).unwrap();
    assert!(report.contains("\"16 of 16 tiles\""), "nothing was left out: {report}");
    let published = [
        (1, 0.336527066),
        (2, 0.528324619),
        (3, 0.637636188),
        (5, 0.735443211),
        (10, 0.779667866),
        (13, 0.781973571),
    ];
    for (flash, bleached) in published {
        let row = &rows[3 * (flash - 1) + 1];
        assert!((1.0 - row["p_L"] - bleached).abs() < 1e-9, "flash {flash}: {}", 1.0 - row["p_L"]);
        assert!((row["time_s"] - (18.0 * (flash as f64 - 1.0) + 4.999)).abs() < 1e-9);
    }
}

/// Seconds in the dark from p to a target, by the oracle's classical Runge-Kutta in small steps.
fn recovery_by_small_steps(pigment: &Kinetics, from: f64, target: f64) -> f64 {
    let (h, dark) = (1e-3, Trolands(0.0));
    let (mut p, mut t) = (from, 0.0);
    while p < target {
        let rate = |p: f64| pigment.change(p, dark);
        let k1 = rate(p);
        let k2 = rate(p + 0.5 * h * k1);
        let k3 = rate(p + 0.5 * h * k2);
        let k4 = rate(p + h * k3);
        let next = p + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        if next >= target {
            return t + h * (target - p) / (next - p);
        }
        (p, t) = (next, t + h);
    }
    t
}

#[test]
fn seconds_to_recover_are_the_laws() {
    let folder = tempfile::tempdir().unwrap();
    for law in ["first-order", "rate-limited", "self-screened"] {
        let config = format!(
            "[input]\nscene = \"field\"\nlevel = 1e6\n[observer]\nkinetics = \"{law}\"\n\
             [sweep]\ndurations_s = [1, 30]\npictures = false\n"
        );
        std::fs::write(folder.path().join("c.toml"), config).unwrap();
        let out = sungaze(folder.path(), &["sweep", "c.toml", "--out", law, "--quiet"]);
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let config =
            sungaze::config::Config::load(Some(&folder.path().join("c.toml")), &[]).unwrap();
        let rows = table(&folder.path().join(law).join("sweep.csv"));
        for (row, target) in rows.iter().flat_map(|row| [50, 90, 95].map(|target| (row, target))) {
            let told = row[&format!("recovery_{target}_s")];
            let target = f64::from(target) / 100.0;
            let cones = config.pigments().into_iter().zip(["p_L", "p_M", "p_S"]);
            let closed = |(pigment, p): (Kinetics, &str)| {
                pigment.tau.0 * ((1.0 - row[p]) / (1.0 - target)).ln().max(0.0)
            };
            let by_steps =
                |(pigment, p): (Kinetics, &str)| recovery_by_small_steps(&pigment, row[p], target);
            let (expected, within) = match law {
                "first-order" => (cones.map(closed).fold(0.0, f64::max), 1e-6),
                _ => (cones.map(by_steps).fold(0.0, f64::max), 1e-4),
            };
            let near = (told - expected).abs() <= within * expected;
            assert!(near, "{law}: {told} s, not {expected} s to {target}");
        }
    }
}

#[test]
fn a_history_moves_each_cone_by_its_own_light() {
    let folder = tempfile::tempdir().unwrap();
    let history = "# of three cones\ntime_s,td_L,td_M,td_S\n0,1e6,0,1e5\n2,0,3e5,0\n5,0,0,0\n";
    std::fs::write(folder.path().join("my.csv"), history).unwrap();
    let config = "[input]\nscene = \"field\"\nhistory = \"my.csv\"\n";
    std::fs::write(folder.path().join("c.toml"), config).unwrap();
    done(folder.path(), "run", "c.toml");
    let rows = table(&folder.path().join("o/probes.csv"));
    assert_eq!(rows.iter().map(|row| row["time_s"]).collect::<Vec<_>>(), [2.0, 5.0, 8.0]);
    let lights = [[1e6, 0.0, 1e5], [0.0, 3e5, 0.0], [0.0; 3]];
    let mut p = [1.0; 3];
    for ((row, lights), seconds) in rows.iter().zip(lights).zip([2.0, 3.0, 3.0]) {
        for (k, cone) in ["L", "M", "S"].iter().enumerate() {
            let pigment = Kinetics::standard()[k];
            p[k] = closed_form(&pigment, p[k], lights[k], seconds);
            assert!((row[&format!("I_{cone}")] - lights[k]).abs() <= 1e-14 * lights[k]);
            assert!((row[&format!("p_{cone}")] - p[k]).abs() < 1e-14, "{cone}");
        }
    }
    // A changed history is another run.
    std::fs::write(folder.path().join("my.csv"), history.replace("3e5", "4e5")).unwrap();
    let again = sungaze(folder.path(), &["run", "c.toml", "--out", "o", "--resume", "--quiet"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("my.csv"));
}

#[test]
fn a_field_in_cd_per_m2_is_seen_through_the_pupil_and_any_spectrum() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("yellow.csv"), "nm,value\n585,0\n590,1\n595,0\n").unwrap();
    let mut of = HashMap::new();
    for spectrum in ["equal-energy", "d65", "yellow.csv"] {
        let config = format!(
            "[input]\nscene = \"field\"\nunit = \"cd_m2\"\nlevel = 1000\nspectrum = \"{spectrum}\"\n\
             [observer]\npupil = \"fixed\"\npupil_mm = 2\nstiles_crawford = \"off\"\n\
             [time]\ntimes_s = [0, 1e-6]\n"
        );
        std::fs::write(folder.path().join("c.toml"), config).unwrap();
        let out = sungaze(
            folder.path(),
            &["run", "c.toml", "--out", &format!("of {spectrum}"), "--quiet"],
        );
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let row = table(&folder.path().join(format!("of {spectrum}")).join("probes.csv")).remove(0);
        assert!((row["Y"] / 1000.0 - 1.0).abs() < 1e-5, "{spectrum}: {}", row["Y"]);
        of.insert(spectrum, row);
    }
    let trolands = 1000.0 * std::f64::consts::PI;
    assert!((of["equal-energy"]["I_L"] / trolands - 1.0).abs() < 1e-12);
    let d65 = &of["d65"];
    assert!((d65["x"] - 0.3127).abs() < 0.002 && (d65["y"] - 0.329).abs() < 0.002, "{d65:?}");
    assert!(of["yellow.csv"]["I_S"] < 0.01 * trolands && of["yellow.csv"]["x"] > 0.55);
}

#[test]
fn an_older_lens_keeps_back_light_most_of_it_from_s_cones() {
    let folder = tempfile::tempdir().unwrap();
    let config = "[input]\nscene = \"field\"\nunit = \"cd_m2\"\nlevel = 3e3\n\
                  [observer]\npupil = \"fixed\"\npupil_mm = 3\nstiles_crawford = \"off\"\n\
                  [sweep]\ndurations_s = [100]\npictures = false\n\
                  [[sweep.vary]]\nkey = \"observer.age\"\nvalues = [20, 32, 60, 80]\n";
    std::fs::write(folder.path().join("c.toml"), config).unwrap();
    done(folder.path(), "sweep", "c.toml");
    let rows = table(&folder.path().join("o/sweep.csv"));
    assert_eq!(rows.len(), 4);
    let td = 3e3 * std::f64::consts::PI * 1.5 * 1.5;
    for cone in ["I_L", "I_M", "I_S"] {
        assert!((rows[1][cone] / td - 1.0).abs() < 1e-4, "{:?}", rows[1]);
    }
    for pair in rows.windows(2) {
        let kept = |cone: &str| pair[1][&format!("I_{cone}")] / pair[0][&format!("I_{cone}")];
        assert!(kept("S") < kept("M") && kept("M") < kept("L") && kept("L") < 1.0, "{pair:?}");
        assert!(pair[1]["p_S"] > pair[0]["p_S"] && pair[1]["p_L"] > pair[0]["p_L"]);
    }
}

#[test]
fn a_schedule_is_cut_finer_without_moving_its_pigment() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "[input]\nscene = \"field\"\nschedule = [[2, 1e6], [3, 0]]\nrepeat = 2\n";
    let mut ends = Vec::new();
    for (name, time) in [("whole", ""), ("cut", "[time]\nfps = 4\n")] {
        std::fs::write(folder.path().join("c.toml"), format!("{scene}{time}")).unwrap();
        let out = sungaze(folder.path(), &["run", "c.toml", "--out", name, "--quiet"]);
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        let rows = table(&folder.path().join(name).join("probes.csv"));
        ends.push((rows.len(), rows.last().unwrap()["time_s"], rows.last().unwrap()["p_L"]));
    }
    let [(few, end, p), (many, late, q)] = ends[..] else { unreachable!() };
    assert_eq!((few, many, end, late), (4, 40, 10.0, 10.0));
    assert!((p - q).abs() < 1e-14);
}

#[test]
fn keys_that_have_no_meaning_for_a_field_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (keys, told) in [
        ("", "level, schedule and history"),
        ("level = 1\nschedule = [[1, 1]]", "level, schedule and history"),
        ("level = -1", "input.level"),
        ("schedule = [[0, 1]]", "input.schedule"),
        ("schedule = []", "input.schedule"),
        ("level = 1\nrepeat = 2", "input.repeat"),
        ("level = 1\nturbidity = 2", "input.turbidity"),
        ("level = 1\nunit = \"lux\"", "cd_m2"),
        ("level = 1\nspectrum = \"none.csv\"", "equal-energy, d65"),
        ("history = \"none.csv\"", "none.csv"),
        ("schedule = [[1, 1]]\n[time]\nduration_s = 2", "time.duration_s"),
        ("level = 1\n[observer]\npupil = \"fixed\"\npupil_mm = 3", "observer.pupil"),
        ("level = 1\n[observer]\nage = 70", "observer.age"),
    ] {
        let message = refused(folder.path(), &format!("[input]\nscene = \"field\"\n{keys}\n"));
        assert!(message.contains(told), "{keys}: {message}");
    }
    let message = refused(folder.path(), "[input]\nlevel = 1\n");
    assert!(message.contains("input.scene = \"field\""), "{message}");
}

#[test]
fn tables_begin_with_the_law_where_a_reader_asks_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let config = "[input]\nscene = \"field\"\nlevel = 1e6\n[time]\ntimes_s = [0, 1, 2]\n\
                  [sweep]\ndurations_s = [1]\n[output]\nlaw = true\n";
    std::fs::write(folder.path().join("c.toml"), config).unwrap();
    done(folder.path(), "run", "c.toml");
    let out = sungaze(folder.path(), &["sweep", "c.toml", "--out", "s", "--quiet", "--json"]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert!(!told.to_string().contains('#'), "{told}");
    for name in ["o/trace.csv", "o/probes.csv", "s/sweep.csv"] {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        let first = text.lines().next().unwrap();
        for word in ["# tau dp/dt = 1 - p - (I/I0) p", "td", "tau = [", "Rushton"] {
            assert!(first.contains(word), "{name}: {first}");
        }
    }
    // The report, the page and a later run read past it.
    let report = std::fs::read_to_string(folder.path().join("o/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["results"][0]["probe"], "gaze");
    assert_eq!(report["columns"]["I_L, I_M, I_S"], "cone illuminance, td");
    assert!(report["constants"]["law"].as_str().unwrap().starts_with("tau dp/dt"));
}
