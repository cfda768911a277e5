//! Worths are not fitted again: the printed ones are put into the likelihood, which has to be what is printed and to be flat
//! there.

use super::{Given, Oracle};
use crate::compare::{Cells, Compared};
use crate::exact::holm;
use crate::people::Pressed;
use isostudy_table::Table;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::BTreeMap;

/// Slope of a log-likelihood that counts as none.
const FLAT: f64 = 2e-3;

/// What the parameter of ties is called.
const TIES: &str = "the ties";

/// An answer as a model sees it: the items on the left and right, and what was pressed.
type Contest = ([usize; 2], Pressed);

/// Holds the tables of models and worths against the answers.
pub(crate) fn compare_worths(oracle: &Oracle<'_>, tables: &[Table]) -> Compared {
    let mut compared = Compared::default();
    // Where no model has an estimate there is no table of worths.
    let worths = Cells::of(tables, "worths");
    let Some(models) = Cells::of(tables, "models") else {
        let any = oracle.comparisons().next().is_some();
        compared.check(!any, ["models", "", ""], "no table", "a table");
        return compared;
    };
    for group in names(oracle) {
        let rows =
            (0..models.rows()).filter(|&row| models.at(row, "group").as_deref() == Some(&group)).count();
        compared.check(rows >= 4, ["models", &group, "model"], rows, "4 models or more");
    }
    for row in 0..models.rows() {
        let text = |column: &str| models.at(row, column).unwrap_or_default();
        let (group, model) = (text("group"), text("model"));
        let name = format!("{group} {model}");
        let Some((items, contests)) = contests(oracle, &group) else {
            compared.check(false, ["models", &name, "group"], &group, "a group that is known");
            continue;
        };
        let mut check = |met: bool, column: &str, got: String, want: String| {
            compared.check(met, ["models", &name, column], got, want);
        };
        check(
            text("answers") == contests.len().to_string(),
            "answers",
            text("answers"),
            contests.len().to_string(),
        );
        let is_open = connected(items.len(), &contests);
        // Without wins both ways the likelihood may have no maximum; with them it has one, sides apart.
        if is_open && model != "davidson-side" {
            check(text("penalised") == "no", "penalised", text("penalised"), "no".into());
        }
        let blamed = text("remark").contains("never won");
        check(!(is_open && blamed), "remark", text("remark"), "nothing of items that never won".into());
        let own = |item: &String| {
            let worths = worths.as_ref()?;
            let found = (0..worths.rows()).find(|&row| {
                let is = |column: &str, what: &str| worths.at(row, column).as_deref() == Some(what);
                is("group", &group) && is("model", &model) && is("item", item)
            });
            worths.number(found?, "log_worth")
        };
        let values: Option<Vec<f64>> = items.iter().map(own).collect();
        let (Some(values), Some(printed)) = (values, models.number(row, "log_likelihood")) else {
            check(
                !is_open || model == "davidson-side",
                "log_likelihood",
                "no estimate".into(),
                "an estimate".into(),
            );
            continue;
        };
        if text("penalised") != "no" {
            continue;
        }
        let extra = |column: &str| models.number(row, column);
        let found = Parameters {
            tie: extra("ln_nu").or_else(|| extra("ln_theta")),
            side: extra("side").unwrap_or(0.0),
            worths: values,
        };
        let likelihood =
            |at: &Parameters| contests.iter().map(|contest| at.ln_chance(&model, *contest)).sum::<f64>();
        let own = likelihood(&found);
        let met = (own - printed).abs() <= 1e-7 * printed.abs().max(1.0);
        check(met, "log_likelihood", printed.to_string(), own.to_string());
        let has_side = model == "davidson-side";
        for (name, slope) in slopes(&found, has_side, &items, likelihood) {
            // Rao and Kupper's threshold cannot be below zero.
            let at_the_end = name == TIES && model == "rao-kupper" && found.tie == Some(0.0) && slope < 0.0;
            let met = slope.abs() <= FLAT || at_the_end;
            check(met, &format!("slope in {name}"), slope.to_string(), "0".into());
        }
        // The side's p is that of twice the gain in likelihood.
        let plain = (0..models.rows()).find(|&plain| {
            models.at(plain, "group").as_deref() == Some(&group)
                && models.at(plain, "model").as_deref() == Some("davidson")
        });
        let plain = plain.filter(|&plain| models.at(plain, "penalised").as_deref() == Some("no"));
        let without = plain.and_then(|plain| models.number(plain, "log_likelihood"));
        if let (true, Some(without), Some(p)) = (has_side, without, extra("side_p")) {
            let one = ChiSquared::new(1.0).expect("one degree");
            let want = one.sf((2.0 * (printed - without)).max(0.0));
            check((want - p).abs() < 1e-6, "side_p", p.to_string(), want.to_string());
        }
    }
    compared
}

