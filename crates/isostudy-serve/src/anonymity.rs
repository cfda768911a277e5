//! k-anonymity: a table in which nobody can be told from fewer than k - 1 others.
//!
//! Source: L. Sweeney, "k-anonymity: a model for protecting privacy", International Journal of Uncertainty, Fuzziness and
//! Knowledge-Based Systems 10 (2002), with the suppression of cells (L. Sweeney, the same journal and year, "Achieving k-anonymity
//! privacy protection using generalization and suppression").

use std::collections::BTreeMap;

/// How many people each combination of cells is shared by, at least.
pub const K: usize = 5;

/// What stands in a cell whose value would tell too much.
pub const MERGED: &str = "merged";

/// Merges cells until every row is the same as at least `k - 1` others. Returns how many cells were merged.
///
/// First values that fewer than `k` people share are merged within their column. Then, of rows whose combination is too rare, the
/// cell of the column is merged in which they differ most, until none is too rare. Rows in which all is merged and that are too few
/// themselves are joined by as many as they need out of the largest group, or by all of the smallest where none can spare them.
///
/// Not guaranteed: that as few cells as possible are merged, and that values which all of a group share stay unknown. With fewer than
/// `k` rows all cells are merged, and then the rows are as many as they are.
pub fn merge(rows: &mut [Vec<String>], k: usize) -> usize {
    let before = count(rows);
    for column in 0..rows.first().map_or(0, Vec::len) {
        let mut shared: BTreeMap<String, usize> = BTreeMap::new();
        rows.iter().for_each(|row| *shared.entry(row[column].clone()).or_default() += 1);
        for row in rows.iter_mut().filter(|row| shared[&row[column]] < k) {
            row[column] = MERGED.into();
        }
    }
    loop {
        let groups = groups(rows);
        let rare: Vec<usize> =
            groups.iter().filter(|(_, of)| of.len() < k).flat_map(|(_, of)| of.clone()).collect();
        if rare.is_empty() {
            break;
        }
        let open = rare.iter().copied().filter(|&row| !is_merged(&rows[row])).collect::<Vec<_>>();
        if open.is_empty() {
            // Nothing is left of them to merge: others have to join them.
            let others = || groups.values().filter(|of| !is_merged(&rows[of[0]]));
            let needed = k - rare.len();
            let largest = others().max_by_key(|of| of.len()).filter(|of| of.len() >= k + needed);
            let joining = match (largest, others().min_by_key(|of| of.len())) {
                (Some(largest), _) => largest[largest.len() - needed..].to_vec(),
                (None, Some(smallest)) => smallest.clone(),
                (None, None) => break,
            };
            joining.into_iter().for_each(|row| rows[row].fill(MERGED.into()));
            continue;
        }
        let differ = |column: usize| {
            let mut values: Vec<&String> =
                open.iter().map(|&row| &rows[row][column]).filter(|value| *value != MERGED).collect();
            values.sort();
            values.dedup();
            values.len()
        };
        // The last of those that differ as much.
        let column = (0..rows[0].len()).max_by_key(|&column| differ(column)).unwrap_or(0);
        open.iter().for_each(|&row| rows[row][column] = MERGED.into());
    }
    count(rows) - before
}

fn is_merged(row: &[String]) -> bool {
    row.iter().all(|cell| cell == MERGED)
}

fn count(rows: &[Vec<String>]) -> usize {
    rows.iter().flatten().filter(|cell| *cell == MERGED).count()
}

/// The places of rows that are the same.
fn groups(rows: &[Vec<String>]) -> BTreeMap<Vec<String>, Vec<usize>> {
    let mut groups: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
    rows.iter().enumerate().for_each(|(place, row)| groups.entry(row.clone()).or_default().push(place));
    groups
}

