//! Which method was shown to be liked more, on all objects and on each.

use crate::standing::Standing;
use isostudy_inference::liking::{LikedPair, Liking};
use isostudy_inference::results::Results;
use isostudy_table::{Cell, Columns, Table};

/// Every two methods on one scale; `None` without one.
pub(super) fn likings(results: &Results<'_>) -> Option<Table> {
    let objects = &results.inputs.study.file.objects;
    let rows = results.likings.iter().flat_map(|of| of.pairs.iter().map(move |pair| (of, pair)));
    let on = |of: &Liking| of.object.map_or("all objects", |place| objects[place].name.as_str());
    let named = |id: Option<isostudy_design::MethodId>| id.map_or(Cell::Missing, Cell::text);
    let verdict = |of: &Liking, pair: &LikedPair| match pair.shown {
        Some(_) => Standing::Holds.label(),
        None if of.is_too_few => Standing::TooFew.label(),
        None => Standing::Open.label(),
    };
    Columns::over(rows)
        .column("object", "On", |(of, _)| Cell::text(on(of)))
        .column("first", "First", |(_, pair)| Cell::text(pair.first))
        .column("second", "Second", |(_, pair)| Cell::text(pair.second))
        .column("verdict", "Verdict", |(of, pair)| Cell::text(verdict(of, pair)))
        .column("liked_more", "Liked more", |(_, pair)| named(pair.shown))
        .column("log_odds", "Log-odds", |(_, pair)| Cell::Number(pair.log_odds, 3))
        .column("p_adjusted", "p adjusted", |(_, pair)| Cell::p(pair.adjusted, 4))
        .column("asked", "By a test of the two", |(_, pair)| named(pair.asked))
        .into_table("likings", "Which method is liked more")
        .with_note(
            "Log-odds: worth of the first less that of the second, on one scale of the object's answers, with the side in the model where \
             sides alternate. p: t test over people, adjusted by Holm over the object's pairs. By a test of the two: the method that a held test of \
             these two alone prefers. A method is liked more if either holds. Too few: no outcome of so few people is significant by the exact \
             test, so the t test of the scale is not judged.",
        )
        .unless_empty()
}
