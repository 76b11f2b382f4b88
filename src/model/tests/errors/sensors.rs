//! Mistakes in `[[sensor]]` tables.

use super::error;
use crate::model::Problem;

/// Two sensors that share a column, and an input that only one of them reads.
const SOUND: &str = r#"[data]
file = "log.csv"
time = "t"
sensor = "who"
inputs = ["own"]

[[sensor]]
name = "gps"
when = "GPS"
measurements = ["z"]
h = ["p"]
R = ["r"]

[[sensor]]
name = "radar"
when = "R2"
measurements = ["z", "b"]
h = ["p - own", "v"]
R = [[4, 1], [1, "r"]]

[model]
state = ["p", "v"]
f = ["p + v*dt", "v"]
Q = { v = "q*dt" }
x0 = [0, 0]
P0 = [100, 10]

[parameters]
q = { min = 0.01, max = 10, scale = "log", start = 1 }
r = { min = 0.1, max = 100, start = 5 }
"#;

#[test]
fn sensors_have_their_blocks_of_h_and_r() {
    let problem = Problem::parse(SOUND, "p.toml").unwrap_or_else(|e| panic!("{e}"));
    let model = &problem.model;
    assert_eq!(model.measurements, ["gps_z", "radar_z", "b"], "a shared column has the sensor's name before it");
    assert_eq!(model.h.len(), 3);
    let zero = |i: usize| model.r[i].is_zero();
    assert_eq!([0, 1, 2, 3, 4, 5, 6, 7, 8].map(zero), [false, true, true, true, false, false, true, false, false]);
    assert_eq!(problem.data.readers, [Some(vec![1])], "the radar's range alone needs the input");
    assert!(problem.tuned(&[2.0, 3.0]).contains("[[sensor]]\nname = \"radar\""), "{}", problem.tuned(&[2.0, 3.0]));
    let given = SOUND.replace("inputs", "measurements = [\"gps_z\", \"radar_z\", \"b\"]\ninputs");
    assert!(Problem::parse(&given, "p.toml").is_ok(), "the list may be given");
}

#[test]
fn built_in_motion_and_factors_go_with_sensors() {
    let text = SOUND
        .replace(
            "state = [\"p\", \"v\"]\nf = [\"p + v*dt\", \"v\"]\nQ = { v = \"q*dt\" }",
            "kind = \"constant-velocity\"\naxes = [\"p\"]\nq = \"q\"",
        )
        .replace(
            "\"v\"]\nR = [[4, 1], [1, \"r\"]]",
            "\"vp\"]\nangle = [\"b\"]\nR = { factor = \"M\", form = \"lower\" }",
        )
        .replace("[parameters]", "[parameters]\nM = { init = [0, 1], start = 1 }");
    let problem = Problem::parse(&text, "p.toml").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(problem.model.states, ["p", "vp"]);
    assert_eq!(problem.model.angles.measurements, [2]);
    assert_eq!(problem.parameters.names(), ["q", "r", "M11", "M21", "M22"]);
    let sentence = error(&text.replace("axes = [\"p\"]\n", "")).to_string();
    assert!(sentence.contains("[model] lacks `axes`: give the names of its axes"), "{sentence}");
}

