//! How often what is printed is right, counted over simulated studies that go through files: dealt forms, answers, a file,
//! every table.
//!
//! `cargo test --release --locked -p isostudy-oracle --lib coverage_through_files -- --ignored --nocapture` prints what
//! docs/self-test.md sums up; `STUDIES=3000` before it counts more closely.

use super::designs::{self, Design};
use super::people::{Given, Pressed, method, normal};
use super::routes::Route;
use crate::fixture;
use crate::tables;
use isostudy_design::Study;
use isostudy_design::forms::{KeyEntry, Questionnaire, Role};
use isostudy_design::record::{Distribution, MeshRecord, Purpose};
use isostudy_inference::answered::Answered;
use isostudy_inference::ballots::BallotGroup;
use isostudy_inference::self_test::allowance;
use isostudy_inference::{Inputs, Results};
use isostudy_responses::Plan;
use isostudy_statistics::{Outcome, ShownBallot};
use isostudy_table::{Cell, Table};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// Studies of each kind, unless `STUDIES` says another number.
fn studies() -> u64 {
    std::env::var("STUDIES").ok().and_then(|number| number.parse().ok()).unwrap_or(300)
}

/// People in them.
const SIZES: [usize; 4] = [12, 18, 60, 300];
/// People whose answers stand for what is true.
const MANY: usize = 20_000;

/// What is true of all people: Davidson's model, a tie in about five of equals, 0.8 logits between people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Truth {
    /// Nobody prefers a method or a side.
    Nothing,
    /// Clusterings and lattices differ, and the left side is liked.
    Worths,
    /// Round triangles are liked, whatever made them.
    Slope,
}

/// Log-odds for one standard deviation of the meshes' radius ratios.
const SLOPE: f64 = 0.5;

impl Truth {
    fn name(self) -> &'static str {
        match self {
            Self::Nothing => "no preference",
            Self::Worths => "worths and a side",
            Self::Slope => "a metric",
        }
    }

    /// Of an object and a method, in logits.
    fn worth(self, id: &str) -> f64 {
        let method = method(id);
        let place = |letters: &str, at: usize| letters.find(&method[at..=at]).expect("a letter") as f64;
        match self {
            Self::Nothing => 0.0,
            Self::Worths => 0.5 * place("upi", 1) + 0.3 * place("sb", 0),
            Self::Slope => SLOPE * measures(id)[0],
        }
    }

    /// What was measured, if anything: tables of it take their time.
    fn meshes(self, study: &Study) -> Vec<MeshRecord> {
        if self == Self::Slope { meshes(study) } else { Vec::new() }
    }

    fn side(self) -> f64 {
        match self {
            Self::Nothing | Self::Slope => 0.0,
            Self::Worths => 0.4,
        }
    }
}

/// Radius ratio, triangles and shading error of a mesh, in standard deviations of meshes: always the same ones.
fn measures(id: &str) -> [f64; 3] {
    let seed = id.bytes().fold(7, |sum: u64, byte| sum * 256 + u64::from(byte));
    let mut random = Pcg64::seed_from_u64(seed);
    [0; 3].map(|_| normal(&mut random))
}

/// Meshes as the study's, of which three things are known.
fn meshes(study: &Study) -> Vec<MeshRecord> {
    let any = fixture::meshes(&fixture::study()).swap_remove(0);
    let unknown = |of: &Distribution| Distribution { count: 0, ..of.clone() };
    let mesh = |configuration: &isostudy_design::Configuration| {
        let mut mesh = MeshRecord { id: configuration.id.clone(), purpose: Purpose::Stimulus, ..any.clone() };
        let [ratio, triangles, error] = measures(&configuration.id.to_string());
        mesh.quality.radius_ratio.mean = 0.6 + 0.05 * ratio;
        mesh.counts.triangles = (1e6 * (0.3 * triangles).exp()) as u64;
        mesh.accuracy.normal_error_deg.mean = 2.0 * (0.3 * error).exp();
        mesh.quality.min_angle_deg = unknown(&mesh.quality.min_angle_deg);
        mesh.quality.published_aspect_ratio = unknown(&mesh.quality.published_aspect_ratio);
        mesh.accuracy.distance = unknown(&mesh.accuracy.distance);
        mesh
    };
    study.configurations.iter().map(mesh).collect()
}

