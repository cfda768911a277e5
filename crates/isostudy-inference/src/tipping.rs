//! How large a liking for a side would undo a result, where methods and sides go together.

use crate::ballots::BallotGroup;
use crate::hypotheses::{Hypothesis, On, Target};
use isostudy_design::contrast::Over;
use isostudy_design::{Level, MethodId, Study};
use isostudy_statistics::{
    Pairs, Participants, ShownBallot, Side, SideDesign, Tip, Tipping, side_design, tipping,
    tipping_of_difference,
};

/// Beyond so many different patterns of answers it takes minutes.
const MOST_PATTERNS: usize = 5_000;
/// Of so many people nearly all have patterns of their own.
const MOST_PEOPLE: usize = 50_000;

/// What undoes a result that sides may have made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Undone {
    /// A liking for a side of so many log-odds.
    By(Side, f64),
    /// No liking up to [`FARTHEST_TIP`](isostudy_statistics::FARTHEST_TIP).
    ByNothing,
    /// The result has no interval that a liking could take to zero.
    CannotBeSaid,
}

/// Answers about the first two of so many items, and others that they were compared with: of a preference, or of the two
/// that differ.
struct About {
    items: usize,
    parts: Vec<Vec<ShownBallot>>,
}

impl Undone {
    /// Of a result that holds, by answers on the sides that people saw; `None` where sides cannot have made it, or there are too many
    /// people to say.
    pub fn of(
        study: Option<&Study>,
        shown: &[ShownBallot],
        groups: &[BallotGroup],
        hypothesis: &Hypothesis,
    ) -> Option<Self> {
        if hypothesis.test.participants() > MOST_PEOPLE {
            return None;
        }
        let About { items, parts } = about(study, shown, groups, hypothesis)?;
        let parts: Vec<Vec<ShownBallot>> = parts.iter().map(|part| linked(items, part)).collect();
        let items =
            parts.iter().flatten().flat_map(|b| [b.left(), b.right()]).max().map_or(2, |last| last + 1);
        let counterbalanced =
            |part: &Vec<ShownBallot>| side_design(&Pairs::of(items, part)) == SideDesign::Counterbalanced;
        let patterns = |part: &Vec<ShownBallot>| Participants::of(items, part).kinds();
        if parts.iter().all(counterbalanced) || parts.iter().any(|part| patterns(part) > MOST_PATTERNS) {
            return None;
        }
        let found = match &parts[..] {
            [one, other] => tipping_of_difference([one, other], items, 0, 1),
            [all] => tipping(&Participants::of(items, all), 0, 1),
            _ => return None,
        };
        match found {
            None => Some(Self::CannotBeSaid),
            Some(Tipping { left: Tip::At(at), .. }) => Some(Self::By(Side::Left, at)),
            Some(Tipping { right: Tip::At(at), .. }) => Some(Self::By(Side::Right, at)),
            Some(Tipping { left: Tip::Beyond, right: Tip::Beyond }) => Some(Self::ByNothing),
            Some(_) => None,
        }
    }
}

fn about(
    study: Option<&Study>,
    shown: &[ShownBallot],
    groups: &[BallotGroup],
    hypothesis: &Hypothesis,
) -> Option<About> {
    match (&hypothesis.target, study) {
        (Target::Contrast { levels, over }, Some(study)) => {
            let overs = match *over {
                Over::Difference(one, other) => vec![Over::Within(one), Over::Within(other)],
                Over::ObjectDifference(one, other) => vec![Over::Object(one), Over::Object(other)],
                over => vec![over],
            };
            let mut items: Vec<Level> = levels.to_vec();
            let own = |over| about_levels(study, shown, over, &mut items);
            let parts = overs.into_iter().map(own).collect();
            Some(About { items: items.len(), parts })
        }
        (Target::Items { group, first, second, on }, _) => {
            let group = groups.iter().find(|of| of.name == *group)?;
            let place = |name: &String| group.items.iter().position(|item| item == name);
            let (first, second) = (place(first)?, place(second)?);
            let mut order: Vec<usize> = (0..group.items.len()).collect();
            order.sort_by_key(|&item| (item != first, item != second));
            let new =
                |item: usize| order.iter().position(|&other| other == item).expect("one of the group's");
            let on_object = |object: Option<&String>| -> Vec<ShownBallot> {
                let meant = |b: &&ShownBallot| object.is_none_or(|name| group.objects[b.question()] == *name);
                let own = group.ballots.iter().filter(meant);
                own.map(|b| b.with_items([new(b.left()), new(b.right())])).collect()
            };
            let parts = match on {
                On::All => vec![on_object(None)],
                On::Object(name) => vec![on_object(Some(name))],
                On::Difference(names) => names.iter().map(|name| on_object(Some(name))).collect(),
            };
            Some(About { items: group.items.len(), parts })
        }
        _ => None,
    }
}

/// The answers about items that were compared with the first, directly or through others, numbered anew after the first two.
fn linked(items: usize, ballots: &[ShownBallot]) -> Vec<ShownBallot> {
    let mut places: Vec<Option<usize>> = vec![None; items];
    (places[0], places[1]) = (Some(0), Some(1));
    let mut next = 2;
    while let Some(ballot) =
        ballots.iter().find(|b| places[b.left()].is_some() != places[b.right()].is_some())
    {
        let new = if places[ballot.left()].is_none() { ballot.left() } else { ballot.right() };
        places[new] = Some(next);
        next += 1;
    }
    let renumbered = |b: &ShownBallot| Some(b.with_items([places[b.left()]?, places[b.right()]?]));
    ballots.iter().filter_map(renumbered).collect()
}

/// The answers about levels of the same factor as `items`, which grow by those that others are compared with, everything else
/// equal; as far as a contrast goes.
fn about_levels(
    study: &Study,
    shown: &[ShownBallot],
    over: Over,
    items: &mut Vec<Level>,
) -> Vec<ShownBallot> {
    let factor = items[0].factor;
    let methods = study.method_ids();
    let level = |method: MethodId| study.level_of(method, factor);
    let mut place = |level: Level| {
        items.iter().position(|&known| known == level).unwrap_or_else(|| {
            items.push(level);
            items.len() - 1
        })
    };
    let mut own = Vec::new();
    for ballot in shown {
        let [left, right] = [ballot.left(), ballot.right()].map(|item| methods[item]);
        let meant = match over {
            Over::All => true,
            Over::Within(level) => study.level_of(left, level.factor) == Some(level),
            Over::Object(object) => study.comparisons[ballot.question()].object == object,
            Over::Difference(..) | Over::ObjectDifference(..) => false,
        };
        let equal_else = factor == study.method_factor() || study.difference(left, right) == factor;
        if let (true, Some(left), Some(right)) = (meant && equal_else, level(left), level(right)) {
            own.push(ballot.with_items([place(left), place(right)]));
        }
    }
    own
}
