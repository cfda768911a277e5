//! Faults of forms whose people do not compare pairs.

use super::{Fault, Rule};
use crate::config::Way;
use crate::forms::{Form, Role};
use crate::method::ConfigurationId;
use crate::study::Study;
use std::collections::BTreeMap;

/// How often a configuration was shown: in all, and at each place.
type Shown<'a> = BTreeMap<&'a ConfigurationId, (u64, Vec<u64>)>;

/// Configurations of one object that are shown more often than others, and places at which one of several stands more often than at
/// another: both over all planned forms, repeats left out.
pub(super) fn faults(study: &Study, way: Way, forms: &[Form]) -> Vec<Fault> {
    let mut shown: Shown<'_> = BTreeMap::new();
    for trial in forms.iter().flat_map(|form| &form.trials).filter(|trial| trial.role == Role::Comparison) {
        for (place, id) in trial.shown.iter().enumerate() {
            let (all, places) = shown.entry(id).or_insert_with(|| (0, vec![0; way.shown()]));
            *all += 1;
            places[place] += 1;
        }
    }
    let mut faults = Vec::new();
    for (id, (_, places)) in shown.iter().filter(|_| way.is_best()) {
        let least = places.iter().min().copied().unwrap_or(0);
        let most = places.iter().max().copied().unwrap_or(0);
        let rule = match (least, most - least) {
            // Each of its sets can be at one place once more.
            (_, more) if more <= places.len() as u64 => continue,
            (0, _) => Rule::SideConfounded,
            _ => Rule::SidesUnbalanced,
        };
        let counts: Vec<String> = places.iter().map(u64::to_string).collect();
        let evidence = format!("at its places {} times", counts.join(", "));
        faults.push(Fault { rule, place: id.to_string(), evidence });
    }
    for object in &study.file.objects {
        let own = || shown.iter().filter(|(id, _)| id.object == object.id);
        let least = own().min_by_key(|(_, (all, _))| *all);
        let most = own().max_by_key(|(_, (all, _))| *all);
        if let (Some((rare, (low, _))), Some((common, (high, _)))) = (least, most)
            && 5 * (high - low) > *high
            && high - low > 1
        {
            let evidence = format!("{common} is shown {high} times, {rare} {low} times");
            let place = format!("object {}", object.id);
            faults.push(Fault { rule: Rule::AppearancesUnequal, place, evidence });
        }
    }
    faults.sort_by_key(|fault| fault.rule);
    faults
}