/// What so many people answer; each form has one more person than it is the turn of.
fn answers(forms: &[Vec<KeyEntry>], truth: Truth, people: usize, study: u64) -> Vec<Given> {
    let mut given = Vec::new();
    for person in 0..people {
        let mut random = Pcg64::seed_from_u64((truth as u64) << 60 | study << 24 | person as u64);
        let mut own: BTreeMap<&str, f64> = BTreeMap::new();
        for shown in &forms[person % forms.len()] {
            let mut liked = |id| {
                let own = *own.entry(method(id)).or_insert_with(|| 0.8 * normal(&mut random));
                truth.worth(id) + own
            };
            let half = (0.5 * (liked(&shown.left) - liked(&shown.right) + truth.side())).exp();
            let weights = [half, 0.5, 1.0 / half];
            let at = random.random::<f64>() * weights.iter().sum::<f64>();
            let pressed = match at {
                _ if shown.role == Role::Control && random.random_bool(0.9) => Pressed::Neither,
                at if at < weights[0] => Pressed::Left,
                at if at < weights[0] + weights[1] => Pressed::Neither,
                _ => Pressed::Right,
            };
            let rt_ms = 2500 + random.random_range(0..4000);
            given.push(Given { person, shown: shown.clone(), pressed, rt_ms });
        }
    }
    given
}

/// Everything that is printed of the answers, and the groups that models compare.
fn printed(
    (study, meshes): (&Study, &[MeshRecord]),
    plan: &Plan,
    given: &[Given],
    route: Route,
) -> (Vec<Table>, Vec<BallotGroup>) {
    let read = route.read(study, plan, given).expect("a file that is right");
    let answered = Answered::of(study, read).expect("answers to the study's questions");
    (
        tables(&Results::of(&Inputs {
            study,
            meshes,
            bench: None,
            chunks: &[],
            stored: &[],
            answers: Some(&answered),
            left_out: &[],
        })),
        answered.groups,
    )
}

/// A number's place: table, column, and the names at the head of its row.
type Place = (String, String, String);

/// The rows of a table with what they are called.
fn rows(table: &Table) -> impl Iterator<Item = (String, &Vec<Cell>)> {
    let name = |row: &Vec<Cell>| {
        let words = row.iter().map_while(|cell| match cell {
            Cell::Text(text) => Some(text.as_str()),
            _ => None,
        });
        words.collect::<Vec<_>>().join(" ")
    };
    table.rows.iter().map(move |row| (name(row), row))
}

fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(value, _) | Cell::P(value, _) => Some(*value),
        Cell::Count(count) => Some(*count as f64),
        _ => None,
    }
}

/// Where an interval stands in a table.
struct Ends {
    column: String,
    /// What it is about.
    estimate: usize,
    low: usize,
    high: usize,
}

/// Intervals of a table: columns `low` and `high` follow their estimate, or name it.
fn intervals(table: &Table) -> Vec<Ends> {
    let place = |name: &str| table.columns.iter().position(|column| column.name == name);
    let mut found = Vec::new();
    for (at, column) in table.columns.iter().enumerate() {
        let Some(of) = column.name.strip_suffix("low") else { continue };
        let estimate = match of {
            // Not an interval of anything: the range over people left out.
            "p_without_one_" => continue,
            "studentised_" => place("mean"),
            "" if table.name == "worths" => place("log_worth"),
            "" if table.name == "prediction_joint" => place("coefficient"),
            "" => Some(at - 1),
            of => place(of.trim_end_matches('_')),
        };
        let high = place(&format!("{of}high")).expect("an upper end");
        let estimate = estimate.expect("an estimate");
        found.push(Ends { column: column.name.clone(), estimate, low: at, high });
    }
    found
}

/// What is counted of one study.
#[derive(Default)]
struct Seen {
    intervals: Vec<(Place, [f64; 2])>,
    p: Vec<(Place, f64)>,
    found: Vec<String>,
    /// Models with a penalty, and those of them whose items are not separated.
    penalised: [u64; 2],
}

/// Whether some items never won against the others and never tied with them, or everybody who was compared was always
/// preferred or always tied: tried for every set of items.
fn separated(group: &BallotGroup) -> bool {
    let items = group.items.len();
    let holds = |of: &dyn Fn(&ShownBallot) -> bool| group.ballots.iter().all(of);
    let above = |set: u32| {
        move |b: &ShownBallot| {
            let [left, right] = [b.left(), b.right()].map(|item| set >> item & 1);
            left == right || b.outcome() == if left > right { Outcome::Left } else { Outcome::Right }
        }
    };
    let cut = (1..(1_u32 << items) - 1).any(|set| holds(&above(set)));
    // A whole-number potential that falls by one or more over each win and moves by at most one over each tie.
    let levels = items as u32;
    let potential = |code: u32, item: usize| (code / levels.pow(item as u32) % levels) as i32;
    let rises = (0..levels.pow(levels)).any(|code| {
        holds(&|b| {
            let fall = potential(code, b.left()) - potential(code, b.right());
            match b.outcome() {
                Outcome::Left => fall >= 1,
                Outcome::Tie => fall.abs() <= 1,
                Outcome::Right => fall <= -1,
            }
        })
    });
    cut || rises
}

