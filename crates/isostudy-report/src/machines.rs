//! Several machines as a section of the report: what each says, and whether they agree.

use crate::standing::Standing;
use crate::statement::{Block, Finding, Section};
use crate::words::{counted, list};
use isostudy_table::Table;
use isostudy_timing::machines::{Agreement, Machines};

/// What the machines of a study say, with its own tables. `missing` have not measured it.
pub fn machines_section(of: &Machines, missing: &[String], tables: &[Table]) -> Section {
    let mut blocks = vec![Block::Finding(verdict(of))];
    blocks.extend(remarks(of, missing).into_iter().map(Block::Text));
    for table in tables {
        let is_first = ["machines", "machine_fastest"].contains(&table.name.as_str());
        blocks.push(if is_first { Block::Table(table.clone()) } else { Block::Folded(table.clone()) });
    }
    Section { id: "machines", heading: "Whether machines agree", blocks }
}

/// Whether the machines agree, in a sentence or two.
fn verdict(of: &Machines) -> Finding {
    let names: Vec<String> = of.machines.iter().map(|says| says.name.clone()).collect();
    if names.len() < 2 {
        let text = "A single machine measured the study, so nothing is said of agreement.";
        return noted(text);
    }
    let [same, contradicted, one, none] =
        [Agreement::Same, Agreement::Contradicted, Agreement::OneTells, Agreement::NoneTells]
            .map(|agreement| of.count(agreement));
    let told = same + contradicted;
    let pairs = |count: usize| counted(count, "pair");
    let left = format!(
        "Of {} in all, {one} {} distinguished by one machine alone, and {none} by none.",
        pairs(of.pairs.len()),
        if one == 1 { "is" } else { "are" },
    );
    if told == 0 {
        let text =
            format!("No two of the machines {} distinguish the same pair of methods. {left}", list(&names));
        return noted(text);
    }
    if contradicted == 0 {
        let text = format!(
            "The machines {} agree: each pair of methods that two of them distinguish has the same order on both ({}). {left}",
            list(&names),
            pairs(same)
        );
        return noted(text);
    }
    let of_contradicted = of.pairs.iter().filter(|pair| pair.agreement == Agreement::Contradicted);
    let first = of_contradicted.clone().next();
    let example = first.map_or(String::new(), |pair| format!(" One is {} and {}.", pair.first, pair.second));
    let text = format!(
        "The machines {} do not agree: of {} that two of them distinguish, {} in another order on one than on another.{example} {left}",
        list(&names),
        pairs(told),
        if contradicted == 1 { "1 stands".to_owned() } else { format!("{contradicted} stand") },
    );
    noted(text)
}

/// A description: no test at a level stands behind agreement.
fn noted(text: impl Into<String>) -> Finding {
    Finding::new(Standing::Noted, text)
}

fn remarks(of: &Machines, missing: &[String]) -> Vec<String> {
    let mut remarks = Vec::new();
    let name = |place: usize| &of.machines[place].name;
    for [a, b] in &of.alike {
        remarks.push(format!("{} and {} are of one kind. That they agree says little.", name(*a), name(*b)));
    }
    let busy: Vec<String> =
        of.machines.iter().filter(|says| says.is_busy()).map(|says| says.name.clone()).collect();
    if !busy.is_empty() {
        let was = if busy.len() == 1 { "was" } else { "were" };
        remarks.push(format!(
            "{} {was} not quiet during the run. Times of such a run are worth less, and so are their verdicts.",
            list(&busy)
        ));
    }
    if !missing.is_empty() {
        let has = if missing.len() == 1 { "has" } else { "have" };
        remarks.push(format!("{} {has} not measured the study as it is now.", list(missing)));
    }
    remarks
}
