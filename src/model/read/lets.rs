//! The `[model.let]` table: names for formulas, in the order of the file.

use super::names::{check_name, limit};
use super::node::Node;
use crate::model::error::{Cause, Fault};
use crate::model::formula::{FormulaPlace, Let, Names, Scope};

/// Most names of it.
const MAX_LETS: usize = 1024;

/// Reads every name with its formula into `names`, which has all others already.
pub(super) fn read(node: &Node<'_>, names: &mut Names) -> Result<(), Fault> {
    let fields = node.table("a table of formulas by name", &[])?;
    limit(node.span, fields.entries.len(), "names in [model.let]", MAX_LETS)?;
    for (name, span, _) in &fields.entries {
        check_name(name, *span)?;
        let has = |list: &[String]| list.iter().any(|known| known == name);
        let taken = match () {
            () if has(&names.states) => "a state",
            () if has(&names.parameters) => "a parameter",
            () if has(&names.inputs) => "an input",
            () => continue,
        };
        return Err(Fault::new(*span, Cause::NameTaken { name: (*name).to_owned(), taken }));
    }
    names.coming = fields.entries.iter().map(|(name, ..)| (*name).to_owned()).collect();
    for (name, _, node) in &fields.entries {
        let formula = node.formula(Scope { names, place: FormulaPlace::Let, key: "" })?;
        let (size, depth) = formula.extent();
        names.coming.remove(0);
        names.lets.push(Let { name: (*name).to_owned(), formula, size, depth });
    }
    Ok(())
}
