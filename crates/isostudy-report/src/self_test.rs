//! How probes, tests and intervals did on simulated studies, as tables.

use isostudy_inference::audit::Probe;
use isostudy_inference::self_test::{
    FULL, Hits, OTHERS_AT_MOST, OWN_AT_LEAST, Outcomes, PROBES_DESCRIPTION, RATES_DESCRIPTION, Rate, TOO_FEW,
};
use isostudy_table::{Cell, Columns, Table};

/// Everything, as two tables, `self_test_probes` and `self_test_rates`; it was simulated with this seed.
pub fn self_test_tables(outcomes: &Outcomes, seed: u64) -> [Table; 2] {
    [probe_table(&outcomes.probes, seed), rate_table(&outcomes.rates, seed)]
}

fn probe_table(hits: &[Hits], seed: u64) -> Table {
    let table = Columns::over(hits)
        .column("design", "Design", |of| Cell::text(of.design.label()))
        .column("defect", "Planted", |of| Cell::text(of.defect.label()))
        .columns_of(Probe::ALL, |all, probe| {
            all.column(probe.code().replace('-', "_"), probe.label(), |of| match of.never_answerable(probe) {
                true => Cell::text("not answerable"),
                false => Cell::Number(of.share(probe), 4),
            })
        })
        .column("studies", "Studies", |of| Cell::count(of.studies))
        .column("passed", "Passed", |of| Cell::text(verdict(Probe::ALL.iter().all(|&probe| of.sound(probe)))))
        .into_table("self_test_probes", "Share of studies in which each probe speaks up");
    table.with_note(format!(
        "Seed {seed}; {}. Passed: at least {OWN_AT_LEAST} on the probe's own defect, at most {OTHERS_AT_MOST} elsewhere; with three \
         standard errors of counting where a row has fewer than {FULL} studies. {}",
        PROBES_DESCRIPTION,
        TOO_FEW
    ))
}

fn rate_table(rates: &[Rate], seed: u64) -> Table {
    let table = Columns::over(rates)
        .column("method", "Method", |rate| Cell::text(rate.method))
        .column("truth", "Truth", |rate| Cell::text(&rate.truth))
        .column("counted", "Counted", |rate| Cell::text(rate.counted()))
        .column("studies", "Studies", |rate| Cell::count(rate.studies))
        .column("rate", "Rate", |rate| Cell::Number(rate.share(), 4))
        .column("low", "at least", |rate| Cell::number(rate.limits().map(|(low, _)| low), 4))
        .column("high", "at most", |rate| Cell::number(rate.limits().map(|(_, high)| high), 4))
        .column("passed", "Passed", |rate| {
            Cell::text(rate.limits().map_or("for comparison", |_| verdict(rate.sound())))
        })
        .into_table("self_test_rates", "How often tests reject what is true, and intervals cover it");
    table.with_note(format!(
        "{} Seed {seed}. Tests at 5 % may exceed it by three standard errors of counting; intervals at 95 % have to cover \
         between 94 and 96 %, or within three standard errors of counting of 95 % if there are so few studies that these are more. Rows for comparison show what methods do that take answers as independent, or that are known to \
         fall short in small studies.",
        RATES_DESCRIPTION
    ))
}

fn verdict(sound: bool) -> &'static str {
    if sound { "yes" } else { "NO" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_inference::self_test::{Defect, Design, simulated};
    use isostudy_inference::series::Part;

    #[test]
    fn the_same_on_any_number_of_threads() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let series = pool.install(|| simulated(12, 4, Part::WHOLE));
            let [probes, rates] = self_test_tables(&Outcomes::of(&series), 4);
            (probes.to_csv(), rates.to_csv())
        };
        let one = run(1);
        assert_eq!(one, run(3));
        assert_eq!(one.0.lines().count(), Design::ALL.len() * Defect::ALL.len());
        let header = "design,defect,side,outlying_respondent,copied_rows,swapped_key,object_interaction,separation,studies,passed";
        assert!(one.0.starts_with(header));
    }
}