/// What is replaced, by what, and how the sentence begins.
const CASES: [(&str, &str, &str); 20] = [
    ("name = \"gps\"\n", "", "7:1: [[sensor]] number 1 lacks `name`: give a name for messages and reports"),
    ("R = [\"r\"]\n", "", "7:1: [[sensor]] number 1 lacks `R`: give the covariance of its noise"),
    (
        "when = \"GPS\"",
        "wen = \"GPS\"",
        "9:1: unknown key `wen` in [sensor[1]]: did you mean `when`? (known: `name`, `measurements`, `h`, `at`, `velocity`, `R`, `angle`, `when`)",
    ),
    ("name = \"radar\"", "name = \"gps\"", "15:8: the name `gps` is already a sensor: choose another"),
    ("when = \"R2\"", "when = \"GPS\"", "16:8: `sensor[2].when`: sensor `gps` has the same label: give another"),
    (
        "when = \"R2\"\n",
        "",
        "16:17: `sensor[2].measurements[1]`: sensor `gps` measures this column too, so both need `when`, the label of their rows in the column that [data] names as `sensor`",
    ),
    (
        "sensor = \"who\"\n",
        "",
        "8:8: `sensor[1].when`: a label needs the column that it stands in: give `sensor = \"COLUMN\"` in [data]",
    ),
    ("\"b\"]", "\"gps_z\"]", "15:8: the name `gps_z` is already a measurement: choose another"),
    ("h = [\"p\"]", "h = [\"p\", \"v\"]", "11:5: `sensor[1].h` has 2 entries: expected 1, one per measurement (z)"),
    ("p - own", "p - w", "18:11: unknown name `w` (known: `p`, `v`, `q`, `r`, `own`, `pi`)"),
    (
        "p - own",
        "p*v - own",
        "18:7: `p*v` is not linear in the states, and the kalman filter needs sensor[2].h[1] to be linear (sums of states times parameters, inputs and dt): set `kind` in [filter] to one of",
    ),
    (
        "[[4, 1], [1, \"r\"]]",
        "[[4, 5], [5, \"r\"]]",
        "19:5: `sensor[2].R` is not positive definite at the start values: its smallest eigenvalue",
    ),
    (
        "[[4, 1], [1, \"r\"]]",
        "{ z = 1, c = 2 }",
        "19:14: `sensor[2].R` names measurement `c`, which does not exist (known: `z`, `b`)",
    ),
    (
        "[\"r\"]",
        "[\"r\"]\nangle = [\"b\"]",
        "13:10: `sensor[1].angle[1]` is \"b\": expected a measurement of the sensor (z)",
    ),
    (
        "Q = {",
        "angle = [\"b\"]\nQ = {",
        "24:10: `model.angle[1]`: `b` is measured by a sensor: give it under `angle` of its [[sensor]]",
    ),
    ("Q = {", "h = [\"p\"]\nQ = {", "24:5: `model.h`: every [[sensor]] has its own: move it there"),
    (
        "inputs",
        "measurements = [\"z\", \"b\"]\ninputs",
        "5:16: `data.measurements`: with [[sensor]] tables it must be [\"gps_z\", \"radar_z\", \"b\"] in this order, or be left out",
    ),
    (
        "inputs",
        "ignore_sensors = [\"GPS\"]\ninputs",
        "5:19: `data.ignore_sensors[1]`: `GPS` is `when` of a [[sensor]]: take it off one of them",
    ),
    ("when = \"GPS\"", "when = 1", "9:8: `sensor[1].when`: expected a string, found the number 1"),
    (
        "[[sensor]]\nname = \"gps\"",
        "[[sensors]]\nname = \"gps\"",
        "7:3: unknown key `sensors` in the problem file: did you mean `sensor`?",
    ),
];

#[test]
fn every_mistake_is_said_where_it_is() {
    let wrong = CASES.iter().filter_map(|(old, new, sentence)| {
        assert!(SOUND.contains(old), "{old}");
        let said = error(&SOUND.replacen(old, new, 1)).to_string();
        (!said.starts_with(&format!("p.toml:{sentence}"))).then(|| format!("{new}\n  {said}\n  {sentence}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let whole = |text: &str| error(text).to_string().lines().next().unwrap_or_default().to_owned();
    let no_labels = SOUND.replace("when = \"GPS\"\n", "").replace("when = \"R2\"\n", "");
    assert_eq!(
        whole(&no_labels),
        "p.toml:4:10: `data.sensor`: no [[sensor]] has `when`, the label that the rows of this sensor have in the column: give each one"
    );
    let table = SOUND.replacen("[[sensor]]", "[sensor]", 1);
    let rest = table.split("[[sensor]]").next().unwrap_or_default();
    assert_eq!(whole(rest), "p.toml:7:1: `sensor`: expected [[sensor]] tables, found a table");
}
