//! The order of questions: a circle of trials, and the rows of a Latin square read off it.

use super::Trial;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// All trials of a block on a circle: repeats opposite their comparisons, controls evenly between, the rest at random.
pub(super) fn circle(
    comparisons: &[Trial],
    repeats: &[Trial],
    controls: &[Trial],
    random: &mut Pcg64,
) -> Vec<Trial> {
    let count = comparisons.len() + repeats.len() + controls.len();
    let mut places: Vec<Option<&Trial>> = vec![None; count];
    let mut repeats: Vec<&Trial> = repeats.iter().collect();
    repeats.shuffle(random);
    for (k, repeat) in repeats.iter().enumerate() {
        let first = k * (count / 2) / repeats.len();
        let original = comparisons.iter().find(|trial| trial.asks_the_same(repeat));
        places[first] = original;
        places[first + count / 2] = Some(repeat);
    }
    let mut free: Vec<usize> = (0..count).filter(|&place| places[place].is_none()).collect();
    let mut shuffled: Vec<&Trial> = controls.iter().collect();
    shuffled.shuffle(random);
    let taken: Vec<usize> = (0..controls.len()).map(|k| free[k * free.len() / controls.len()]).collect();
    taken.iter().zip(shuffled).for_each(|(&place, control)| places[place] = Some(control));
    free.retain(|place| !taken.contains(place));
    let repeated = |trial: &&Trial| repeats.iter().any(|repeat| repeat.asks_the_same(trial));
    let mut rest: Vec<&Trial> = comparisons.iter().filter(|trial| !repeated(trial)).collect();
    rest.shuffle(random);
    free.iter().zip(rest).for_each(|(&place, trial)| places[place] = Some(trial));
    places.into_iter().map(|trial| trial.expect("as many trials as places").clone()).collect()
}

/// Row `row` of the Latin square of a cycle: for each position the place on the circle.
///
/// With an even number of places odd rows run backwards: position p holds r + p in even rows and r - p in odd ones, two
/// parity classes that together are every place once. With an odd number whole cycles alternate.
pub(super) fn row(count: usize, row: usize, cycle: usize) -> Vec<usize> {
    let backwards = if count.is_multiple_of(2) { row % 2 == 1 } else { cycle % 2 == 1 };
    let place = |position: usize| if backwards { row + count - position } else { row + position } % count;
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_a_latin_square() {
        for count in 1..40 {
            for cycle in 0..3 {
                for position in 0..count {
                    let mut seen: Vec<usize> = (0..count).map(|r| row(count, r, cycle)[position]).collect();
                    seen.sort_unstable();
                    assert_eq!(seen, (0..count).collect::<Vec<_>>(), "{count} {cycle} {position}");
                }
            }
        }
    }
}
