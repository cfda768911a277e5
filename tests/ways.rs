//! A study of each way to ask, from its file to its report, on simulated people whose truth is planted.

use crate::command::{Run, isostudy};
use crate::fixture::Fixture;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Log worths of the methods, `bu` being the reference of every group.
const WORTHS: [(&str, f64); 6] =
    [("bu", 0.0), ("bi", 1.3), ("bp", 0.6), ("su", -0.7), ("si", 0.9), ("sp", 0.2)];

fn worth(method: &str) -> f64 {
    WORTHS.into_iter().find(|(id, _)| *id == method).unwrap().1
}

/// SplitMix64 (Steele, Lea and Flood 2014), as numbers from 0 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// One of these, by its weight.
    fn one_of<T: Copy>(&mut self, weighted: &[(T, f64)]) -> T {
        let mut left = self.next() * weighted.iter().map(|(_, weight)| weight).sum::<f64>();
        for &(one, weight) in weighted {
            left -= weight;
            if left < 0.0 {
                return one;
            }
        }
        weighted[weighted.len() - 1].0
    }
}

/// Rows of a CSV without quoted cells, by their columns.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let header: Vec<String> = lines.next().unwrap().collect();
    lines.map(|cells| header.iter().cloned().zip(cells).collect()).collect()
}

/// The quick study asked in a way, and bundled.
fn bundled(way: &str) -> Fixture {
    let fixture = Fixture::balanced();
    // What is shown one at a time, or several at once, has no controls.
    if !["forced", "graded"].iter().any(|of| way.contains(of)) {
        fixture.edit("controls = 2", "controls = 0");
    }
    fixture.edit_with(|text| {
        let choices = text.lines().find(|line| line.starts_with("choices = ")).unwrap();
        text.replacen(choices, way, 1)
    });
    // A design with faults is not bundled.
    fixture.succeed("bundle", &[]);
    fixture
}

/// What the page would give to download, of everybody whom the study plans: `says` answers what a line of the key shows.
fn downloads(fixture: &Fixture, mut says: impl FnMut(&BTreeMap<String, String>) -> String) {
    let text = |name: &str| std::fs::read_to_string(fixture.out().join(name)).unwrap();
    let file: Value = serde_json::from_str(&text("bundle/forms.json")).unwrap();
    let key = rows(&text("key/forms.csv"));
    let places: BTreeMap<[&str; 2], &BTreeMap<String, String>> =
        key.iter().map(|line| ([line["form"].as_str(), line["order"].as_str()], line)).collect();
    let folder = fixture.folder().join("downloads");
    std::fs::create_dir(&folder).unwrap();
    for form in file["forms"].as_array().unwrap() {
        let number = form["form"].to_string();
        let practice = form["training"].as_array().unwrap().len();
        let mut csv = "participant,form,order,stimulus,choice,rt_ms,answered\r\n".to_owned();
        for (place, stimulus) in form["questions"].as_array().unwrap().iter().enumerate() {
            let order = (practice + place + 1).to_string();
            let stimulus = stimulus.as_str().unwrap();
            let line = places[&[number.as_str(), order.as_str()]];
            assert_eq!(line["stimulus"], stimulus);
            let choice = says(line);
            csv += &format!(
                "person{number:0>3},{number},{order},{stimulus},{choice},9000,2026-11-27T10:00:00Z\r\n"
            );
        }
        std::fs::write(folder.join(format!("{number}.csv")), csv).unwrap();
    }
}

/// Collects and analyses what people downloaded.
fn analysed(fixture: &Fixture) -> String {
    let answers = fixture.folder().join("answers.csv");
    let mut collect = isostudy();
    collect.arg("collect").arg(fixture.config()).arg(fixture.folder().join("downloads"));
    Run::succeed(collect.arg("--out").arg(&answers));
    fixture.succeed("analyse", &["--responses", answers.to_str().unwrap()]);
    std::fs::read_to_string(fixture.out().join("report.md")).unwrap()
}

fn table(out: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    rows(&std::fs::read_to_string(out.join(format!("tables/{name}.csv"))).unwrap())
}

/// Worths of all methods by a model, in a table: the planted ones are within their intervals, and stand in their order where they are
/// 0.6 apart.
fn come_out(found: &[BTreeMap<String, String>], model: &str, value: &str) {
    let mut own: Vec<&BTreeMap<String, String>> =
        found.iter().filter(|row| row["group"] == "all" && row["model"] == model).collect();
    assert_eq!(own.len(), WORTHS.len(), "{found:?}");
    for row in own.iter().filter(|row| row["item"] != "bu") {
        let number = |column: &str| row[column].replace('\u{2212}', "-").parse::<f64>().unwrap();
        let truth = worth(&row["item"]);
        assert!((number("low")..=number("high")).contains(&truth), "{truth}: {row:?}");
    }
    let at = |row: &BTreeMap<String, String>| row[value].parse::<f64>().unwrap();
    own.sort_by(|a, b| at(b).total_cmp(&at(a)));
    for two in own.windows(2) {
        let [upper, lower] = [two[0], two[1]].map(|row| worth(&row["item"]));
        assert!(upper > lower - 0.45, "{:?}", own.iter().map(|row| &row["item"]).collect::<Vec<_>>());
    }
}

