//! Simulates answers to a study and writes them as its own table: one row a respondent, one column a question.
//!
//! `cargo run --release -p isostudy-inference --example simulate -- configs/paper.toml 100000 answers.csv [SEED]`

use isostudy_design::Study;
use isostudy_statistics::Outcome;
use isostudy_statistics::simulation::{Plan, Population, Shown, simulate, stream};
use std::io::Write;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [study, respondents, out, rest @ ..] = arguments.as_slice() else {
        return Err("simulate STUDY.toml RESPONDENTS OUT.csv [SEED]".into());
    };
    let study = Study::load(study.as_ref())?;
    let seed = rest.first().map_or(Ok(1), |seed| seed.parse())?;
    let item = |method| study.place(method);
    let questions = study.comparisons.iter().map(|c| Shown {
        left: item(c.left.method),
        right: item(c.right.method),
        scene: c.object,
    });
    let plan = Plan { items: study.methods.len(), questions: questions.collect(), counterbalanced: false };
    // Some spread of worths, so that nothing is decided and nothing is void.
    let worths = (0..study.methods.len()).map(|i| 0.15 * i as f64).collect();
    let population = Population { worths, ..Population::indifferent(study.methods.len(), 1.0) };
    let ballots = simulate(&plan, &population, respondents.parse()?, &mut stream(seed, 0));
    let mut file = std::io::BufWriter::new(std::fs::File::create(out)?);
    let header: Vec<&str> = study.comparisons.iter().map(|c| c.question.as_str()).collect();
    writeln!(file, "{}", header.join(","))?;
    for row in ballots.chunk_by(|a, b| a.participant() == b.participant()) {
        let cell = |outcome| match outcome {
            Outcome::Left => "L",
            Outcome::Tie => "NP",
            Outcome::Right => "R",
        };
        let cells: Vec<&str> = row.iter().map(|ballot| cell(ballot.outcome())).collect();
        writeln!(file, "{}", cells.join(","))?;
    }
    Ok(file.flush()?)
}
