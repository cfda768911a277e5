//! Four-letter names that say nothing about what they stand for.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

const CONSONANTS: &[u8] = b"bdfgklmnprstvz";
const VOWELS: &[u8] = b"aeiou";

/// Names that hurt or amuse in one of the languages that participants may speak, and so are never given.
const UNFIT: [&str; 54] = [
    "bita", "bite", "bito", "dago", "dede", "dike", "fuka", "fuke", "fuki", "fuko", "fuku", "gaza", "gipo",
    "kaka", "kaki", "kike", "kiki", "kuka", "kulo", "loli", "mata", "mato", "nazi", "nega", "nege", "negi",
    "niga", "nige", "nigi", "nigo", "nigu", "nuda", "nude", "nudi", "nudo", "paki", "pede", "pedo", "pene",
    "peni", "pipi", "puta", "pute", "puto", "rape", "sado", "sida", "tete", "tita", "tite", "titi", "vaga",
    "vagi", "zizi",
];

/// How many names there are.
pub const LIMIT: usize = (CONSONANTS.len() * VOWELS.len()).pow(2) - UNFIT.len();

/// Draws `count` different pronounceable names (consonant, vowel, consonant, vowel) from a seed.
///
/// The same seed and count give the same names in the same order, and a longer draw starts with a shorter one.
/// Names depend on nothing else, so a name carries no information about the configuration it is given to.
///
/// # Panics
/// If more than [`LIMIT`] names are asked for; there are no more.
pub fn draw(seed: u64, count: usize) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(LIMIT);
    for &a in CONSONANTS {
        for &b in VOWELS {
            for &c in CONSONANTS {
                for &d in VOWELS {
                    names.push([a, b, c, d].iter().map(|&l| l as char).collect());
                }
            }
        }
    }
    names.shuffle(&mut Pcg64::seed_from_u64(seed));
    names.retain(|name| !UNFIT.contains(&name.as_str()));
    assert!(count <= names.len(), "{count} code names asked for, {} exist", names.len());
    names.truncate(count);
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn unfit_names_are_never_given() {
        let all: HashSet<String> = draw(3, LIMIT).into_iter().collect();
        assert_eq!(all.len(), LIMIT);
        assert!(UNFIT.iter().all(|name| !all.contains(*name)));
    }

    #[test]
    fn names_are_distinct_four_letters_and_reproducible() {
        let names = draw(7, 45);
        assert_eq!(names, draw(7, 45));
        assert_ne!(names, draw(8, 45));
        assert_eq!(names[..18], draw(7, 18));
        assert_eq!(names.iter().collect::<HashSet<_>>().len(), 45);
        assert!(names.iter().all(|n| n.len() == 4 && n.bytes().all(|b| b.is_ascii_lowercase())));
    }
}
