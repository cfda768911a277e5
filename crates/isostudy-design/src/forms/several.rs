//! What is asked where people do not compare pairs: surfaces one at a time, or several at once.

use super::{Block, REPEATS, Role, SETS, Trial, again, random, spread};
use crate::config::{FormsSection, TrainingSection, Way};
use crate::method::ConfigurationId;
use crate::study::Study;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// The configurations of the comparisons on each object, in the study's order: places in its configurations.
fn compared(study: &Study) -> Vec<Vec<usize>> {
    let is_compared =
        |id: &ConfigurationId| study.comparisons.iter().any(|c| c.left == *id || c.right == *id);
    let mut objects = vec![Vec::new(); study.file.objects.len()];
    for (place, configuration) in study.configurations.iter().enumerate() {
        if is_compared(&configuration.id) {
            objects[configuration.object].push(place);
        }
    }
    objects.retain(|own: &Vec<usize>| !own.is_empty());
    objects
}

/// How many configurations the comparisons have on the object with the fewest, and on which.
pub(crate) fn fewest(study: &Study) -> Option<(usize, usize)> {
    let objects = compared(study);
    let least = objects.iter().min_by_key(|own| own.len())?;
    Some((least.len(), study.configurations[least[0]].object))
}

/// How many questions there are to ask of everybody together, repeats left out.
pub(crate) fn count(study: &Study, way: Way) -> usize {
    compared(study).iter().map(|own| sets(own.len(), way.shown())).sum()
}

/// How many sets of so many of an object's methods are asked about: each method is in as many, and each two could be together in
/// one; all of them if there are no more.
fn sets(methods: usize, size: usize) -> usize {
    let all = (0..size).fold(1, |all, i| all * (methods - i) / (i + 1));
    let step = methods / common(methods, size);
    let pairs = |size: usize| size * (size - 1) / 2;
    let enough = match pairs(size) {
        0 => methods,
        in_one => pairs(methods).div_ceil(in_one),
    };
    (enough.div_ceil(step) * step).min(all)
}

/// The greatest common divisor.
fn common(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common(b, a % b) }
}

