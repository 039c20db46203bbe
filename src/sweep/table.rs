//! Rows of `sweep.csv`: the case, the duration, the varied values, the columns of `probes.csv`, then
//! what the light would come to if it lasted, and how long a recovery in the dark would take.

use crate::config::Case;
use crate::run::record::{PROBES, Reading};

/// Unbleached, above which a cone counts as recovered; in the order of the columns.
const RECOVERED: [f64; 3] = [0.95, 0.5, 0.9];

/// Seconds in the dark until L, M and S are all back.
const RECOVERY: &str = "recovery_95_s,recovery_50_s,recovery_90_s";

/// The header, with its line's end.
pub(super) fn header(keys: &[String]) -> String {
    let columns = PROBES.trim_start_matches("frame,time_s,").trim_end();
    let keys: String = keys.iter().map(|key| format!("{},", field(key))).collect();
    format!("case,duration_s,{keys}{columns},steady_p_L,steady_p_M,steady_p_S,{RECOVERY}\n")
}

/// The rows of a case's cell. `steady`: what each probe would read if the light lasted.
pub(super) fn rows(case: &Case, duration: f64, readings: &[Reading], steady: &[Reading]) -> String {
    let pigments = case.config.pigments();
    let values: String = case.values.iter().map(|value| format!("{},", field(value))).collect();
    let case = case.number;
    let row = |(reading, steady): (&Reading, &Reading)| {
        let [l, m, s] = steady.p;
        let [most, half, nine] = RECOVERED.map(|target| reading.recovery(&pigments, target));
        let columns = reading.columns();
        format!("{case},{duration},{values}{columns},{l},{m},{s},{most},{half},{nine}\n")
    };
    readings.iter().zip(steady).map(row).collect()
}

/// A value as CSV writes it (RFC 4180).
fn field(value: &str) -> String {
    if value.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", value.replace('"', "\"\""))
    } else {
        value.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::units::Millimetres;
    use std::path::Path;

    #[test]
    fn a_list_of_three_is_one_value_of_a_row() {
        let reading = Reading {
            probe: "sun".into(),
            illuminance: [1.0; 3],
            p: [0.5; 3],
            xyz: [1.0, 1.0, 2.0],
            pupil: Millimetres(3.0),
            lost: [0.25; 3],
        };
        let steady = Reading { p: [0.125; 3], ..reading.clone() };
        let toml = "[sweep]\ndurations_s = [0.3]\n[[sweep.vary]]\n\
                    key = [\"observer.half_bleach_log_td\", \"numerics.method\"]\n\
                    values = [[[4.3, 4.3, 5.0], \"exact\"]]";
        let config = Config::parse(toml, "test", "test", Path::new(""), &[]).unwrap();
        let mut case = config.sweep().unwrap().cases.remove(0);
        case.number = 2;
        let row = rows(&case, 0.3, &[reading], &[steady]);
        let expected = "2,0.3,\"[4.3, 4.3, 5.0]\",exact,sun,1,1,1,0.5,0.5,0.5,1,1,2,0.25,0.25,3,\
                        0.25,0.25,0.25,0.125,0.125,0.125,276.3";
        assert!(row.starts_with(expected), "{row}");
        let names = header(&["a".into(), "b".into()]);
        let columns = "case,duration_s,a,b,probe,I_L,I_M,I_S,p_L,p_M,p_S,X,Y,Z,x,y,pupil_mm,\
                       lost_L,lost_M,lost_S,steady_p_L,steady_p_M,steady_p_S,recovery_95_s,\
                       recovery_50_s,recovery_90_s\n";
        assert_eq!(names, columns);
        assert_eq!(names.split(',').count(), row.replace(", ", "; ").split(',').count());
    }
}