/// Methods on the left and right of a line of the key.
fn sides(line: &BTreeMap<String, String>) -> [&str; 2] {
    ["left", "right"].map(|side| line[side].split_once('_').unwrap().1)
}

#[test]
fn who_must_choose_chooses_by_the_planted_worths() {
    let fixture = bundled("way = \"forced\"");
    let mut chance = Chance(3);
    downloads(&fixture, |line| {
        let [left, right] = sides(line).map(|method| worth(method).exp());
        chance.one_of(&[("L", left), ("R", right)]).into()
    });
    let report = analysed(&fixture);
    come_out(&table(fixture.out(), "worths"), "davidson", "log_worth");
    for said in [
        "They had to choose one of the two",
        "bi stands highest",
        // Nobody guesses who decides a control.
        "of 36 participants broke a rule of screening",
    ] {
        assert!(report.contains(said), "{said}: {report}");
    }
    assert!(!report.contains("deciding between equals"), "{report}");
    assert!(table(fixture.out(), "respondents").iter().all(|row| !row["flags"].contains("controls")));

    // What is no answer is refused where it stands, before anything is written.
    let first = fixture.folder().join("downloads/1.csv");
    let text = std::fs::read_to_string(&first).unwrap();
    std::fs::write(&first, text.replacen(",L,", ",NP,", 1)).unwrap();
    let out = fixture.folder().join("refused.csv");
    let mut collect = isostudy();
    let run = Run::of(collect.arg("collect").arg(fixture.config()).arg(&first).arg("--out").arg(&out));
    assert!(run.code == Some(2) && run.stderr.contains("choice = NP: allowed: L, R"), "{}", run.stderr);
    assert!(!out.exists());
    let answers = fixture.folder().join("answers.csv");
    let text = std::fs::read_to_string(&answers).unwrap();
    std::fs::write(&answers, text.replacen(",L,", ",NP,", 1)).unwrap();
    let run = fixture.run("analyse", &["--responses", answers.to_str().unwrap()]);
    assert!(run.code == Some(2) && run.stderr.contains("\"NP\" is not an answer"), "{}", run.stderr);
}

#[test]
fn five_steps_give_the_planted_worths_and_all_that_pairs_give() {
    let fixture = bundled("way = \"graded\"");
    let mut chance = Chance(11);
    // The model of adjacent categories.
    downloads(&fixture, |line| {
        let [left, right] = sides(line).map(worth);
        let weights =
            [("LL", 2.0, 0.6), ("L", 1.0, 1.0), ("NP", 0.0, 0.7), ("R", -1.0, 1.0), ("RR", -2.0, 0.6)];
        let weighted =
            weights.map(|(code, step, weight)| (code, weight * (0.5 * step * (left - right)).exp()));
        chance.one_of(&weighted).into()
    });
    let report = analysed(&fixture);
    let ways = table(fixture.out(), "ways");
    come_out(&ways, "adjacent-steps", "worth");
    assert_eq!(ways.iter().filter(|row| row["group"] == "all").count(), 2 * WORTHS.len());
    for said in
        ["They answered in five steps", "By the model of five steps the worths are, highest first: bi 1."]
    {
        assert!(report.contains(said), "{said}: {report}");
    }
    // Steps folded into left, none and right.
    let counts = table(fixture.out(), "answer_counts");
    assert_eq!(counts.len(), 27);
    assert!(counts.iter().all(|row| row["no_preference"] != "36") && report.contains("stands highest"));
    assert!(table(fixture.out(), "tests").iter().filter(|row| !row["p_sign_flip"].is_empty()).count() > 27);
    let answers = std::fs::read_to_string(fixture.folder().join("answers.csv")).unwrap();
    assert!(answers.contains(",LL,") && answers.contains(",RR,"));
    let shown = std::fs::read_to_string(fixture.out().join("tables/answers.csv")).unwrap();
    assert!(shown.contains("RR") && shown.contains("LL"));

    // A study of pairs has no such answers.
    fixture.edit("way = \"graded\"", "choices = [\"Left\", \"No preference\", \"Right\"]");
    let answers = fixture.folder().join("answers.csv");
    let run = fixture.run("analyse", &["--responses", answers.to_str().unwrap()]);
    assert!(run.code == Some(2) && run.stderr.contains("is not an answer"), "{}", run.stderr);
}

/// The methods that a line of the key shows.
fn shown(line: &BTreeMap<String, String>) -> Vec<&str> {
    line["shown"].split(' ').map(|id| id.split_once('_').unwrap().1).collect()
}

