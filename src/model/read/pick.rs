//! `[tune] pick`: which member of a front is recommended.

use super::node::Node;
use crate::model::Pick;
use crate::model::error::{Cause, Fault, nearest};
use crate::objective::Objective;
use crate::words::shorten;

const EXPECTED: &str = "\"knee\", the name of an objective, or { weights = { ... } }";

/// `"knee"`, the name of a listed objective, or `{ weights = { nll = 0.7, rmse = 0.3 } }`.
pub(super) fn read(node: &Node<'_>, objectives: &[Objective]) -> Result<Pick, Fault> {
    if node.value.is_str() {
        return match node.string()? {
            "knee" => Ok(Pick::Knee),
            name => position(node, name, objectives).map(Pick::Best).map_err(|cause| node.fault(cause)),
        };
    }
    let fields = node.table(EXPECTED, &["weights"])?;
    let weights =
        fields.need("weights", "a weight of each objective that counts, such as { nll = 0.7, rmse = 0.3 }")?;
    let mut found = vec![0.0; objectives.len()];
    for (name, span, weight) in &weights.table("a table of weights by objective", &[])?.entries {
        let at = position(weights, name, objectives).map_err(|cause| Fault::new(*span, cause))?;
        found[at] = weight.number()?;
        if found[at] < 0.0 {
            return Err(weight.bad_value(found[at], "a weight from 0"));
        }
    }
    if found.iter().all(|weight| *weight <= 0.0) {
        return Err(weights.invalid("no objective has a weight above 0: give one to each that counts"));
    }
    Ok(Pick::Weights(found))
}

fn position(node: &Node<'_>, name: &str, objectives: &[Objective]) -> Result<usize, Cause> {
    objectives.iter().position(|objective| objective.name() == name).ok_or_else(|| {
        let names = || objectives.iter().map(Objective::name);
        let known = names().map(str::to_owned).collect();
        let (key, nearest) = (node.key.clone(), nearest(name, names()));
        Cause::NoSuch { key, what: "the objective", name: shorten(name), nearest, known }
    })
}
