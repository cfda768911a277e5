//! Which method to take for what, and who is beaten in both time and error.

use crate::region;
use crate::wants::{TIED, busy, judged, phrase, words};
use crate::words::{list, whole};
use isostudy_design::record::BenchRun;
use isostudy_design::{MethodId, Study};
use isostudy_inference::decision::{
    Axes, Cost, Estimate, Front, FrontPoint, Goal, LEAST_ERROR, ObjectCandidates, Pick, Standing, noise,
};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::results::{Decision, Results};
use isostudy_table::digits::number;
use isostudy_table::{Cell, Columns, Table};
use isostudy_timing::stage_times::measured;

/// What a region has numbers of its own for.
const JUDGED: &str = "Errors, sharp edges, radius ratios, numbers of triangles and of intersecting pairs";

/// A factor below which two are as good as each other.
const MORE: f64 = 1.05;

/// The picks and the fronts, where there is anything to choose from.
pub(super) fn tables(results: &Results<'_>) -> Vec<Table> {
    let (inputs, found) = (&results.inputs, &results.decision);
    let objects = &found.objects;
    let picks = &judged(results)[..];
    let tables =
        [choices(inputs, objects, picks), decision(inputs, objects, picks), standings(inputs.study, found)];
    tables.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// A row for each want, a column for each object: the best and its number. There are more wants than objects.
fn choices(inputs: &Inputs<'_>, objects: &[ObjectCandidates<'_>], picks: &[&Pick<'_>]) -> Table {
    let mut wants: Vec<Goal> = Vec::new();
    for pick in picks {
        if !wants.contains(&pick.want.goal) {
            wants.push(pick.want.goal);
        }
    }
    let cell = |object: &ObjectCandidates<'_>, want: Goal| {
        let of_want = picks.iter().filter(|pick| pick.want.goal == want);
        let mut best = of_want.flat_map(|pick| pick.on.iter().map(move |best| (pick.method.id, best)));
        let Some((id, best)) = best.find(|(_, best)| best.object.id == object.object.id) else {
            return Cell::Missing;
        };
        // A tie has no winner.
        let names = match best.alike.len() {
            0 => id.to_string(),
            n if n < TIED => {
                let all: Vec<MethodId> = std::iter::once(id).chain(best.alike.iter().copied()).collect();
                all.iter().map(MethodId::to_string).collect::<Vec<_>>().join(" = ")
            }
            // The next table names them.
            n => format!("{id} = {} others", whole(n as u64)),
        };
        Cell::text(format!("{names}, {}", words(want).unit.replace("{}", &ranged(&[best.value.value]))))
    };
    let mut table = Columns::over(&wants)
        .column("want", "You want", |want| Cell::text(phrase(inputs.study, **want)))
        .columns_of(objects, |all, of| all.column(&of.object.id, &of.object.name, |want| cell(of, **want)))
        .into_table("choices", "The best method for each object and purpose");
    table.notes.push(
        "a = b: the two are not distinguished, so neither is the winner. The next table says what each choice costs. Empty: no method \
         qualifies."
            .into(),
    );
    let apart = inputs.study.methods.iter().filter_map(|of| Some((of.id, of.apart.as_ref()?)));
    table.notes.extend(apart.map(|(id, why)| format!("No choice names {id}: {why}.")));
    table.notes.extend(busy(inputs));
    table.notes.extend(conditions(inputs, objects));
    table
}