/// People with levels of their own rate what they see: a step for each log-odds, around the middle of nine steps.
#[test]
fn ratings_have_the_planted_means() {
    let fixture = bundled("way = \"ratings\"\nsteps = 9\nends = [\"awful\", \"splendid\"]");
    let mut chance = Chance(5);
    let mut levels: BTreeMap<String, f64> = BTreeMap::new();
    downloads(&fixture, |line| {
        let level = *levels.entry(line["form"].clone()).or_insert_with(|| chance.next() - 0.5);
        let [method] = shown(line)[..] else { panic!("{line:?}") };
        // The sum of three is near normal, with a deviation of one half.
        let rest = (0..3).map(|_| chance.next() - 0.5).sum::<f64>();
        (5.0 + level + worth(method) + rest).round().clamp(1.0, 9.0).to_string()
    });
    let report = analysed(&fixture);
    let ways = table(fixture.out(), "ways");
    come_out(&ways, "ratings", "worth");
    for said in [
        "They rated one surface at a time, from 1 to 9.",
        "By the model of ratings of 648 answers in group all the worths are, highest first: bi 1.",
        "Asked again, people gave the same rating in",
        "bi stands highest",
        "Nobody compared a left side with a right one.",
    ] {
        assert!(report.contains(said), "{said}: {report}");
    }
    // A form shows each configuration once, and some again; the page is told nothing of them.
    let forms = std::fs::read_to_string(fixture.out().join("bundle/forms.json")).unwrap();
    assert!(forms.contains("\"ratings\"") && forms.contains("splendid") && !forms.contains("ss_"), "{forms}");
    let key = std::fs::read_to_string(fixture.out().join("key/forms.csv")).unwrap();
    assert!(key.starts_with("form,order,stimulus,role,question,object,group,shown\n"), "{key}");
    let sizes: Vec<u64> = std::fs::read_dir(fixture.out().join("bundle/stimuli"))
        .unwrap()
        .map(|entry| entry.unwrap().metadata().unwrap().len())
        .collect();
    assert!(sizes.len() == 18 && sizes.iter().all(|size| *size == sizes[0]), "{sizes:?}");
    let mut check = isostudy();
    let run = Run::of(check.args(["design", "check"]).arg(fixture.config()));
    assert!(run.code == Some(0) && run.stdout.ends_with(": no faults\n"), "{}{}", run.stdout, run.stderr);
}

/// What is taken of several has the chances of Luce's model; now and then none is.
#[test]
fn the_best_of_several_gives_the_planted_worths() {
    for (way, places, seed) in [("best-of-3", 3, 21), ("best-of-4", 4, 22)] {
        let fixture = bundled(&format!("way = \"{way}\"\nnone = true"));
        let mut chance = Chance(seed);
        downloads(&fixture, |line| {
            let methods = shown(line);
            assert_eq!(methods.len(), places);
            let mut weighted: Vec<(usize, f64)> =
                methods.iter().enumerate().map(|(i, method)| (i + 1, worth(method).exp())).collect();
            weighted.push((0, 0.3));
            match chance.one_of(&weighted) {
                0 => "NP".into(),
                place => place.to_string(),
            }
        });
        let report = analysed(&fixture);
        come_out(&table(fixture.out(), "ways"), "first-choice", "worth");
        for said in [
            format!("They took the best of {places} surfaces that turned at once, or none of them."),
            "By the model of the best of several of".into(),
            "Asked again with other places, people took the same in".into(),
            "none was taken. These say nothing of two".into(),
        ] {
            assert!(report.contains(&said), "{said}: {report}");
        }
        let run = fixture.run("bundle", &[]);
        assert_eq!(run.code, Some(0), "{}", run.stderr);
    }
    // Two methods are no three.
    let fixture = Fixture::balanced();
    fixture.edit("controls = 2", "controls = 0");
    fixture.edit("[forms]", "[forms]\nway = \"best-of-3\"");
    fixture.edit("choices = [\"Left\", \"No preference\", \"Right\"]\n", "");
    fixture.edit_with(|text| {
        let kept = |line: &&str| !line.contains("question = \"Q") || line.contains("\"Q1\"");
        text.lines().filter(kept).map(|line| format!("{line}\n")).collect()
    });
    let mut check = isostudy();
    let run = Run::of(check.args(["design", "check"]).arg(fixture.config()));
    assert!(run.code == Some(2) && run.stderr.contains("forms.way = best-of-3"), "{}", run.stderr);
}

/// What is asked is what is simulated.
#[test]
fn power_is_that_of_the_studys_way() {
    let fixture = Fixture::balanced();
    fixture.edit("[forms]", "[forms]\nway = \"forced\"");
    fixture.edit("choices = [\"Left\", \"No preference\", \"Right\"]", "choices = [\"A\", \"B\"]");
    let said = |more: &[&str]| {
        let mut command = isostudy();
        command.args(["design", "power", "--studies", "100", "--participants", "12", "--out"]);
        Run::succeed(command.arg(fixture.folder().join("power")).arg(fixture.config()).args(more)).stdout
    };
    let own = said(&[]);
    assert!(own == said(&["--way", "forced"]) && own != said(&["--way", "pairs"]), "{own}");
    fixture.edit("choices = [\"A\", \"B\"]", "choices = [\"A\", \"B\", \"C\"]");
    let mut command = isostudy();
    let run = Run::of(command.args(["design", "check"]).arg(fixture.config()));
    assert!(run.code == Some(2) && run.stderr.contains("must be 2 texts"), "{}", run.stderr);
}
