use super::*;
use crate::fixture;
use isostudy_design::record::{BenchSample, Workload};

const ROUNDS: u32 = 30;
const PROCESSES: u32 = 3;

/// A run of the sphere's methods with these times.
fn run(model: &str, times: &[(&str, f64)]) -> BenchRun {
    let study = fixture::study();
    let mut run = fixture::bench(&study);
    let one = run.samples[0].clone();
    let block = |first_process: u32| -> Vec<BenchSample> {
        let rounds = (0..ROUNDS).flat_map(|iteration| {
            times
                .iter()
                .enumerate()
                .map(move |(place, (id, seconds))| (iteration, place as u32, *id, *seconds))
        });
        let sample = |(iteration, place, id, seconds): (u32, u32, &str, f64)| {
            let invocation = first_process + iteration * PROCESSES / ROUNDS;
            // Rounds differ by half a percent, and processes by two.
            let of_round = 0.0005 * f64::from((iteration * 7 + place * 3) % 11);
            let of_process = 0.01 * f64::from((invocation * 5 + place * 3) % 3);
            let geometry_s = seconds * (1.0 + of_round + of_process);
            BenchSample {
                id: id.parse().unwrap(),
                invocation,
                iteration,
                place,
                allocation_s: 0.0,
                sampling_s: 0.0,
                vertex_s: 0.0,
                geometry_s,
                normals_s: 0.0,
                total_s: geometry_s,
                reference_s: Some(0.01),
                ..one.clone()
            }
        };
        rounds.map(sample).collect()
    };
    run.samples = block(0);
    run.aa_samples = block(PROCESSES);
    (run.iterations, run.aa_iterations) = (ROUNDS, ROUNDS);
    run.memory = Vec::new();
    run.workloads =
        times.iter().map(|(id, _)| Workload { id: id.parse().unwrap(), digest: "same".into() }).collect();
    run.machine.model = Some(model.into());
    run
}

/// A machine's name and model, and its times.
type Planted<'a> = (&'a str, &'a str, &'a [(&'a str, f64)]);

fn found(machines: &[Planted<'_>]) -> Machines {
    Machines::of(machines.iter().map(|(name, model, times)| ((*name).into(), run(model, times))).collect())
}

fn agreement(of: &Machines, first: &str, second: &str) -> Agreement {
    let pair =
        of.pairs.iter().find(|pair| pair.first.to_string() == first && pair.second.to_string() == second);
    pair.unwrap().agreement
}

#[test]
fn planted_agreement_and_contradiction_come_out() {
    let of = found(&[
        ("old", "Old CPU", &[("ss_bi", 1.0), ("ss_bp", 1.2), ("ss_bu", 2.0), ("ss_su", 2.0)]),
        ("new", "New CPU", &[("ss_bi", 0.5), ("ss_bp", 0.4), ("ss_bu", 1.0), ("ss_su", 1.2)]),
    ]);
    assert_eq!(agreement(&of, "ss_bi", "ss_bp"), Agreement::Contradicted);
    assert_eq!(agreement(&of, "ss_bi", "ss_bu"), Agreement::Same);
    assert_eq!(agreement(&of, "ss_bu", "ss_su"), Agreement::OneTells);
    assert_eq!((of.count(Agreement::Contradicted), of.count(Agreement::Same)), (1, 4));
    let text = |ids: &[ConfigurationId]| ids.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    assert_eq!(of.fastest.len(), 1);
    assert_eq!(text(&of.fastest[0].on[0]), "ss_bi");
    assert_eq!(text(&of.fastest[0].on[1]), "ss_bp");
    assert_eq!(of.fastest[0].on_all, []);
    assert_eq!(of.alike, [] as [[usize; 2]; 0]);
    let tables = machine_tables(&of);
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(names, ["machines", "times_on_old", "times_on_new", "machine_fastest", "machine_agreement"]);
    // A contradiction stands first.
    assert!(tables[4].to_csv().lines().nth(1).unwrap().starts_with("ss_bi,ss_bp,"));
    // Each machine's times are its own: no row has both.
    assert!(!tables[1].to_csv().contains("400."));
}

#[test]
fn machines_of_one_kind_are_named() {
    let times: &[(&str, f64)] = &[("ss_bi", 1.0), ("ss_bp", 1.0)];
    let of = found(&[("a", "One CPU", times), ("b", "One CPU", times), ("c", "Another", times)]);
    assert_eq!(of.alike, [[0, 1]]);
    assert_eq!(agreement(&of, "ss_bi", "ss_bp"), Agreement::NoneTells);
    assert_eq!(of.fastest[0].on_all.len(), 2);
}

#[test]
fn what_one_machine_lacks_is_missing_there() {
    let of =
        found(&[("a", "One CPU", &[("ss_bi", 1.0), ("ss_bp", 1.2)]), ("b", "Another", &[("ss_bi", 1.0)])]);
    assert_eq!(of.pairs[0].on[1], None);
    assert_eq!(of.pairs[0].agreement, Agreement::OneTells);
}