/// What one wants, what to take, why, and what it costs.
fn decision(inputs: &Inputs<'_>, objects: &[ObjectCandidates<'_>], picks: &[&Pick<'_>]) -> Table {
    let on = |pick: &Pick<'_>| {
        let on: Vec<&str> = pick.on.iter().map(|best| best.object.name.as_str()).collect();
        if on.len() == objects.len() && on.len() > 1 { "every object".into() } else { list(&on) }
    };
    let mut table = Columns::over(picks)
        .column("want", "You want", |pick| Cell::text(phrase(inputs.study, pick.want.goal)))
        .column("objects", "On", |pick| Cell::text(on(pick)))
        .column("take", "Take", |pick| Cell::text(take(pick)))
        .column("why", "Why", |pick| Cell::text(why(inputs.bench, pick)))
        .column("cost", "What it costs", |pick| Cell::text(cost(pick, busy(inputs).is_some())))
        .into_table("decision", "Which method to take");
    if !picks.is_empty() {
        let mut note =
            "Costs are relative to the least of all methods with the object's own cubes.".to_owned();
        if picks.iter().any(|pick| pick.want.goal == Goal::ClosestPerTriangle) {
            note.push_str(" Those of \u{201c}as many triangles\u{201d} are relative to the least of the methods with as many.");
        }
        if picks.iter().any(|pick| pick.on.iter().any(|best| !best.alike.is_empty())) {
            note.push_str(" Where a row names several methods, they are not distinguished. Numbers and costs are those of the first.");
        }
        table.notes.push(note);
        table.notes.extend(region::sentence(inputs.study, JUDGED));
    }
    table
}

/// The method, or all that are not distinguished: those of every object of the row, then those of some.
fn take(pick: &Pick<'_>) -> String {
    let id = pick.method.id.to_string();
    let [everywhere, somewhere] = alike(pick);
    if everywhere.is_empty() && somewhere.is_empty() {
        return format!("{id}: {}", pick.method.label);
    }
    let all: Vec<String> = std::iter::once(id).chain(everywhere).collect();
    let text = all.join(" = ");
    match somewhere.is_empty() {
        true => text,
        false => format!("{text}; on some = {}", somewhere.join(", ")),
    }
}

/// The best's numbers and the next's.
fn why(run: Option<&BenchRun>, pick: &Pick<'_>) -> String {
    let range = |values: &mut dyn Iterator<Item = Estimate>| -> String {
        words(pick.want.goal).says.replace("{}", &ranged(&values.map(|of| of.value).collect::<Vec<_>>()))
    };
    let own = range(&mut pick.on.iter().map(|best| best.value));
    let others: Vec<(MethodId, f64)> =
        pick.on.iter().filter_map(|best| best.next.map(|(method, value)| (method.id, value.value))).collect();
    let mut text = match others[..] {
        [] => format!("{own}; no other qualifies"),
        [(first, _), ..] => {
            let same = others.iter().all(|(id, _)| *id == first);
            let next = if same { first.to_string() } else { "the best other".into() };
            let values: Vec<f64> = others.iter().map(|(_, value)| *value).collect();
            format!("{own}; {next}: {}", ranged(&values))
        }
    };
    if let Some((of, _)) = run.filter(|_| pick.want.goal.is_of_times()).map(noise) {
        text.push_str(&format!("; noise: {}", percents(of)));
    }
    text
}

/// The codes of those that are not distinguished from the best on each of its objects, and on some.
fn alike(pick: &Pick<'_>) -> [Vec<String>; 2] {
    let mut found: Vec<(MethodId, usize)> = Vec::new();
    for id in pick.on.iter().flat_map(|best| &best.alike) {
        match found.iter_mut().find(|(other, _)| other == id) {
            Some((_, times)) => *times += 1,
            None => found.push((*id, 1)),
        }
    }
    let codes = |holds: &dyn Fn(usize) -> bool| -> Vec<String> {
        found.iter().filter(|(_, times)| holds(*times)).map(|(id, _)| id.to_string()).collect()
    };
    let all = pick.on.len();
    [codes(&|times| times == all), codes(&|times| times < all)]
}