/// Numbers as ranges that at least `k` people share where there are as many: the bounds are values of the people.
pub fn ranges(values: &[Option<f64>], k: usize) -> Vec<Option<String>> {
    let mut sorted: Vec<f64> = values.iter().copied().flatten().collect();
    sorted.sort_by(f64::total_cmp);
    let mut bounds: Vec<[f64; 2]> = Vec::new();
    let mut rest = &sorted[..];
    while !rest.is_empty() {
        // All who say the same are in one range.
        let mut end = k.min(rest.len());
        while end < rest.len() && rest[end] == rest[end - 1] {
            end += 1;
        }
        let is_enough = rest.len() - end >= k || end == rest.len();
        let (range, after) = if is_enough { rest.split_at(end) } else { (rest, &rest[rest.len()..]) };
        bounds.push([range[0], range[range.len() - 1]]);
        rest = after;
    }
    let of = |value: f64| {
        let [low, high] = bounds.iter().find(|[low, high]| (*low..=*high).contains(&value))?;
        Some(if low == high { low.to_string() } else { format!("{low} to {high}") })
    };
    values.iter().map(|value| value.and_then(of)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[&[&str]]) -> Vec<Vec<String>> {
        rows.iter().map(|row| row.iter().map(|cell| (*cell).to_owned()).collect()).collect()
    }

    #[test]
    fn nobody_stands_alone_and_what_many_share_stays() {
        // Three join the two who stand alone, and fifteen stay what they were.
        let mut rows = table(&[["a", "x"].as_slice(); 18]);
        rows.extend(table(&[["b", "x"].as_slice(); 2]));
        assert_eq!(merge(&mut rows, 5), 2 * 5);
        assert_eq!(groups(&rows).values().map(Vec::len).collect::<Vec<_>>(), [15, 5]);
        // Six cannot spare three.
        let mut rows = table(&[["a", "x"].as_slice(); 6]);
        rows.extend(table(&[["b", "x"].as_slice(); 2]));
        assert_eq!(merge(&mut rows, 5), 2 * 8);
        let mut rows = table(&[["a", "x"].as_slice(); 6]);
        rows.extend(table(&[["b", "x"].as_slice(); 5]));
        let before = rows.clone();
        assert_eq!(merge(&mut rows, 5), 0);
        assert_eq!(rows, before);
        let mut few = table(&[["a", "x"].as_slice(); 4]);
        assert_eq!(merge(&mut few, 5), 8);
        assert_eq!(merge(&mut [], 5), 0);
    }

    /// 300 tables at random: every combination is shared by five, and values are those that were there.
    #[test]
    fn every_combination_is_shared_by_five() {
        // A linear congruential generator (D. E. Knuth, The Art of Computer Programming 2, MMIX).
        let mut state = 39_u64;
        let mut below = move |end: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % end
        };
        for people in 5..305 {
            let kinds: Vec<u64> = (0..1 + below(4)).map(|_| 1 + below(8)).collect();
            let given: Vec<Vec<String>> =
                (0..people).map(|_| kinds.iter().map(|&kind| below(kind).to_string()).collect()).collect();
            let mut merged = given.clone();
            merge(&mut merged, 5);
            assert!(groups(&merged).values().all(|of| of.len() >= 5), "{people} people");
            for (before, after) in given.iter().zip(&merged) {
                assert!(before.iter().zip(after).all(|(old, new)| new == old || new == MERGED));
            }
        }
    }

    #[test]
    fn numbers_become_ranges_of_five() {
        let ages = [18.0, 19.0, 19.0, 20.0, 21.0, 21.0, 22.0, 30.0, 31.0, 40.0, 50.0, 61.0];
        let given: Vec<Option<f64>> = ages.into_iter().map(Some).chain([None]).collect();
        let said = ranges(&given, 5);
        assert!(said[..6].iter().all(|of| of.as_deref() == Some("18 to 21")), "{said:?}");
        assert!(said[6..12].iter().all(|of| of.as_deref() == Some("22 to 61")), "{said:?}");
        assert_eq!(said[12], None);
        assert_eq!(ranges(&[Some(3.0)], 5), [Some("3".to_owned())]);
    }
}