/// All choices of so many of the numbers below `count`, each ascending.
fn choices(count: usize, size: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..size {
        let longer = |of: &Vec<usize>| {
            let of = of.clone();
            (of.last().map_or(0, |last| last + 1)..count).map(move |next| [&of[..], &[next]].concat())
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

/// What each block asks. Sets are chosen such that methods, and then pairs of methods, are as even as a search finds; then blocks are
/// dealt in turn, each object beginning with another block.
pub(super) fn blocks(study: &Study, section: &FormsSection) -> Vec<Block> {
    let objects = compared(study);
    let (size, seed) = (section.way.shown(), study.file.study.seed);
    let of_object = |(object, own): (usize, &Vec<usize>)| -> Vec<Vec<usize>> {
        let all = choices(own.len(), size);
        let wanted = sets(own.len(), size);
        let chosen: Vec<usize> = match wanted < all.len() {
            false => (0..all.len()).collect(),
            true => even(&all, wanted, own.len(), &mut random(seed, &[SETS, object])),
        };
        chosen.into_iter().map(|i| all[i].iter().map(|&place| own[place]).collect()).collect()
    };
    let asked: Vec<Vec<Vec<usize>>> = objects.iter().enumerate().map(of_object).collect();
    // In turn over objects, so that no block is of one object alone.
    let longest = asked.iter().map(Vec::len).max().unwrap_or(0);
    let mut order: Vec<&Vec<usize>> = Vec::new();
    for round in 0..longest {
        order.extend((0..asked.len()).filter_map(|i| asked[(i + round) % asked.len()].get(round)));
    }
    let name = if section.way == Way::Ratings { "rating" } else { "set" };
    let trial = |(number, set): (usize, &&Vec<usize>)| Trial {
        role: Role::Comparison,
        question: format!("{name}-{}", number + 1),
        comparison: None,
        shown: set.iter().map(|&place| study.configurations[place].id.clone()).collect(),
    };
    let trials: Vec<Trial> = order.iter().enumerate().map(trial).collect();
    let room = (section.max_questions - section.repeats) as usize;
    let count = trials.len().div_ceil(room);
    let split: Vec<Vec<Trial>> =
        (0..count).map(|block| trials.iter().skip(block).step_by(count).cloned().collect()).collect();
    let repeated = repeated(study, section.repeats as usize, &split, seed);
    split
        .into_iter()
        .zip(repeated)
        .map(|(comparisons, repeated)| {
            let repeats = repeated.into_iter().map(|place| again(&comparisons[place])).collect();
            Block { comparisons, repeats, controls: Vec::new() }
        })
        .collect()
}

/// Choices from which a search begins, and exchanges that are tried from each.
const BEGINNINGS: usize = 40;
const EXCHANGES: usize = 1000;

/// So many of the sets, such that methods, and then pairs of methods, are in them as evenly as a search finds: from the first ones, sets are
/// exchanged at random, as long as that is not worse. Even is a small sum of squares.
fn even(all: &[Vec<usize>], wanted: usize, methods: usize, random: &mut Pcg64) -> Vec<usize> {
    let squares = |chosen: &[usize]| -> [usize; 2] {
        let (mut of, mut pairs) = (vec![0; methods], vec![0; methods * methods]);
        for set in chosen.iter().map(|&i| &all[i]) {
            for (place, &one) in set.iter().enumerate() {
                of[one] += 1;
                set[place + 1..].iter().for_each(|&other| pairs[one * methods + other] += 1);
            }
        }
        [of, pairs].map(|counts| counts.iter().map(|n: &usize| n * n).sum())
    };
    let mut order: Vec<usize> = (0..all.len()).collect();
    let mut best: Option<([usize; 2], Vec<usize>)> = None;
    for _ in 0..BEGINNINGS {
        order.shuffle(random);
        let mut least = squares(&order[..wanted]);
        for _ in 0..EXCHANGES {
            let (one, other) = (random.random_range(0..wanted), random.random_range(wanted..all.len()));
            order.swap(one, other);
            let found = squares(&order[..wanted]);
            if found > least {
                order.swap(one, other);
            } else {
                least = found;
            }
        }
        if best.as_ref().is_none_or(|(squares, _)| least < *squares) {
            best = Some((least, order[..wanted].to_vec()));
        }
    }
    let mut chosen = best.map_or_else(Vec::new, |(_, chosen)| chosen);
    chosen.sort_unstable();
    chosen
}

/// Which of each block's questions are repeated: configurations as evenly as can be, then methods, then objects.
fn repeated(study: &Study, count: usize, split: &[Vec<Trial>], seed: u64) -> Vec<Vec<usize>> {
    let methods = study.methods.len();
    let labels = |trial: &Trial| {
        let place = |id: &ConfigurationId| study.configurations.iter().position(|c| c.id == *id);
        let places: Vec<usize> = trial.shown.iter().filter_map(place).collect();
        let own = places.iter().map(|place| place % methods).collect();
        let object = places.iter().take(1).map(|&place| study.configurations[place].object).collect();
        vec![places, own, object]
    };
    let pools: Vec<Vec<spread::Labels>> =
        split.iter().map(|trials| trials.iter().map(labels).collect()).collect();
    let sizes = [study.configurations.len(), methods, study.file.objects.len()];
    spread::spread(count, &pools, &sizes, &mut random(seed, &[REPEATS]))
}

/// Moves everything of a set to the place that it has in a block's form of this number.
pub(super) fn turn(trial: &mut Trial, number: usize) {
    let places = trial.shown.len();
    trial.shown.rotate_left(number % places);
}

/// What a pair of practice shows: itself, each of its surfaces in turn, or both with others of their object.
pub(super) fn training(study: &Study, way: Way, pair: &TrainingSection) -> Vec<Vec<ConfigurationId>> {
    let both = [pair.left.clone(), pair.right.clone()];
    match way {
        Way::Ratings => both.into_iter().map(|one| vec![one]).collect(),
        _ if way.is_best() => {
            let of_object =
                study.configurations.iter().map(|c| &c.id).filter(|id| id.object == pair.left.object);
            let mut shown = both.to_vec();
            shown.dedup();
            for id in of_object {
                if shown.len() < way.shown() && !shown.contains(id) {
                    shown.push(id.clone());
                }
            }
            vec![shown]
        }
        _ => vec![both.to_vec()],
    }
}

#[cfg(test)]
mod tests;