/// What is more than the least of those compared, and what is wrong with the mesh. Times of a busy run are no price.
fn cost(pick: &Pick<'_>, is_busy: bool) -> String {
    let mut parts = Vec::new();
    let mut factor = |values: Vec<f64>, of: &str| {
        if values.iter().any(|&value| value >= MORE) {
            parts.push(format!("{} {of}", ranged(&values)));
        }
    };
    let costs = || pick.on.iter().map(|best| &best.cost);
    if !is_busy {
        factor(costs().filter_map(|cost| cost.time).collect(), "times the shortest time");
    }
    factor(costs().map(|cost| cost.triangles).collect(), "times the fewest triangles");
    factor(costs().filter_map(|cost| cost.error).collect(), "times the smallest error");
    factor(costs().filter_map(|cost| cost.samples).collect(), "times the fewest samples");
    factor(costs().filter_map(|cost| cost.memory).collect(), "times the least memory");
    let most = |count: &dyn Fn(&Cost) -> u64| costs().map(count).max().unwrap_or(0);
    let up_to = |most: u64, what: &str| {
        let or = if pick.on.len() > 1 { "up to " } else { "" };
        (most > 0).then(|| format!("{or}{} {what}", whole(most)))
    };
    parts.extend(up_to(most(&|cost| cost.crossing_triangles), "pairs of triangles that intersect"));
    parts.extend(up_to(most(&|cost| cost.no_manifold), "edges or vertices where it is no manifold"));
    if parts.is_empty() { "nothing of what is compared here".into() } else { parts.join("; ") }
}

/// How it was measured, and what is not compared: a note for each quantity.
fn conditions(inputs: &Inputs<'_>, objects: &[ObjectCandidates<'_>]) -> Vec<String> {
    let mut notes = vec![
        "Two methods are not distinguished if their intervals at 95 % meet. Of those, and within 5 % of the best, one stands first. For \
         a time it is the one with the smallest mean error, for an error the fastest."
            .into(),
    ];
    notes.extend(inputs.bench.filter(|run| !run.samples.is_empty()).map(of_times));
    let mut errors = "Mean error: mean distance from mesh to isosurface or back, whichever is larger, in edges of the object's benchmark \
                      cubes. Sharp edges kept: mean distance from the object's sharp edges to the mesh, in that unit."
        .to_owned();
    if let Some(judged) = region::sentence(inputs.study, JUDGED) {
        errors.push_str(&format!(" {judged}"));
    }
    if objects.iter().any(ObjectCandidates::has_least_error) {
        errors.push_str(&format!(" A mean error below {LEAST_ERROR} counts as {LEAST_ERROR}."));
    }
    notes.push(errors);
    if inputs.chunks.iter().any(|times| !times.edit_s.is_empty()) {
        notes.push(
            "Chunks and edits are compared one by one. Two methods are not distinguished if the interval of the median ratio, wider by the \
             noise, has 1 in it."
                .into(),
        );
    }
    let is_liked = objects.iter().flat_map(|of| &of.candidates).any(|of| of.preference.is_some());
    if is_liked {
        notes.push(
            "Most liked: the largest worth on one scale of the object's answers, with the side in the model where sides alternate. The \
             table of likings has every two methods."
                .into(),
        );
    }
    let mut not = vec!["other objects, resolutions and machines"];
    if !is_liked {
        not.push("what people like (there are no answers)");
    }
    if !objects.iter().flat_map(|of| &of.candidates).any(|of| of.memory.is_some()) {
        not.push("memory");
    }
    not.push("ease of use");
    let compared = match inputs.study.methods.iter().any(|method| method.budget.is_some()) {
        true => {
            "Methods with the object's own cubes are compared, but for \u{201c}as many triangles\u{201d}. "
        }
        false => "",
    };
    notes.push(format!(
        "{compared}Each row takes the best in its quantity, whatever else it costs. Not compared: {}.",
        list(&not)
    ));
    notes
}

/// What a time is, and by how much runs differ.
fn of_times(run: &BenchRun) -> String {
    let mut text =
        format!("Time: median from the field to the mesh, without normals, over {}. ", measured(run));
    let is = match noise(run) {
        (of, true) => format!("As the A/A block tells, runs of one program differ by {}", percents(of)),
        (of, false) => {
            format!("No A/A block tells how much runs of one program differ, and {} is assumed", percents(of))
        }
    };
    text.push_str(&format!("{is}: the interval of a time is wider by that."));
    if run.samples.iter().any(|sample| !sample.has_stages()) {
        text.push_str(" A program is given all samples, and their time is in its time.");
    }
    text
}

