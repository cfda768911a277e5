//! Published comparisons with ties, analysed as a stranger's file: the tables a user gets, against R and NumPy.

use crate::answers::analyse;
use std::collections::BTreeMap;
use std::path::Path;

/// English Premier League 2008-9, home row against away column: H home win, D draw, A away win; teams by name, Arsenal
/// first. Data set `football` of the R package BradleyTerry2 1.1-2.
const FOOTBALL: &str = "\
-AHHAHDADHHHHHHDDHDH
D-HHADDHDAHDHDDHAHDD
AA-DADHDADDAHHHAHDDH
ADD-AAADAHHAHHHDHDHA
AHHH-DHDAHHDDHHHDHDH
DAAHD-HHADADDAHHDHHH
HHAHDA-AAHDHHHHDHHAH
AAAAADH-AHDADDAAADHA
DHHHHDDD-HDHHHDHHHDH
DDDAAADHH-HADDHDHADD
HHHHAAAHAH-AHHHHAHHH
DHHHHHHHAHH-DHHHHHHH
AHAHADAAAHDA-DDDHHDD
AAHHAHDDAHHAA-HHHDAA
HHHHAADDDHHADD-HHHAH
DADAAAHHAHAAHAH-DHAA
DAHHHADAHHHDHDHA-HHD
AADDAAHAAHHAADAHH-HH
AAHAAAHHAHHAHDHHAD-H
AAHDAHDHDAHAHHDDHHA-";

/// Every match in the long format, the home team on the left and in the participant's place.
fn long() -> String {
    let mut text = String::from("participant,question,left,right,choice\n");
    for (home, line) in FOOTBALL.lines().enumerate() {
        for (away, result) in line.chars().enumerate() {
            let choice = match result {
                'H' => "left",
                'D' => "none",
                'A' => "right",
                _ => continue,
            };
            text.push_str(&format!("{home},{home}-{away},team {home},team {away},{choice}\n"));
        }
    }
    text
}

/// A table's cells by row and column; a row is named by its first cells, as many as `keys`.
fn table(out: &Path, name: &str, keys: usize) -> BTreeMap<(String, String), String> {
    let mut reader = csv::Reader::from_path(out.join(format!("tables/{name}.csv"))).unwrap();
    let header = reader.headers().unwrap().clone();
    let mut cells = BTreeMap::new();
    for row in reader.records().map(Result::unwrap) {
        let key = row.iter().take(keys).collect::<Vec<_>>().join("/");
        for (column, cell) in header.iter().zip(&row) {
            cells.insert((key.clone(), column.to_owned()), cell.to_owned());
        }
    }
    cells
}

#[test]
fn football_with_home_advantage_as_gnm_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let [path, out] = ["football.csv", "out"].map(|name| folder.path().join(name));
    std::fs::write(&path, long()).unwrap();
    let run = analyse(&[path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let (worths, models, tests) =
        (table(&out, "worths", 3), table(&out, "models", 2), table(&out, "tests", 3));
    let header = |name: &str| {
        let text = std::fs::read_to_string(out.join(format!("tables/{name}.csv"))).unwrap();
        text.lines().next().unwrap().to_owned()
    };
    assert!(header("worths").starts_with("group,item,model,log_worth,se,"), "{}", header("worths"));
    assert!(header("models").starts_with("group,model,log_likelihood,ln_nu,side,"), "{}", header("models"));
    assert_eq!((worths.len() / 8, models.len() / 11, tests.len() / 23), (80, 4, 190));

    let near = |cell: &str, want: f64, tolerance: f64| {
        let got: f64 = cell.parse().unwrap();
        assert!((got - want).abs() < tolerance, "{got} is not {want}");
    };
    let model = |model: &str, column: &str| &models[&(format!("all/{model}"), column.to_owned())][..];
    let worth = |team: usize, model: &str, column: &str| {
        &worths[&(format!("all/team {team}/{model}"), column.to_owned())][..]
    };
    // R 4.2.2, gnm 1.1-2, one row a match and outcome: gnm(y ~ X + tie + side - 1, eliminate = match, family = poisson),
    // X half credits as in GenDavidson; log-likelihood = -deviance / 2. gnm stops some 5e-8 short of the maximum.
    for (got, want) in [
        (model("davidson-side", "log_likelihood"), -349.663_716_215_210_2),
        (model("davidson-side", "ln_nu"), -0.115_936_840_087_198_2),
        (model("davidson-side", "side"), 0.612_464_538_852_225),
        (model("davidson-side", "side_se"), 0.144_537_947_342_107_1),
        (worth(1, "davidson-side", "log_worth"), -0.655_057_598_087_322_6),
        (worth(11, "davidson-side", "log_worth"), 1.144_518_848_847_809_3),
        (worth(19, "davidson-side", "se"), 0.619_182_505_052_120_5),
        (model("davidson", "log_likelihood"), -359.137_176_148_086_8),
        (model("davidson", "ln_nu"), -0.161_574_708_630_048_7),
        (worth(19, "davidson", "log_worth"), -1.601_468_025_715_943),
    ] {
        near(got, want, 1e-6);
    }
    // The maximum itself, by 60 Newton steps in NumPy 2.4.6 on the probabilities written out.
    for (got, want) in [
        (worth(1, "davidson-side", "log_worth"), -0.655_057_649_373_044_7),
        (worth(19, "davidson-side", "log_worth"), -1.689_408_747_393_343_2),
        (model("davidson-side", "ln_nu"), -0.115_936_837_411_757_88),
        (model("davidson-side", "side"), 0.612_464_540_861_840_1),
    ] {
        near(got, want, 1e-11);
    }
    assert_eq!((model("davidson", "remark"), model("davidson", "penalised")), ("", "no"));
    // The file names no object, so that each match is one of its own: the probe cannot look, and the model can.
    let report = std::fs::read_to_string(out.join("report.md")).unwrap();
    assert!(!report.contains("no pair was seen in both orders of sides"), "{report}");
    for said in [
        "190 pairs were seen in both orders, but each order in a question or on an object of its own",
        "190 of 190 pairs were shown in both orders, so a bonus for the left side can be estimated",
        "Whatever stood there, the left side was favoured by 0.61 (0.35 to 0.87) log-odds",
    ] {
        assert!(report.contains(said), "{said}: {report}");
    }
}
