//! Rows of `sweep.csv`: the case, the duration, the varied values as TOML, then the columns of
//! `probes.csv`.

use crate::run::record::{PROBES, Reading};

/// The header, with its line's end.
pub fn header(keys: &[String]) -> String {
    let columns = PROBES.trim_start_matches("frame,time_s,");
    let keys: String = keys.iter().map(|key| format!("{},", field(key))).collect();
    format!("case,duration_s,{keys}{columns}")
}

/// The rows of one cell.
pub fn rows(case: usize, duration: f64, values: &[String], readings: &[Reading]) -> String {
    let values: String = values.iter().map(|value| format!("{},", field(value))).collect();
    readings
        .iter()
        .map(|reading| format!("{case},{duration},{values}{}\n", reading.columns()))
        .collect()
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

    #[test]
    fn a_list_of_three_is_one_value_of_a_row() {
        let reading = Reading {
            probe: "sun".into(),
            illuminance: [1.0; 3],
            p: [0.5; 3],
            xyz: [1.0, 1.0, 2.0],
        };
        let values = ["[4.3, 4.3, 5.0]".to_owned(), "\"exact\"".to_owned()];
        let row = rows(2, 0.3, &values, &[reading]);
        assert!(
            row.starts_with(
                "2,0.3,\"[4.3, 4.3, 5.0]\",\"\"\"exact\"\"\",sun,1,1,1,0.5,0.5,0.5,1,1,2,0.25,0.25"
            ),
            "{row}"
        );
        let names = header(&["a".into(), "b".into()]);
        assert_eq!(names, "case,duration_s,a,b,probe,I_L,I_M,I_S,p_L,p_M,p_S,X,Y,Z,x,y\n");
    }
}