/// Every method in every front: both values, and who beats it in both.
fn standings<'a>(study: &Study, found: &'a Decision<'a>) -> Table {
    let rows = found.each().flat_map(|(of, fronts)| {
        let of_front = move |front: &'a Front| front.points.iter().map(move |point| (of, front.axes, point));
        fronts.iter().flat_map(of_front)
    });
    let table = Columns::over(rows)
        .column("object", "Object", |(of, ..)| Cell::text(&of.object.name))
        .column("front", "In", |(_, axes, _)| Cell::text(axes.label()))
        .column("method", "Method", |(.., point)| Cell::text(point.method))
        .column("standing", "Standing", |(.., point)| Cell::text(standing(point).0))
        .column("by", "Beaten by", |(.., point)| match standing(point).1 {
            [] => Cell::Missing,
            by => Cell::text(list(&by.iter().map(MethodId::to_string).collect::<Vec<_>>())),
        })
        .columns_of([("x", "First"), ("y", "Second")].into_iter().enumerate(), |all, (i, (name, heading))| {
            let end = |(_, axes, point): &(_, Axes, &FrontPoint), end: fn(&Estimate) -> f64| {
                let end = Some(end(&point.at[i])).filter(|end| !point.at[i].is_exact() && end.is_finite());
                Cell::number(end, decimals(*axes)[i])
            };
            all.column(name, heading, |(_, axes, point)| Cell::Number(point.at[i].value, decimals(*axes)[i]))
                .column(format!("{name}_low"), "from", |row| end(row, |of| of.low))
                .column(format!("{name}_high"), "to", |row| end(row, |of| of.high))
        })
        .into_table("fronts", "Methods that another method beats in two quantities at once");
    let table = table.with_note(
        "First: time in seconds, or triangles. Second: mean error in edges of the object's benchmark cubes, or worth in log-odds above the \
         mean of all methods. Intervals are at 95 %. Beaten: another method is better in one and as good in the other, beyond both intervals. \
         Perhaps beaten: by the estimates alone. A time's interval is wider by what runs of one program differ by.",
    );
    match region::sentence(study, "Errors and triangles") {
        Some(note) => table.with_note(note),
        None => table,
    }
}

/// In words, and who beats it.
fn standing(point: &FrontPoint) -> (&'static str, &[MethodId]) {
    match &point.standing {
        Standing::OnFront => ("on the front", &[]),
        Standing::PerhapsBeaten(by) => ("perhaps beaten", by),
        Standing::Beaten(by) => ("beaten", by),
    }
}

/// Decimals of both quantities.
fn decimals(axes: Axes) -> [usize; 2] {
    match axes {
        Axes::TimeError => [6, 4],
        Axes::TrianglesError => [0, 4],
        Axes::TimePreference => [6, 3],
    }
}

/// `0.8 to 2.1 %`, or one number where both are printed alike.
fn percents(shares: [f64; 2]) -> String {
    let [low, high] = shares.map(|share| number(100.0 * share, 1));
    let [low, high] = [low, high].map(|text| text.trim_end_matches(".0").to_owned());
    if low == high { format!("{low} %") } else { format!("{low} to {high} %") }
}

/// `0.12 to 0.67`, or one number where both are printed alike: about two digits that count.
fn ranged(values: &[f64]) -> String {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shown = |value: f64| {
        let decimals = match value.abs() {
            size if size >= 10.0 => 0,
            size if size >= 1.0 => 1,
            size if size >= 0.1 => 2,
            _ => 3,
        };
        match decimals {
            0 => whole(value.round() as u64),
            _ => number(value, decimals),
        }
    };
    let (low, high) = (shown(low), shown(high));
    if low == high { low } else { format!("{low} to {high}") }
}
