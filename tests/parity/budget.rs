//! The recorded findings: worst error of every case and precision, in units of what is promised.

use crate::ONLY;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::Mutex;

/// Set, it writes the file anew from this run.
const RECORD: &str = "KFGPU_PARITY_RECORD";

/// A case may get this much worse than its record before it fails.
const SLACK: f64 = 4.0;

/// Errors below this share of the promise are not compared with their record.
const NEGLIGIBLE: f64 = 0.02;

static FILE: Mutex<()> = Mutex::new(());

type Findings = BTreeMap<(String, String), f64>;

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/parity/budget.csv")
}

fn read() -> Findings {
    let Ok(mut reader) = csv::Reader::from_path(path()) else { return Findings::new() };
    let rows = reader.deserialize::<(String, String, f64)>().map(|row| row.expect("case,precision,error"));
    rows.map(|(case, precision, error)| ((case, precision), error)).collect()
}

fn write(findings: &Findings) {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["case", "precision", "error"]).unwrap();
    for ((case, precision), error) in findings {
        writer.write_record([case, precision, &format!("{error:.2e}")]).unwrap();
    }
    fs::write(path(), writer.into_inner().unwrap()).unwrap();
}

/// Compares the errors of a precision with their record, or records them; sentences about what is wrong.
pub(crate) fn compare(precision: &str, measured: &[(String, f64)]) -> Vec<String> {
    let _guard = FILE.lock().unwrap();
    let mut findings = read();
    if std::env::var_os(RECORD).is_some() {
        // Those of cases that were left out stay.
        let whole = std::env::var_os(ONLY).is_none();
        let renewed = |case: &String| whole || measured.iter().any(|(name, _)| name == case);
        findings.retain(|(case, p), _| p != precision || !renewed(case));
        findings.extend(measured.iter().map(|(case, error)| ((case.clone(), precision.to_owned()), *error)));
        write(&findings);
        return Vec::new();
    }
    let mut wrong = Vec::new();
    for (case, error) in measured {
        match findings.get(&(case.clone(), precision.to_owned())) {
            None => wrong.push(format!("{case}: {precision} has no record (set {RECORD}=1 to write it)")),
            Some(record) if *error > (SLACK * record).max(NEGLIGIBLE) || error.is_nan() => {
                wrong.push(format!("{case}: {precision} error {error:.2e}, recorded {record:.2e}"));
            }
            Some(_) => {}
        }
    }
    wrong
}
