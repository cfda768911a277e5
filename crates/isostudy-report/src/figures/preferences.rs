//! Preference factors: per object with intervals, and the paper's sums.

use super::axis::Axis;
use super::bars::{Bar, BarPanel, Cluster, Slot, largest, rows_of_panels};
use super::canvas::{BLACK, WHITE};
use super::draft::Unfinished;
use super::legend::Swatch;
use super::sheet::Sheet;
use super::style::{self, Fill};
use isostudy_design::published::PreferenceKind;
use isostudy_design::{MethodId, Study};
use isostudy_inference::fraction::Fraction;
use isostudy_inference::preference::{self, GroupFactor, interval};
use isostudy_inference::tally::Tally;

const ROW: f64 = 420.0;
const OVERALL: f64 = 440.0;
/// How much of the width the shares of showings have.
const LARGE: f64 = 0.62;

pub(super) fn per_object(study: &Study, tally: &Tally, sheet: Sheet) -> Unfinished {
    let legend = vec![
        (Swatch::Whisker, "95 % interval over respondents".into()),
        (Swatch::Dashes, "largest possible".into()),
    ];
    let row = |groups: Vec<usize>| -> Vec<(f64, BarPanel)> {
        let share = 1.0 / groups.len() as f64;
        groups.into_iter().map(|group| (share, group_panel(study, tally, group))).collect()
    };
    let rows = rows_of_groups(study).into_iter().map(row).collect();
    let canvas = rows_of_panels(sheet, &legend, rows, ROW);
    let caption = "Preference factors per object and comparison group: answers for a configuration over all answers to \
                   the group's questions. Intervals count each respondent as one observation; they are cut at 0 and \
                   at the largest possible factor."
        .into();
    Unfinished { name: "preference_objects", caption, canvas }
}

/// Groups with questions, in rows of up to three; a row holds groups of one size.
fn rows_of_groups(study: &Study) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = Vec::new();
    for (g, group) in study.groups.iter().enumerate().filter(|(_, group)| !group.comparisons.is_empty()) {
        let fits =
            |row: &Vec<usize>| row.len() < 3 && study.groups[row[0]].members.len() == group.members.len();
        match rows.last_mut().filter(|row| fits(row)) {
            Some(row) => row.push(g),
            None => rows.push(vec![g]),
        }
    }
    rows
}

/// What a method is called among those of its group: the level in which they differ, since the heading names the rest.
fn in_group(study: &Study, group: usize, method: MethodId) -> String {
    let level = match study.groups[group].members[..] {
        [first, second, ..] => study.level_of(method, study.difference(first, second)),
        _ => None,
    };
    level.map_or(study.method(method).label.clone(), |level| study.level(level).label.clone())
}

fn group_panel(study: &Study, tally: &Tally, group: usize) -> BarPanel {
    let mut cap: f64 = 0.0;
    let mut clusters = Vec::new();
    for (o, object) in study.file.objects.iter().enumerate() {
        let factors = preference::group_factors(study, tally, |other| other == o);
        let of_group: Vec<&GroupFactor> = factors.iter().filter(|f| f.group == group).collect();
        cap = of_group.iter().map(|f| f.cap().value()).fold(cap, f64::max);
        let slot = |factor: &&GroupFactor| Slot {
            label: in_group(study, group, factor.method),
            bars: vec![Bar {
                interval: interval(tally, factor, o),
                ..Bar::of(Some(factor.share.factor().value()), style::method(study, factor.method), None)
            }],
        };
        if !of_group.is_empty() {
            let label = object.name.clone();
            clusters.push(Cluster { label, slots: of_group.iter().map(slot).collect() });
        }
    }
    BarPanel {
        heading: format!("{}: {}", study.groups[group].id, study.groups[group].label),
        cap: Some(cap),
        ..BarPanel::of("preference factor", Axis::up_to(1.0), clusters)
    }
}

/// Whether a group compares levels of the first of two factors: its part of a sum is drawn accordingly.
fn compares_first(study: &Study, group: usize) -> bool {
    let group = &study.groups[group];
    preference::two_factors(study).is_some_and(|[outer, _]| preference::shared(study, group, outer).is_none())
}

/// The largest factor that a method of a group can reach where everybody answers: the questions that show it over all.
fn largest_of_complete(study: &Study, group: usize) -> Option<Fraction> {
    let group = &study.groups[group];
    let shows = |method: MethodId| {
        let sides = |&&q: &&usize| {
            let asked = &study.comparisons[q];
            asked.left.method == method || asked.right.method == method
        };
        group.comparisons.iter().filter(sides).count()
    };
    let most = group.members.iter().map(|&method| shows(method)).max()?;
    (most > 0).then(|| Fraction::new(most as i128, group.comparisons.len() as i128))
}