fn seen((tables, groups): &(Vec<Table>, Vec<BallotGroup>)) -> Seen {
    let mut seen = Seen::default();
    for table in tables {
        let ends = intervals(table);
        for (name, row) in rows(table) {
            let place = |column: &str| (table.name.clone(), column.to_owned(), name.clone());
            for Ends { column, low, high, .. } in &ends {
                if let (Some(low), Some(high)) = (number(&row[*low]), number(&row[*high])) {
                    seen.intervals.push((place(column), [low, high]));
                }
            }
            for (column, cell) in table.columns.iter().zip(row) {
                match cell {
                    Cell::P(p, _) if !column.name.starts_with("p_without") => {
                        seen.p.push((place(&column.name), *p));
                    }
                    Cell::Text(text) if column.name == "penalised" && text == "yes" => {
                        let group = groups.iter().find(|group| name.split(' ').next() == Some(&group.name));
                        // A liking for a side may be without bound where items are not.
                        let right = name.contains("side") || separated(group.expect("a group of this name"));
                        seen.penalised = [seen.penalised[0] + 1, seen.penalised[1] + u64::from(!right)];
                    }
                    Cell::Text(text) if column.name == "finding" && text == "found" => {
                        seen.found.push(name.split(' ').next().unwrap_or_default().to_owned());
                    }
                    _ => {}
                }
            }
        }
    }
    seen
}

/// What is true of every interval's estimate.
fn estimates(tables: &[Table]) -> BTreeMap<Place, f64> {
    let mut all = BTreeMap::new();
    for table in tables {
        let ends = intervals(table);
        for (name, row) in rows(table) {
            for Ends { column, estimate, .. } in &ends {
                let place = (table.name.clone(), column.clone(), name.clone());
                all.extend(number(&row[*estimate]).map(|value| (place, value)));
            }
        }
    }
    all
}

/// Hits of tries.
type Share = [u64; 2];

fn share([hits, tries]: Share) -> f64 {
    hits as f64 / tries as f64
}

fn count(all: &mut BTreeMap<(String, String), BTreeMap<String, Share>>, of: &Place, hit: bool) {
    let (table, column, row) = of.clone();
    let own = all.entry((table, column)).or_default().entry(row).or_default();
    *own = [own[0] + u64::from(hit), own[1] + 1];
}

/// One line for each column: its share over all rows, which comes back, and the row that is furthest from where it should be:
/// below 95 % of intervals, above 5 % of rejections.
fn print(
    head: &str,
    what: &str,
    all: BTreeMap<(String, String), BTreeMap<String, Share>>,
    least: bool,
) -> BTreeMap<String, f64> {
    let mut shares = BTreeMap::new();
    for ((table, column), rows) in all {
        let sum = rows.values().fold([0, 0], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        let mut by_share: Vec<(&String, Share)> =
            rows.iter().map(|(row, own)| (row, *own)).filter(|(_, own)| own[1] >= studies() / 2).collect();
        by_share.sort_by(|a, b| share(a.1).total_cmp(&share(b.1)));
        let worst = if least { by_share.first() } else { by_share.last() };
        let worst = worst.map_or("none".into(), |(row, own)| format!("{:.3} | {row}", share(*own)));
        println!("{head} | {what} | {table}.{column} | {} rows | {:.4} | {worst}", rows.len(), share(sum));
        shares.insert(format!("{table}.{column}"), share(sum));
    }
    shares
}

#[test]
#[ignore = "minutes: run by make test-long; prints tables"]
fn coverage_through_files_with_meshes() {
    for design in [designs::FULL, designs::BLOCKS] {
        one(&design, Truth::Slope);
    }
}

#[test]
#[ignore = "minutes: run by make test-long; prints tables"]
fn coverage_through_files() {
    for design in [designs::FULL, designs::BLOCKS] {
        for truth in [Truth::Nothing, Truth::Worths] {
            one(&design, truth);
        }
    }
}

/// What comes of every study, on several threads: each has a pool to itself, since what waits in a shared one takes up the next
/// study, and that one's wait another, until the stack is full.
fn each_alone(of: impl Fn(u64) -> Seen + Sync) -> Vec<Seen> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let some = |first: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        pool.install(|| (first..studies()).step_by(threads as usize).map(&of).collect::<Vec<_>>())
    };
    std::thread::scope(|scope| {
        let all: Vec<_> = (0..threads).map(|first| scope.spawn(move || some(first))).collect();
        all.into_iter().flat_map(|own| own.join().expect("no panic")).collect()
    })
}

