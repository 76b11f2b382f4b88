//! The `[parameters]` table.

use super::{SOUND, broken, check, error};

#[test]
fn parameters() {
    let r = "r = { min = 0.1, max = 100, start = 5 }";
    check(&[
        (
            r,
            "r = { min = 3, max = 0.3 }",
            "0.3",
            "20:22: `parameters.r.max` is 0.3: expected a number above `min`, which is 3",
        ),
        (
            r,
            "r = { min = 3, max = 3 }",
            "3",
            "20:22: `parameters.r.max` is 3: expected a number above `min`, which is 3",
        ),
        (
            r,
            "r = { min = 0, max = 3, scale = \"log\" }",
            "0",
            "20:13: `parameters.r.min` is 0: expected a number above 0, because the scale is log",
        ),
        (
            r,
            "r = { min = 1, max = 3, scale = \"cubic\" }",
            "\"cubic\"",
            "20:33: `parameters.r.scale` is \"cubic\": expected \"linear\" or \"log\"",
        ),
        (
            r,
            "r = { min = 1, max = 3, start = 4 }",
            "4",
            "20:33: `parameters.r.start` is 4: expected a number inside the bounds 1 to 3",
        ),
        (r, "r = { min = 1, max = nan }", "nan", "20:22: `parameters.r.max` is nan: expected a finite number"),
        (
            r,
            "r = { min = 1 }",
            "{ min = 1 }",
            "20:5: `parameters.r`: `min` and `max` come together: give both, or `init` alone for no bounds",
        ),
        (
            r,
            "r = { start = 1 }",
            "{ start = 1 }",
            "20:5: `parameters.r`: a searched parameter needs `min` and `max`, or `init` for one without bounds",
        ),
        (
            r,
            "r = { init = [1, 2], scale = \"log\" }",
            "{ init = [1, 2], scale = \"log\" }",
            "20:5: `parameters.r`: a log scale needs `min` and `max`, both above 0",
        ),
        (
            r,
            "r = { init = [2, 1] }",
            "[2, 1]",
            "20:14: `parameters.r.init` is [2, 1]: expected [low, high] with low below high",
        ),
        (
            r,
            "r = { min = 1, max = 3, init = [0, 2] }",
            "[0, 2]",
            "20:32: `parameters.r.init` is [0, 2]: expected an interval inside the bounds 1 to 3",
        ),
    ]);
}

#[test]
fn ties_and_sizes() {
    let r = "r = { min = 0.1, max = 100, start = 5 }";
    check(&[
        (
            r,
            "r = { tie = \"s\" }",
            "\"s\"",
            "20:13: `parameters.r.tie` names the parameter `s`, which does not exist (known: `q`, `r`)",
        ),
        (r, "r = { tie = \"r\" }", "\"r\"", "20:13: `parameters.r.tie`: a parameter cannot be tied to itself"),
        (
            r,
            "r = { tie = \"q\", min = 1 }",
            "1",
            "20:24: `parameters.r.min`: it cannot stand beside `tie`: remove one of them",
        ),
        (
            r,
            "r = { tie = \"s\" }\ns = { tie = \"q\" }",
            "{ tie = \"s\" }",
            "20:5: `r`: it is tied to a parameter that is tied itself: tie both to the same one",
        ),
        (
            r,
            "r = \"5\"",
            "\"5\"",
            "20:5: `parameters.r`: expected a number, or a table such as { min = 0.1, max = 45, scale = \"log\", start = 10 }, found the string \"5\"",
        ),
        (
            r,
            "r = { min = -1e308, max = 1e308 }",
            "{ min = -1e308, max = 1e308 }",
            "20:5: `parameters.r`: the bounds are too far apart",
        ),
    ]);
    let many: String = (0..1100).map(|i| format!("k{i} = 1\n")).collect();
    let (sentence, _) = broken(r, &format!("{r}\n{many}"));
    assert_eq!(sentence, "p.toml:18:1: 1102 parameters: at most 1024 are allowed");
}

#[test]
fn templates_of_factors() {
    let factored = |template: &str| {
        let text = SOUND.replace("P0 = [100, 10]", "P0 = { factor = \"M\", form = \"square\" }");
        error(&format!("{}\n", text.replace("[filter]", &format!("{template}\n[filter]")))).to_string()
    };
    for (template, message) in [
        (
            "M = { min = 1, max = 9, start = 2 }",
            "22:5: `parameters.M`: the bounds of a factor's template with a start must include 0",
        ),
        (
            "M = { min = 1, max = 9, scale = \"log\" }",
            "22:5: `parameters.M`: a factor's template cannot be on a log scale",
        ),
        ("M = { tie = \"r\" }", "22:5: `parameters.M`: a factor's template cannot be tied"),
        ("M12 = 3", "15:17: `M`: the factor `M` has no template"),
    ] {
        let found = factored(template);
        assert!(found.starts_with(&format!("p.toml:{message}")), "{found}");
    }
    let text = SOUND.replace("P0 = [100, 10]", "P0 = { factor = \"M\", form = \"lower\" }");
    let shared = error(&text.replace("R = { z = \"r\" }", "R = { factor = \"M\", form = \"lower\" }")).to_string();
    assert!(shared.starts_with("p.toml:15:17: `M`: two matrices cannot share one factor"), "{shared}");
}
