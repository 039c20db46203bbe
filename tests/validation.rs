//! `validate` judges what it is given: it passes what is shipped and fails what is one per cent
//! off.

use std::path::Path;
use std::process::{Command, Output};

use sungaze::units::Trolands;
use sungaze::validate::{Check, Subject, TOPICS, Verdict};

/// Every check but those on pictures, which take longest.
fn checks(subject: &Subject) -> Vec<Check> {
    let topics = TOPICS.iter().filter(|topic| !topic.title.contains("pictures"));
    topics
        .flat_map(|topic| (topic.checks)(subject).expect("a configuration that can be read"))
        .collect()
}

fn failures(subject: &Subject) -> Vec<String> {
    checks(subject)
        .into_iter()
        .filter(|check| check.verdict == Verdict::Fail)
        .map(|check| check.name)
        .collect()
}

#[test]
fn what_is_shipped_passes() {
    assert_eq!(failures(&Subject::new(&[])), Vec::<String>::new());
}

#[test]
fn a_constant_that_is_one_per_cent_off_fails() {
    let log = 1.01f64.log10();
    let changes = [
        format!("observer.tau_s = [{0}, {0}, {0}]", 121.2),
        format!("observer.half_bleach_log_td = [{0}, {0}, {1}]", 4.3 + log, 5.0 + log),
        format!("observer.half_bleach_log_td = [{0}, {0}, {0}]", 3.89 + log),
        "observer.optical_density = [0.3838, 0.3838, 0.303]".into(),
        "observer.km = 0.202".into(),
        "observer.mm_per_degree = 0.2929".into(),
        "observer.age = 32.32".into(),
        "observer.stiles_crawford_p = 0.0505".into(),
    ];
    for change in changes {
        assert!(
            !failures(&Subject::new(std::slice::from_ref(&change))).is_empty(),
            "{change} goes unnoticed"
        );
    }
    let mut subject = Subject::new(&[]);
    subject.rods.half_bleach = Trolands(1.01 * subject.rods.half_bleach.0);
    assert!(!failures(&subject).is_empty(), "rods go unnoticed");
}

#[test]
fn known_disagreements_are_stated_and_not_judged() {
    let stated =
        checks(&Subject::new(&[])).into_iter().filter(|check| check.verdict == Verdict::Info);
    let (mut count, mut differ) = (0, true);
    for check in stated {
        count += 1;
        differ &= check.measured != check.expected && check.share().is_none();
    }
    assert!(count >= 4 && differ);
}

fn program(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.current_dir(folder).args(arguments).output().expect("the program starts")
}

#[test]
fn the_program_writes_its_table_and_says_by_its_exit_code_whether_all_is_well() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = program(folder.path(), &["validate", "--quiet", "--json", "--out", "good"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = rows.as_array().expect("rows");
    assert!(rows.iter().all(|row| row["pass"] == true || row["pass"] == "info"));
    let csv = std::fs::read_to_string(folder.path().join("good/validate.csv")).expect("a table");
    assert_eq!(csv.lines().next(), Some("check,source,measured,expected,tolerance,pass"));
    assert_eq!(csv.lines().count(), rows.len() + 1);
    assert!(folder.path().join("good/validate.svg").exists());

    let wrong = "observer.tau_s=[121.2, 121.2, 121.2]";
    let output = program(folder.path(), &["validate", "--quiet", "--out", "bad", "--set", wrong]);
    assert_eq!(output.status.code(), Some(1));
    let csv = std::fs::read_to_string(folder.path().join("bad/validate.csv")).expect("a table");
    assert!(csv.lines().any(|line| line.ends_with(",false")));
}