/// Which half of a sum weighs more where everybody answers, and why; nothing if both reach equally far or there is one alone.
fn weights(study: &Study) -> String {
    let Some([outer, inner]) = preference::two_factors(study) else { return String::new() };
    let [outer, inner] = [outer, inner].map(|factor| study.factor(factor).name.as_str());
    let reach = |of_outer| {
        let of_kind = (0..study.groups.len()).filter(|&group| compares_first(study, group) == of_outer);
        of_kind
            .filter_map(|group| largest_of_complete(study, group))
            .max_by(|a, b| a.value().total_cmp(&b.value()))
    };
    let (Some(of_outer), Some(of_inner)) = (reach(true), reach(false)) else { return String::new() };
    let half = match of_outer.value() - of_inner.value() {
        more if more > 0.0 => outer,
        less if less < 0.0 => inner,
        _ => return String::new(),
    };
    let [of_outer, of_inner] = [of_outer, of_inner].map(|cap| {
        let text = cap.to_string();
        text.strip_suffix("/1").map_or(text.clone(), str::to_owned)
    });
    format!(
        " A factor of {} {outer} group can reach {of_outer}, one of {} {inner} group {of_inner}, so the sum weighs the {half} \
         half more.",
        preference::article(outer),
        preference::article(inner)
    )
}

pub(super) fn overall(study: &Study, tally: &Tally, sheet: Sheet) -> Unfinished {
    let factors = preference::group_factors(study, tally, |_| true);
    let published = |method: MethodId| {
        let mut cells = study.published.preferences.iter();
        cells.find(|c| c.kind == PreferenceKind::Overall && c.method() == Some(method)).map(|c| c.factor)
    };
    let slot = |(method, sum): (MethodId, Fraction)| {
        let fill = style::method(study, method);
        let of_method = factors.iter().filter(|f| f.method == method);
        let segment = |f: &GroupFactor| {
            let of_outer = compares_first(study, f.group);
            (f.share.factor().value(), if of_outer { fill.striped() } else { fill })
        };
        let bar = Bar {
            segments: of_method.map(segment).collect(),
            published: published(method),
            label: Some(format!("{:.3}", sum.value())),
            interval: None,
        };
        Slot { label: study.method(method).label.clone(), bars: vec![bar] }
    };
    let slots: Vec<Slot> = preference::overall(study, &factors).into_iter().map(slot).collect();
    let mut legend = Vec::new();
    let white = Fill { outline: BLACK, ..Fill::plain(WHITE) };
    if let Some([outer, inner]) = preference::two_factors(study) {
        let any = |of_outer| factors.iter().any(|f| compares_first(study, f.group) == of_outer);
        let from = |factor| format!("from {} groups", study.factor(factor).name);
        if any(false) {
            legend.push((Swatch::Area(white), from(inner)));
        }
        if any(true) {
            legend.push((Swatch::Area(white.striped()), from(outer)));
        }
    }
    if slots.iter().flat_map(|s| &s.bars).any(|bar| bar.published.is_some()) {
        legend.push((Swatch::Diamond, "published".into()));
    }
    let share = |(id, share): (MethodId, Fraction)| {
        let bar = Bar {
            label: Some(format!("{:.0} %", 100.0 * share.value())),
            ..Bar::of(Some(share.value()), style::method(study, id), None)
        };
        Slot { label: study.method(id).label.clone(), bars: vec![bar] }
    };
    let all = |slots| vec![Cluster { label: "all objects".into(), slots }];
    let shares = all(preference::showings_won(study, &factors).into_iter().map(share).collect());
    let shares = BarPanel {
        heading: "share of showings that were won".into(),
        ..BarPanel::of("wins / showings", Axis::up_to(1.0), shares)
    };
    let clusters = all(slots);
    let panel = BarPanel {
        heading: "as published: sums of factors".into(),
        ..BarPanel::of("sum of preference factors", Axis::from_zero(1.05 * largest(&clusters)), clusters)
    };
    let rows = vec![vec![(LARGE, shares), (1.0 - LARGE, panel)]];
    let canvas = rows_of_panels(sheet, &legend, rows, OVERALL);
    let mut caption = String::from(
        "Overall preference. First: in what share of the answers that showed a method it was chosen. Methods met different \
         others, so these shares are not one scale; the figure of worths is. Second: as published, the sum of a configuration's \
         factors over its comparison groups.",
    );
    caption.push_str(&weights(study));
    Unfinished { name: "preference_overall", caption, canvas }
}
