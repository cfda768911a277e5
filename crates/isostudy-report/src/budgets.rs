//! Which spacings were chosen, in a sentence.

use crate::words::{list, whole};
use isostudy_design::config::Quantity;
use isostudy_inference::Inputs;

/// Captions name no more methods: the notes of tables do.
const NAMED: usize = 3;

/// Which methods have another spacing than their object, and why, in a sentence.
pub(crate) fn budgets(inputs: &Inputs<'_>) -> Option<String> {
    sentence(inputs, list)
}

/// The same for a caption: of many methods, how many there are.
pub(crate) fn in_short(inputs: &Inputs<'_>) -> Option<String> {
    sentence(inputs, |methods| match methods.len() {
        ..=NAMED => list(methods),
        many => format!("{} methods", whole(many as u64)),
    })
}

fn sentence(inputs: &Inputs<'_>, named: impl Fn(&[String]) -> String) -> Option<String> {
    // Those of one budget together, in the order of the first of each.
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for method in &inputs.study.methods {
        let Some(budget) = method.budget else { continue };
        let (what, of) = (budget.quantity.names()[1], budget.of);
        let much = if budget.quantity == Quantity::Time { "much" } else { "many" };
        let within = isostudy_table::digits::number(100.0 * budget.within, 2);
        let within = within.trim_end_matches('0').trim_end_matches('.');
        let aim = format!("to have as {much} {what} as {of} to {within} %");
        match found.iter_mut().find(|(other, _)| *other == aim) {
            Some((_, methods)) => methods.push(method.id.to_string()),
            None => found.push((aim, vec![method.id.to_string()])),
        }
    }
    let found: Vec<String> = found.iter().map(|(aim, methods)| format!("{} {aim}", named(methods))).collect();
    (!found.is_empty()).then(|| format!("Spacings were chosen for {}, object by object.", found.join("; ")))
}
