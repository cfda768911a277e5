//! Worths by the model of the way in which people were asked.

use isostudy_inference::models::GroupModel;
use isostudy_inference::ways::{OfGroup, Worth};
use isostudy_statistics::Model;
use isostudy_table::{Cell, Columns, Table};

/// `ways`: a row for each item, model and group; where there is no estimate, one row with the reason.
pub(crate) fn ways(found: &[OfGroup<'_>], pairs: &[GroupModel<'_>]) -> Table {
    /// A model of a group, and an item with its place.
    type Row<'a> = (&'a OfGroup<'a>, Option<(usize, &'a Worth)>);
    let rows = found.iter().flat_map(|of| -> Vec<Row<'_>> {
        match &of.worths {
            Ok(worths) => worths.iter().enumerate().map(|item| (of, Some(item))).collect(),
            Err(_) => vec![(of, None)],
        }
    });
    let beside = |(of, item): &Row<'_>| {
        let davidson =
            |model: &&GroupModel<'_>| model.model == Model::Davidson && model.group.name == of.group.name;
        let worths = &pairs.iter().find(davidson)?.worths;
        Some(worths.get(item.as_ref()?.0)?.log_worth)
    };
    fn worth<'a>((_, item): &Row<'a>) -> Option<&'a Worth> {
        item.map(|(_, worth)| worth)
    }
    let caption = "Worths by the way in which people were asked, less that of the group's first item";
    let table = Columns::over(rows)
        .column("group", "Group", |(of, _)| Cell::text(&of.group.name))
        .column("item", "Item", |(of, item)| {
            Cell::text(item.map_or("", |(place, _)| of.group.items[place].as_str()))
        })
        .column("model", "Model", |(of, _)| Cell::text(of.model.code()))
        .column("worth", "Worth", |row| Cell::of_sum(worth(row).map(|of| of.value), 3))
        .column("se", "SE, participants", |row| Cell::number(worth(row).and_then(|of| of.error), 3))
        .column("low", "from", |row| Cell::of_sum(worth(row).and_then(|of| of.interval).map(|of| of.low), 3))
        .column("high", "to", |row| Cell::of_sum(worth(row).and_then(|of| of.interval).map(|of| of.high), 3))
        .column("p", "p", |row| Cell::p(worth(row).and_then(|of| of.p), 5))
        .column("pairs", "Log worth of pairs", |row| Cell::of_sum(beside(row), 3))
        .column("answers", "Answers", |(of, _)| Cell::count(of.answers))
        .column("remark", "Remark", |(of, _)| {
            Cell::text(of.worths.as_ref().err().map_or_else(String::new, ToString::to_string))
        })
        .into_table("ways", caption);
    table.with_note(
        "Ratings: in steps of the scale, less the mean of the object. First choice: in log-odds, on the scale of pairs. Adjacent steps: in \
         log-odds, on the scale of pairs. Cumulative steps: in log-odds on a scale of its own: compare orders. SE, \
         from and to: participants as clusters, t interval at 95 %. Log worth of pairs: Davidson's model of the same answers as \
         left, none or right. Drawn together: in log-odds, on the scale of pairs; for answers to pairs that earlier answers chose.",
    )
}
