//! The `[parameters]` table.

use super::{SOUND, error};

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