fn one(design: &Design, truth: Truth) {
    let study = design.study(300);
    let (plan, meshes) = (Plan::of_study(&study), truth.meshes(&study));
    let key = Questionnaire::of(&study).expect("it plans forms").key();
    let asked = |of: &[KeyEntry]| of.iter().filter(|entry| entry.role != Role::Training).cloned().collect();
    let forms: Vec<Vec<KeyEntry>> = key.chunk_by(|a, b| a.form == b.form).map(asked).collect();
    let many = answers(&forms, truth, MANY, u64::from(u16::MAX));
    let is = estimates(&printed((&study, &meshes), &plan, &many, Route::Long).0);
    for people in SIZES {
        let route = |number: u64| [Route::Long, Route::ByForm, Route::Wide][(number % 3) as usize];
        let all = each_alone(|number| {
            let given = answers(&forms, truth, people, number * 1000 + people as u64);
            seen(&printed((&study, &meshes), &plan, &given, route(number)))
        });
        let head = format!("{} | {} | {people}", design.name, truth.name());
        let (mut covered, mut rejected) = (BTreeMap::new(), BTreeMap::new());
        let (mut any, mut found) = (BTreeMap::new(), BTreeMap::<String, u64>::new());
        for seen in &all {
            for (place, [low, high]) in &seen.intervals {
                let Some(is) = is.get(place) else { continue };
                count(&mut covered, place, low <= is && is <= high);
            }
            let mut least: BTreeMap<Place, f64> = BTreeMap::new();
            for (place, p) in &seen.p {
                count(&mut rejected, place, *p <= 0.05);
                let family = match place.0.as_str() {
                    "tests" if !place.1.contains("over_all") => place.2.split(' ').next().unwrap_or_default(),
                    "differences" => place.2.split(' ').next().unwrap_or_default(),
                    _ => "all",
                };
                let least = least.entry((place.0.clone(), place.1.clone(), family.into())).or_insert(1.0);
                *least = least.min(*p);
            }
            least.iter().for_each(|(place, p)| count(&mut any, place, *p <= 0.05));
            seen.found.iter().for_each(|probe| *found.entry(probe.clone()).or_default() += 1);
        }
        // A question is asked of all people or of a third.
        let enough = design.name == designs::FULL.name || people >= 60;
        for (column, share) in print(&head, "covered", covered, true) {
            // Of few metrics there are few rows, which hang together.
            let of_few = if column.starts_with("prediction") { allowance(0.95, studies()) } else { 0.0 };
            let near = (share - 0.95).abs() <= of_few.max(0.02);
            assert!(near || !enough, "{head}: {column} covers {share}");
        }
        if truth == Truth::Nothing {
            print(&head, "rejected", rejected, false);
            let any = print(&head, "any rejected", any, false);
            for column in ["tests.p_adjusted", "tests.p_adjusted_over_all", "differences.p_adjusted"] {
                let most = 0.05 + allowance(0.05, studies());
                assert!(any[column] <= most, "{head}: {column} rejects {}", any[column]);
            }
        }
        let [penalised, wrong] = [0, 1].map(|of| all.iter().map(|seen| seen.penalised[of]).sum::<u64>());
        println!("{head} | models penalised | {penalised} in {} studies, {wrong} of them wrongly", studies());
        println!("{head} | probes | {found:?}");
        assert_eq!(wrong, 0, "{head}: penalised without need");
        // Of a side there is one in the second truth, few people's items are separated in blocks, and methods whose meshes differ
        // from object to object are liked on one and not on another.
        let is_true = |probe: &str| match probe {
            "side" | "separation" => true,
            "object-interaction" => truth == Truth::Slope,
            _ => false,
        };
        for (probe, found) in found.iter().filter(|(probe, _)| !is_true(probe)) {
            assert!(*found as f64 <= 0.02 * studies() as f64, "{head}: {probe} speaks up in {found}");
        }
    }
}
