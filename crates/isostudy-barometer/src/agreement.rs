//! Whether two recordings say the same.

use crate::ranks::Ranking;

/// How two rankings of one quantity agree.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Agreement {
    /// Pairs that both distinguish, and in the same order.
    pub same: usize,
    /// Pairs that both distinguish, in opposite order: the better one by the first recording first.
    pub opposite: Vec<(String, String)>,
    /// Pairs that one of them distinguishes and the other does not.
    pub one_alone: usize,
}

impl Agreement {
    /// Compares rankings of the same quantity. Engines that one of them has not are left out.
    pub fn of(one: &Ranking, other: &Ranking) -> Self {
        let has = |ranking: &Ranking, engine: &str| ranking.standings.iter().any(|of| of.engine == engine);
        let both = |pair: &&(String, String)| {
            [&pair.0, &pair.1].iter().all(|engine| has(one, engine) && has(other, engine))
        };
        let turned = |pair: &(String, String)| (pair.1.clone(), pair.0.clone());
        let mut found = Self::default();
        for pair in one.told.iter().filter(both) {
            if other.told.contains(pair) {
                found.same += 1;
            } else if other.told.contains(&turned(pair)) {
                found.opposite.push(pair.clone());
            } else {
                found.one_alone += 1;
            }
        }
        let new = |pair: &&(String, String)| !one.told.contains(*pair) && !one.told.contains(&turned(pair));
        found.one_alone += other.told.iter().filter(both).filter(new).count();
        found
    }
}
