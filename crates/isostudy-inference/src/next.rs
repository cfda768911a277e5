//! Which questions to ask the next person, in a study that asks where an answer tells most.
//!
//! Half of a person's comparisons stay as the form plans them, so that answers have no part in them. The others are chosen by
//! [`chosen_pairs`] from the answers of everybody before. Of a pair of methods that is compared on several objects, the object with
//! the fewest answers is asked about. `docs/adaptive.md` has what was measured of this.

use isostudy_design::{MethodId, Study};
use isostudy_statistics::{Outcome, Pairs, chosen_pairs};
use std::collections::{BTreeMap, BTreeSet};

/// A comparison, as it can be shown.
struct Offer {
    /// Its items, the lower first.
    items: [usize; 2],
    /// The code name with the lower item on the left, and with it on the right.
    codes: [Option<String>; 2],
}

/// What chooses questions of a study.
pub struct NextQuestions {
    items: usize,
    offers: Vec<Offer>,
    /// The place of the offer that a code name shows, and whether its lower item is on the right.
    of_code: BTreeMap<String, (usize, bool)>,
    seed: u64,
}

impl NextQuestions {
    /// That of a study that chooses questions; `None` of others.
    pub fn of(study: &Study) -> Option<Self> {
        study.file.forms.as_ref().filter(|forms| forms.adaptive)?;
        let sides = study.comparisons.iter().flat_map(|of| [of.left.method, of.right.method]);
        let methods: BTreeSet<usize> = sides.map(|method| study.place(method)).collect();
        let methods: Vec<usize> = methods.into_iter().collect();
        let item = |method: MethodId| methods.binary_search(&study.place(method)).expect("one of them");
        let codes: BTreeMap<_, _> = study.stimuli().into_iter().map(|of| (of.shown, of.code)).collect();
        let offer = |of: &isostudy_design::Comparison| {
            let (left, right) = (item(of.left.method), item(of.right.method));
            let (low, high) = if left < right { (&of.left, &of.right) } else { (&of.right, &of.left) };
            let code = |shown: [&isostudy_design::ConfigurationId; 2]| {
                codes.get(&shown.map(Clone::clone)[..]).cloned()
            };
            Offer { items: [left.min(right), left.max(right)], codes: [code([low, high]), code([high, low])] }
        };
        let offers: Vec<Offer> = study.comparisons.iter().map(offer).collect();
        let mut of_code = BTreeMap::new();
        for (place, offer) in offers.iter().enumerate() {
            for (code, is_turned) in offer.codes.iter().zip([false, true]) {
                of_code.extend(code.iter().map(|code| (code.clone(), (place, is_turned))));
            }
        }
        Some(Self { items: methods.len(), offers, of_code, seed: study.file.study.seed })
    }

    /// The code names of what to ask the next person, as many as are `planned`. `answered` are the code names and outcomes of everybody
    /// before, and `person` is how many have begun. What is planned and is no comparison, such as a control, stays. The same
    /// inputs, the same questions.
    pub fn choose<'a>(
        &self,
        answered: impl IntoIterator<Item = (&'a str, Outcome)>,
        planned: &[String],
        person: usize,
    ) -> Vec<String> {
        let mut counts: BTreeMap<(usize, usize), [f64; 3]> = BTreeMap::new();
        let mut of_offer = vec![0_u64; self.offers.len()];
        for (code, outcome) in answered {
            let Some(&(offer, is_turned)) = self.of_code.get(code) else { continue };
            of_offer[offer] += 1;
            let [low, high] = self.offers[offer].items;
            let sides = if is_turned { (high, low) } else { (low, high) };
            counts.entry(sides).or_default()[outcome.index()] += 1.0;
        }
        let pairs = Pairs::new(self.items, counts.into_iter().map(|((left, right), of)| (left, right, of)));
        let offer_of = |code: &String| self.of_code.get(code).map(|&(offer, _)| offer);
        let places: Vec<usize> = (0..planned.len()).filter(|&i| offer_of(&planned[i]).is_some()).collect();
        // Every other one stays, so that neither half of a form does.
        let mut asked: BTreeSet<usize> =
            places.iter().step_by(2).filter_map(|&place| offer_of(&planned[place])).collect();
        let free: Vec<usize> = places.iter().skip(1).step_by(2).copied().collect();
        let dealt: BTreeSet<[usize; 2]> = asked.iter().map(|&offer| self.offers[offer].items).collect();
        let dealt: Vec<[usize; 2]> = dealt.into_iter().collect();
        let is_compared = |a, b| self.offers.iter().any(|offer| offer.items == [a, b]);
        let mut chosen =
            chosen_pairs(&pairs, &is_compared, &dealt, person, free.len(), self.seed).into_iter();
        let mut questions = planned.to_vec();
        for place in free {
            // Of a pair the object with the fewest answers; where pairs have run out, what was planned, else what has the fewest answers.
            let fewest = |fits: &dyn Fn(usize) -> bool| {
                let open = (0..self.offers.len()).filter(|offer| !asked.contains(offer) && fits(*offer));
                open.min_by_key(|&offer| of_offer[offer])
            };
            let pair = chosen.next();
            let of_pair = pair.and_then(|[left, right]| {
                let items = [left.min(right), left.max(right)];
                fewest(&|offer| self.offers[offer].items == items)
            });
            let own = offer_of(&planned[place]).filter(|offer| of_pair.is_none() && !asked.contains(offer));
            if let Some(own) = own {
                asked.insert(own);
                continue;
            }
            let Some(offer) = of_pair.or_else(|| fewest(&|_| true)) else { continue };
            let [low_left, high_left] = &self.offers[offer].codes;
            let is_turned = pair.is_some_and(|[left, right]| left > right);
            let [wanted, other] = if is_turned { [high_left, low_left] } else { [low_left, high_left] };
            if let Some(code) = wanted.as_ref().or(other.as_ref()) {
                questions[place].clone_from(code);
                asked.insert(offer);
            }
        }
        questions
    }
}

#[cfg(test)]
mod tests;