/// Holds the scale of each group, and its differences, against the worths that were tried: positions and ends are those of the
/// model that is named, units and corrections follow.
pub(crate) fn compare_scales(tables: &[Table]) -> Compared {
    let mut compared = Compared::default();
    let all = [Cells::of(tables, "scale"), Cells::of(tables, "differences"), Cells::of(tables, "worths")];
    let [Some(scale), Some(differences), Some(worths)] = all else { return compared };
    let near = |got: Option<f64>, want: Option<f64>| match (got, want) {
        (Some(got), Some(want)) => (got - want).abs() <= 1e-7 * want.abs().max(1.0),
        (got, want) => got == want,
    };
    let worth = |group: &str, model: &str, item: &str, column: &str| {
        let row = (0..worths.rows()).find(|&row| {
            let is = |column: &str, what: &str| worths.at(row, column).as_deref() == Some(what);
            is("group", group) && is("model", model) && is("item", item)
        });
        worths.number(row?, column)
    };
    for (name, cells) in [("scale", &scale), ("differences", &differences)] {
        for row in 0..cells.rows() {
            let text = |column: &str| cells.at(row, column).unwrap_or_default();
            let (group, model) = (text("group"), text("model"));
            let model = model.split(',').next().unwrap_or_default();
            let (label, of, log_odds) = match name {
                "scale" => {
                    let item = text("item");
                    (format!("{group} {item}"), worth(&group, model, &item, "log_worth"), "log_worth")
                }
                _ => {
                    let [first, second] = [text("first"), text("second")];
                    let of = |item: &str| worth(&group, model, item, "log_worth");
                    let less = of(&first).zip(of(&second)).map(|(first, second)| first - second);
                    (format!("{group} {first} {second}"), less, "log_odds")
                }
            };
            let mut check = |column: &str, want: Option<f64>| {
                let got = cells.number(row, column);
                compared.check(
                    near(got, want),
                    [name, &label, column],
                    format!("{got:?}"),
                    format!("{want:?}"),
                );
            };
            check(log_odds, of);
            if name == "scale" && text("item") != text("reference") {
                let ends = ["low", "high"].map(|end| worth(&group, model, &text("item"), end));
                // A penalised model has an interval in the table of worths, which shows what programs print, and none here.
                if !text("model").contains("added") {
                    check("low", ends[0]);
                    check("high", ends[1]);
                }
            }
            for (end, of) in [
                ("", cells.number(row, log_odds)),
                ("_low", cells.number(row, "low")),
                ("_high", cells.number(row, "high")),
            ] {
                check(&format!("jod{end}"), of.map(|of| of / 3.0_f64.ln()));
                check(&format!("preferred{end}"), of.map(|of| 1.0 / (1.0 + (-of).exp())));
            }
        }
        corrections(name, cells, &mut compared);
    }
    compared
}

/// Corrected p: of differences over the pairs of a group, of scales over the groups.
fn corrections(name: &str, cells: &Cells<'_>, compared: &mut Compared) {
    let family =
        |row: usize| if name == "scale" { String::new() } else { cells.at(row, "group").unwrap_or_default() };
    let mut families: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for row in (0..cells.rows()).filter(|&row| cells.number(row, "p").is_some()) {
        families.entry(family(row)).or_default().push(row);
    }
    for (group, rows) in families {
        // A difference without a test counts as one with p = 1.
        let untested =
            (0..cells.rows()).filter(|&row| family(row) == group && cells.number(row, "p").is_none());
        let ones = if name == "scale" { 0 } else { untested.count() };
        let mut p: Vec<f64> = rows.iter().filter_map(|&row| cells.number(row, "p")).collect();
        p.extend(std::iter::repeat_n(1.0, ones));
        for (&row, want) in rows.iter().zip(holm(&p)) {
            let got = cells.number(row, "p_adjusted").unwrap_or(f64::NAN);
            compared.check((got - want).abs() < 1e-9, [name, &group, "p_adjusted"], got, want);
        }
    }
}

/// The groups that have answers: the study's, then values pooled where several groups have them.
fn names(oracle: &Oracle<'_>) -> Vec<String> {
    let mut names: Vec<String> = oracle.groups.iter().map(|(group, _)| group.clone()).collect();
    names.retain(|group| oracle.comparisons().any(|(question, _)| question.group == *group));
    for factor in ["clustering", "arrangement"] {
        let own = oracle.comparisons().filter(|(question, _)| question.compared.factor == factor);
        let mut groups: Vec<&str> = own.map(|(question, _)| question.group.as_str()).collect();
        groups.sort_unstable();
        groups.dedup();
        names.extend((groups.len() > 1).then(|| factor.to_owned()));
    }
    names
}

