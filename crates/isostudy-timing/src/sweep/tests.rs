use super::*;
use crate::fixture;

fn made_up() -> Sweep {
    let (levels, meshes) = fixture::sweep_levels(&fixture::study());
    let level = |(cells, threads, run)| SweepLevel { cells, threads, run };
    let levels: Vec<SweepLevel> = levels.into_iter().map(level).collect();
    sweep("test", &levels, &meshes)
}

#[test]
fn a_known_law_is_found() {
    let found = made_up();
    assert_eq!(found.points.len(), 4 * 2 * 6);
    assert_eq!(found.growth.len(), 6 * 2 * 10);
    for growth in &found.growth {
        let want = match growth.quantity {
            Quantity::Samples | Quantity::Memory => 3.0,
            Quantity::Triangles | Quantity::Time(_) => 2.0,
        };
        assert!((growth.law.exponent - want).abs() < 1e-3, "{growth:?}");
        assert_eq!(growth.law.points, 3, "16 cells are below where the fit begins");
    }
    assert_eq!(found.speed_ups.len(), 4 * 6);
    for speed_up in &found.speed_ups {
        assert!((speed_up.ratio - 2.0).abs() < 1e-9 && speed_up.threads == 2, "{speed_up:?}");
        let interval = speed_up.interval.unwrap();
        assert!(interval.low < 2.0 && 2.0 < interval.high && interval.high < 2.1, "{interval:?}");
    }
}

#[test]
fn the_most_regular_for_a_cost_comes_first() {
    let found = made_up();
    let [triangles, seconds] = &found.budgets[..] else { panic!("{:?}", found.budgets) };
    // Integrated reaches 250 to 16,000 triangles, the others 1,000 to 64,000: 4,000 is in the middle of what they share.
    assert!(
        matches!(triangles.cost, budgets::Cost::Triangles(n) if (n - 4000.0).abs() < 1e-6),
        "{triangles:?}"
    );
    assert!(matches!(seconds.cost, budgets::Cost::Seconds(_)), "{seconds:?}");
    for budget in [triangles, seconds] {
        let codes: Vec<String> = budget.methods.iter().map(|best| best.method.to_string()).collect();
        assert_eq!(codes[..2], ["bi", "si"]);
        assert_eq!(budget.methods.len(), 6);
    }
    let (first, last) = (&triangles.methods[0], &triangles.methods[5]);
    assert!((first.cells - 64.0).abs() < 1e-6 && (last.cells - 32.0).abs() < 1e-6, "{first:?} {last:?}");
    assert!((first.triangles - 4000.0).abs() < 1e-6);
}

#[test]
fn tables_have_every_point_and_no_empty_column() {
    let tables = sweep_tables(&made_up());
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(names, ["sweep_exponents", "sweep_speed_up", "sweep_quality", "sweep"]);
    assert_eq!(tables[3].rows.len(), 4 * 2 * 6);
    let exponents = tables[0].to_markdown();
    assert!(exponents.contains("On 2 threads") && exponents.contains("2.00 \u{b1} 0.00"), "{exponents}");
    // 6 ms at 32 cells on one thread, a third of the rounds 1 and 2 % more: 4,000 triangles.
    let row = tables[3].shown_rows().into_iter().find(|row| row[..3] == ["ss_bu", "32", "1"]).unwrap();
    assert_eq!((row[3].as_str(), row[5].as_str()), ("32768", "4000"));
    assert!((row[7].parse::<f64>().unwrap() - 6.06).abs() < 0.07, "{row:?}");
    assert!(!exponents.contains("not quiet"), "{exponents}");
    let busy = sweep_tables(&Sweep { others: Some(0.4), ..made_up() });
    let note = "This machine was not quiet: others had up to 40 % of the CPU time.";
    assert!(busy[0].to_markdown().contains(note));
    let empty = Sweep { points: vec![], growth: vec![], speed_ups: vec![], budgets: vec![], ..made_up() };
    assert!(sweep_tables(&empty).is_empty());
}
