//! How probes, tests and intervals did on simulated studies, as tables.

use isostudy_inference::audit::Probe;
use isostudy_inference::self_test::{
    FULL, Hits, OTHERS_AT_MOST, OWN_AT_LEAST, PROBES_DESCRIPTION, RATES_DESCRIPTION, Rate, TOO_FEW, probes,
    rates,
};
use isostudy_table::{Cell, Table};

/// Everything, as two tables, `self_test_probes` and `self_test_rates`, and whether all is as it has to be.
pub fn self_test_tables(studies: u64, seed: u64) -> ([Table; 2], bool) {
    let (hits, rates) = (probes(studies, seed), rates(studies, seed));
    let sound = hits.iter().all(|h| Probe::ALL.iter().all(|&p| h.sound(p))) && rates.iter().all(Rate::sound);
    ([probe_table(&hits, seed), rate_table(&rates, seed)], sound)
}

fn probe_table(hits: &[Hits], seed: u64) -> Table {
    let mut columns =
        vec![("design".to_owned(), "Design".to_owned()), ("defect".to_owned(), "Planted".to_owned())];
    columns.extend(Probe::ALL.iter().map(|p| (p.code().replace('-', "_"), p.label().to_owned())));
    columns.extend([("studies".into(), "Studies".into()), ("passed".into(), "Passed".into())]);
    let columns: Vec<(&str, &str)> = columns.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let mut table =
        Table::new("self_test_probes", "Share of studies in which each probe speaks up", &columns);
    for of in hits {
        let mut row = vec![Cell::text(of.design.label()), Cell::text(of.defect.label())];
        row.extend(Probe::ALL.iter().map(|&probe| match of.never_answerable(probe) {
            true => Cell::text("not answerable"),
            false => Cell::Number(of.share(probe), 4),
        }));
        row.push(Cell::count(of.studies));
        row.push(Cell::text(verdict(Probe::ALL.iter().all(|&probe| of.sound(probe)))));
        table.push(row);
    }
    table.notes.push(format!(
        "Seed {seed}; {}. Passed: at least {OWN_AT_LEAST} on the probe's own defect, at most {OTHERS_AT_MOST} elsewhere; with three \
         standard errors of counting where a row has fewer than {FULL} studies. {}",
        PROBES_DESCRIPTION,
        TOO_FEW
    ));
    table
}

fn rate_table(rates: &[Rate], seed: u64) -> Table {
    let mut table = Table::new(
        "self_test_rates",
        "How often tests reject what is true, and intervals cover it",
        &[
            ("method", "Method"),
            ("truth", "Truth"),
            ("counted", "Counted"),
            ("studies", "Studies"),
            ("rate", "Rate"),
            ("low", "at least"),
            ("high", "at most"),
            ("passed", "Passed"),
        ],
    );
    for rate in rates {
        table.push(vec![
            Cell::text(rate.method),
            Cell::text(&rate.truth),
            Cell::text(rate.counted()),
            Cell::count(rate.studies),
            Cell::Number(rate.share(), 4),
            Cell::number(rate.limits().map(|(low, _)| low), 4),
            Cell::number(rate.limits().map(|(_, high)| high), 4),
            Cell::text(rate.limits().map_or("for comparison", |_| verdict(rate.sound()))),
        ]);
    }
    table.notes.push(format!(
        "{} Seed {seed}. Tests at 5 % may exceed it by three standard errors of counting; intervals at 95 % have to cover \
         between 94 and 96 %, or within three standard errors of counting of 95 % if there are so few studies that these are more. Rows for comparison show what methods do that take answers as independent, or that are known to \
         fall short in small studies.",
        RATES_DESCRIPTION
    ));
    table
}

fn verdict(sound: bool) -> &'static str {
    if sound { "yes" } else { "NO" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_inference::self_test::{Defect, Design};

    #[test]
    fn the_same_on_any_number_of_threads() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let ([probes, rates], _) = pool.install(|| self_test_tables(12, 4));
            (probes.to_csv(), rates.to_csv())
        };
        let one = run(1);
        assert_eq!(one, run(3));
        assert_eq!(one.0.lines().count(), Design::ALL.len() * Defect::ALL.len());
        let header = "design,defect,side,outlying_respondent,copied_rows,swapped_key,object_interaction,separation,studies,passed";
        assert!(one.0.starts_with(header));
    }
}