/// The group of all methods, where no group of the study hangs alone.
const ALL: &str = "all";

/// Every method of a group, lattice by lattice.
fn methods(oracle: &Oracle<'_>) -> Vec<String> {
    let crossed = oracle.lattices.iter().flat_map(|lattice| {
        oracle.clusterings.iter().map(move |clustering| format!("{lattice}{clustering}"))
    });
    crossed.filter(|method| oracle.groups.iter().any(|(_, members)| members.contains(method))).collect()
}

/// Names of a group's items as tables have them, and every answer about them. `None` if nobody knows such a group.
fn contests(oracle: &Oracle<'_>, group: &str) -> Option<(Vec<String>, Vec<Contest>)> {
    let upper = |letters: &[char]| letters.iter().map(|letter| letter.to_uppercase().to_string()).collect();
    let items: Vec<String> = match group {
        "clustering" => upper(&oracle.clusterings),
        "arrangement" => upper(&oracle.lattices),
        ALL => methods(oracle),
        _ => oracle.groups.iter().find(|(id, _)| id == group)?.1.clone(),
    };
    let own = oracle.comparisons().filter(|(question, _)| match group {
        "clustering" | "arrangement" => question.compared.factor == group,
        ALL => true,
        _ => question.group == group,
    });
    let contest = |given: &Given| {
        let item = |method: &str| {
            let name = match group {
                "clustering" => method[1..].to_uppercase(),
                "arrangement" => method[..1].to_uppercase(),
                _ => method.to_owned(),
            };
            items.iter().position(|item| *item == name).expect("one of the group's items")
        };
        ([item(given.left()), item(given.right())], given.pressed)
    };
    let contests = own.map(|(_, given)| contest(given)).collect();
    Some((items, contests))
}

/// Whether wins lead from every item to every other.
fn connected(items: usize, contests: &[Contest]) -> bool {
    let mut beats = vec![vec![false; items]; items];
    for ([left, right], pressed) in contests {
        match pressed {
            Pressed::Left => beats[*left][*right] = true,
            Pressed::Right => beats[*right][*left] = true,
            Pressed::Neither => {}
        }
    }
    for by in 0..items {
        for from in 0..items {
            for to in 0..items {
                beats[from][to] |= beats[from][by] && beats[by][to];
            }
        }
    }
    (0..items).all(|a| (0..items).all(|b| a == b || beats[a][b]))
}

#[derive(Clone)]
struct Parameters {
    worths: Vec<f64>,
    /// ln nu or ln theta; none where there was no tie.
    tie: Option<f64>,
    side: f64,
}

impl Parameters {
    fn ln_chance(&self, model: &str, ([left, right], pressed): Contest) -> f64 {
        let apart = self.worths[left] - self.worths[right] + self.side;
        let chances: [f64; 3] = match model {
            "bradley-terry" => {
                let [a, b] = [1.0 / (1.0 + (-apart).exp()), 1.0 / (1.0 + apart.exp())];
                // A tie is half a win for each.
                [a, (a * b).sqrt(), b]
            }
            "rao-kupper" => {
                let theta = self.tie.unwrap_or(0.0).exp();
                let [a, b] = [1.0 / (1.0 + theta * (-apart).exp()), 1.0 / (1.0 + theta * apart.exp())];
                [a, 1.0 - a - b, b]
            }
            _ => {
                let weights = [(0.5 * apart).exp(), self.tie.map_or(0.0, f64::exp), (-0.5 * apart).exp()];
                weights.map(|weight| weight / weights.iter().sum::<f64>())
            }
        };
        chances[match pressed {
            Pressed::Left => 0,
            Pressed::Neither => 1,
            Pressed::Right => 2,
        }]
        .ln()
    }
}

/// How steeply a function rises with each parameter; the first item's worth is zero by definition.
fn slopes(
    at: &Parameters,
    has_side: bool,
    items: &[String],
    of: impl Fn(&Parameters) -> f64,
) -> Vec<(String, f64)> {
    const STEP: f64 = 1e-4;
    let slope = |moved: &dyn Fn(&mut Parameters, f64)| {
        let [up, down] = [STEP, -STEP].map(|by| {
            let mut there = at.clone();
            moved(&mut there, by);
            of(&there)
        });
        (up - down) / (2.0 * STEP)
    };
    let mut slopes: Vec<(String, f64)> =
        (1..items.len()).map(|i| (items[i].clone(), slope(&|p, by| p.worths[i] += by))).collect();
    if at.tie.is_some() {
        slopes.push((TIES.into(), slope(&|p, by| p.tie = p.tie.map(|tie| tie + by))));
    }
    if has_side {
        slopes.push(("the side".into(), slope(&|p, by| p.side += by)));
    }
    slopes
}
