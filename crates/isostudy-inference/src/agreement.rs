//! Agreement of participants with each other and with themselves.

use isostudy_statistics::{
    Agreement as Kendall, Alpha, DeclaredBallot, Metric, Triads, agreement as kendall, alpha_with_interval,
    outcome_counts, triads, zetas,
};

/// How far people agree about some questions, and how far each agrees with himself.
#[derive(Debug, Clone)]
pub struct Agreement {
    /// The comparison group, by index; `None` is every question.
    pub group: Option<usize>,
    /// Questions with an answer.
    pub questions: usize,
    /// Krippendorff's alpha, with the three outcomes as names.
    pub nominal: Option<Alpha>,
    /// The same, with no preference between the two others.
    pub ordinal: Option<Alpha>,
    /// Kendall's u.
    pub kendall: Option<Kendall>,
    /// Triads within one object and group.
    pub triads: Triads,
    /// How many people decided every pair of an object and group.
    pub tournaments: u64,
    /// The sum of their zetas.
    pub zetas: f64,
}

impl Agreement {
    /// Of these answers; `scope` says by question which ones one person's triads may come from: one object and group.
    pub fn of(ballots: &[DeclaredBallot], group: Option<usize>, scope: impl Fn(usize) -> usize) -> Self {
        let counts = outcome_counts(ballots).into_iter().filter(|counts| counts.iter().sum::<u64>() > 0);
        let counts: Vec<[u64; 3]> = counts.collect();
        let [nominal, ordinal] =
            [Metric::Nominal, Metric::Ordinal].map(|metric| alpha_with_interval(ballots, metric));
        let mut scopes: Vec<Vec<DeclaredBallot>> = Vec::new();
        for ballot in ballots {
            let scope = scope(ballot.question());
            if scopes.len() <= scope {
                scopes.resize(scope + 1, Vec::new());
            }
            scopes[scope].push(*ballot);
        }
        let (mut all, mut tournaments, mut sum) = (Triads::default(), 0, 0.0);
        for own in &scopes {
            let (number, zetas) = zetas(own);
            (all, tournaments, sum) = (all.and(triads(own)), tournaments + number, sum + zetas);
        }
        Self {
            group,
            questions: counts.len(),
            nominal,
            ordinal,
            kendall: kendall(&counts),
            triads: all,
            tournaments,
            zetas: sum,
        }
    }
}
