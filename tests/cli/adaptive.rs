//! Adaptive filters through the verbs.

use serde_json::Value;

use crate::command::Folder;

const EXAMPLE: &str = include_str!("../../examples/rocket_sage_husa.toml");

/// A folder with the example for another kind of filter.
fn folder(filter: &str) -> Folder {
    let folder = Folder::new();
    let (before, rest) = EXAMPLE.split_once("[filter]").unwrap();
    let after = &rest[rest.find("[tune]").unwrap()..];
    folder.write("problem.toml", format!("{before}[filter]\n{filter}\n\n{after}"));
    folder
}

const KINDS: [(&str, &str, &str); 3] = [
    ("sage-husa", "kind = \"sage-husa\"\nforgetting = \"b\"", "Q.d.v"),
    ("sage-husa-r", "kind = \"sage-husa-r\"\nforgetting = \"b\"\nfloor = 0.05", "R.range"),
    ("fuzzy", "kind = \"fuzzy\"\nwindow = 5\ngain = \"1 - b\"\nwidth = \"5*(1 - b)\"", "square5.range"),
];

#[test]
fn every_kind_is_tuned_and_beats_its_start() {
    for (kind, filter, _) in KINDS {
        let arguments = ["tune", "problem.toml", "--json", "--quiet", "--generations", "8", "--out", "out"];
        let folder = folder(filter);
        let json: Value = folder.run(&arguments).expect(0).json();
        let (tuned, start) = (&json["objectives"]["nll"], &json["baseline"]["objectives"]["nll"]);
        assert!(tuned.as_f64() < start.as_f64(), "{kind}: {json}");
        assert_eq!(json["certificate"]["order_held"], true, "{kind}");
        assert!(json["parameters"]["b"].is_number(), "{kind}: the forgetting is searched");
        let note = format!(
            "{} is where each trajectory starts; the filter adapts it",
            if kind == "sage-husa" { "Q" } else { "R" }
        );
        assert_eq!(json["matrices"]["note"].as_str(), Some(note.as_str()), "{kind}");
        assert!(folder.read("out/report.md").contains(&format!("Note: {note}.")), "{kind}");
        // What was tuned runs as a problem file.
        let again = folder.run(&["tune", "out/tuned.toml", "--json", "--quiet", "--generations", "0"]).expect(0).json();
        let same = again["baseline"]["objectives"]["nll"].as_f64().unwrap();
        assert!((same - tuned.as_f64().unwrap()).abs() < 1e-6 * same.abs(), "{kind}: {same} {tuned}");
    }
}

#[test]
fn every_kind_is_filtered_simulated_and_printed() {
    for (kind, filter, carried) in KINDS {
        let folder = folder(filter);
        let rows = folder.run(&["filter", "problem.toml", "--quiet"]).expect(0).stdout;
        assert_eq!(rows.lines().count(), 202, "{kind}: a header and 201 rows");
        let smoothed = folder.run(&["filter", "problem.toml", "--quiet", "--smooth"]).expect(0).table();
        assert!(smoothed[0].last().is_some_and(|name| name.ends_with("_smoothed")), "{kind}: {:?}", smoothed[0]);
        assert!(smoothed.len() == 202 && smoothed[1..].iter().flatten().all(|cell| cell != "NaN"), "{kind}");
        let tape = folder.run(&["tape", "problem.toml"]).expect(0).stdout;
        assert!(tape.contains(carried), "{kind}: {carried} is carried:\n{tape}");
        let drawn = folder.run(&["simulate", "problem.toml"]).expect(0).stdout;
        assert_eq!(drawn.lines().count(), 202, "{kind}: the truth is the model's");
    }
}

/// In f32 the adapted Q is carried by its factors.
#[cfg(feature = "gpu")]
#[test]
fn every_kind_has_a_kernel() {
    for (kind, filter, carried) in KINDS {
        let carried = carried.replace("Q.d.v", "Q.U.d.v");
        let kernel = folder(filter).run(&["shader", "problem.toml"]).expect(0).stdout;
        assert!(kernel.contains(&format!(": Real; // {carried}\n")), "{kind}: {carried} is carried:\n{kernel}");
    }
}

#[test]
fn a_filter_that_does_not_exist_is_an_error() {
    let finished = folder("kind = \"fuzy\"").run(&["filter", "problem.toml"]).expect(2);
    assert!(finished.stderr.contains("did you mean `fuzzy`?"), "{}", finished.stderr);
}
