//! Damage to files, for tests of readers.

use rand::RngExt;
use rand_pcg::Pcg64;

/// Changes up to `most` places of some bytes: bits, bytes, cuts and copies of up to `longest` bytes, and `tokens` that break readers.
pub(crate) fn damage(bytes: &mut Vec<u8>, tokens: &[&[u8]], [most, longest]: [usize; 2], random: &mut Pcg64) {
    for _ in 0..random.random_range(1..=most) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..=longest)).min(bytes.len());
        let token = tokens[random.random_range(0..tokens.len())];
        match random.random_range(0..7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            1 if at < bytes.len() => bytes[at] = random.random(),
            2 => drop(bytes.drain(at..end)),
            3 => drop(bytes.splice(at..at, token.iter().copied())),
            4 => drop(bytes.splice(at..(at + token.len()).min(bytes.len()), token.iter().copied())),
            5 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            _ => bytes.truncate(at),
        }
    }
}
