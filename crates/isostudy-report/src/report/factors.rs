//! What the published sums of preference factors hide.

use super::evidence::Evidence;
use super::names;
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{against, capital, counted, list, number};
use isostudy_design::contrast::Over;
use isostudy_design::{Level, MethodId, Study};
use isostudy_inference::fraction::Fraction;
use isostudy_inference::hypotheses::Target;
use isostudy_inference::preference::{self, GroupFactor, group_factors, margins, overall, two_factors};
use isostudy_inference::tally::Tally;

pub(super) fn findings(study: &Study, tally: &Tally, evidence: &Evidence<'_>) -> Vec<Block> {
    let factors = group_factors(study, tally, |_| true);
    let found = [
        two_scales(study, &factors),
        ties_alone(study, &factors),
        difference(study, &factors, evidence),
        favourite(study, tally, &factors),
    ];
    found.into_iter().flatten().map(|text| Block::Finding(Finding::new(Standing::Noted, text))).collect()
}

/// The level of the first of two factors that all members of a group share; `None` for a group that compares such levels.
fn shared(study: &Study, group: usize) -> Option<Level> {
    let [outer, _] = two_factors(study)?;
    preference::shared(study, &study.groups[group], outer)
}

fn text_of(fraction: Fraction) -> String {
    let text = fraction.to_string();
    text.strip_suffix("/1").map_or(text.clone(), str::to_owned)
}

/// Groups of different size have factors on different scales, whoever answered.
fn two_scales(study: &Study, factors: &[GroupFactor]) -> Option<String> {
    let mut caps: Vec<(Fraction, Vec<&str>)> = Vec::new();
    for factor in factors {
        let group = &study.groups[factor.group];
        let shows = |&&c: &&usize| {
            let comparison = &study.comparisons[c];
            [comparison.left.method, comparison.right.method].contains(&factor.method)
        };
        let shown = group.comparisons.iter().filter(shows).count();
        let cap = Fraction::new(shown as i128, group.comparisons.len() as i128);
        match caps.iter_mut().find(|(known, _)| *known == cap) {
            Some((_, groups)) if groups.contains(&group.id.as_str()) => {}
            Some((_, groups)) => groups.push(&group.id),
            None => caps.push((cap, vec![&group.id])),
        }
    }
    (caps.len() > 1).then(|| {
        let parts: Vec<String> = caps
            .iter()
            .map(|(cap, groups)| {
                let noun = if groups.len() == 1 { "group" } else { "groups" };
                format!("{} in {noun} {}", text_of(*cap), list(groups))
            })
            .collect();
        format!(
            "A sum of factors adds numbers on different scales: a factor can reach {}, since a configuration is shown in \
             only some of the questions of a larger group. Wins over appearances have one scale.",
            list(&parts)
        )
    })
}

/// Within one level of the first factor the preference factors of a group of the second add up to one less the share of ties.
fn ties_alone(study: &Study, factors: &[GroupFactor]) -> Option<String> {
    let [outer, inner] = two_factors(study)?.map(|factor| study.factor(factor).name.as_str());
    let mut parts = Vec::new();
    for g in 0..study.groups.len() {
        let own: Vec<&GroupFactor> = factors.iter().filter(|f| f.group == g).collect();
        let (Some(level), Some(first)) = (shared(study, g), own.first()) else { continue };
        let wins: u64 = own.iter().map(|f| f.share.wins).sum();
        parts.push(format!(
            "{wins}/{} on {} ({})",
            first.share.answers,
            names::level(study, level),
            counted(first.share.ties as usize, "tie")
        ));
    }
    (parts.len() > 1).then(|| {
        format!(
            "The {inner} half of {} {outer}'s sums says nothing about {outer}s: within one {outer} the factors always add up to one \
             less the share of ties, {}.",
            preference::article(outer),
            list(&parts)
        )
    })
}

/// The difference between the means of the first factor's two levels, taken apart.
fn difference(study: &Study, factors: &[GroupFactor], evidence: &Evidence<'_>) -> Option<String> {
    let [outer, inner] = two_factors(study)?;
    let sums = overall(study, factors);
    let mean = |level| {
        let of = margins(study, &sums);
        of.into_iter().find(|(of, _)| *of == level).map(|(_, mean)| mean.value())
    };
    let [first, second] = study.levels(outer)[..] else { return None };
    let (a, b) = (mean(first)?, mean(second)?);
    let holds = |method: MethodId, level: Level| study.level_of(method, outer) == Some(level);
    let half = |level: Level, direct: bool| {
        let of = sums.iter().filter(|(m, _)| holds(*m, level)).count() as f64;
        let own = factors.iter().filter(|f| holds(f.method, level));
        let part = own.filter(|f| shared(study, f.group).is_none() == direct);
        part.map(|f| f.share.factor().value()).sum::<f64>() / of
    };
    // Only where the groups of the second factor have one preference factor for each of the same number of methods on both levels
    // do these add up to one less the share of ties.
    let members = |level: Level| {
        let own = factors.iter().filter(|f| holds(f.method, level));
        let mut groups: Vec<usize> =
            own.filter(|f| shared(study, f.group).is_some()).map(|f| f.group).collect();
        groups.dedup();
        let methods = sums.iter().filter(|(m, _)| holds(*m, level)).count();
        (groups.len(), methods)
    };
    let ties: u64 = (0..study.groups.len())
        .filter(|&g| shared(study, g).is_some())
        .filter_map(|g| factors.iter().find(|f| f.group == g).map(|f| f.share.ties))
        .sum();
    if members(first) != members(second) || ties == 0 || a == b {
        return None;
    }
    let by_ties = half(first, false) - half(second, false);
    let direct = half(first, true) - half(second, true);
    let of_contrast = evidence.hypotheses.iter().find(|h| match h.target {
        Target::Contrast { levels, over } => over == Over::All && levels[0].factor == outer,
        _ => false,
    })?;
    let Target::Contrast { levels, .. } = of_contrast.target else { return None };
    let counts = of_contrast.test.counts?;
    let [one, other] = [first, second].map(|level| names::level(study, level));
    Some(format!(
        "The mean sums of {one} and {other} are {} and {}. Of the difference of {}, {} comes from ties in the {} \
         groups and {} from the questions that compare the two directly, where {} has {}.",
        number(a, 3),
        number(b, 3),
        number(a - b, 3),
        number(by_ties, 3),
        study.factor(inner).name,
        number(direct, 3),
        names::level(study, levels[0]),
        against(counts)
    ))
}

/// Who has the largest sum: over all, by wins over appearances, and on each object. A first place may be shared.
fn favourite(study: &Study, tally: &Tally, factors: &[GroupFactor]) -> Option<String> {
    let sums = overall(study, factors);
    let compared = sums.len();
    let (methods, sum) = largest(sums)?;
    if methods.len() == compared {
        return Some(format!("All methods have the same sum, {}.", number(sum.value(), 3)));
    }
    let (by_share, share) = largest(preference::showings_won(study, factors))?;
    let mut objects: Vec<(Vec<MethodId>, Vec<&str>)> = Vec::new();
    for (o, object) in study.file.objects.iter().enumerate() {
        let own = group_factors(study, tally, |other| other == o);
        let Some((best, _)) = largest(overall(study, &own)) else { continue };
        match objects.iter_mut().find(|(known, _)| *known == best) {
            Some((_, names)) => names.push(&object.name),
            None => objects.push((best, vec![&object.name])),
        }
    }
    let together = |methods: &[MethodId]| list(&methods.iter().map(MethodId::to_string).collect::<Vec<_>>());
    let (has, have) = ("has", "have together");
    let verb = |methods: &[MethodId]| if methods.len() == 1 { has } else { have };
    let share_text = match by_share == methods {
        true => format!("and the largest share of wins over appearances, {}", number(share.value(), 3)),
        false => format!(
            "but {} {} the largest share of wins over appearances, {}",
            together(&by_share),
            verb(&by_share),
            number(share.value(), 3)
        ),
    };
    let by_object = match &objects[..] {
        [(best, _)] if *best == methods => {
            format!("on each object {} {} it as well", together(best), verb(best))
        }
        [(best, _)] => format!("on each object {} {} it", together(best), verb(best)),
        _ => {
            let parts: Vec<String> =
                objects.iter().map(|(m, names)| format!("{} on the {}", together(m), list(names))).collect();
            format!("object by object there is no one favourite: the largest sum goes to {}", list(&parts))
        }
    };
    let who = match methods[..] {
        [method] => format!("{} ({method})", capital(&study.method(method).label)),
        _ => together(&methods),
    };
    Some(format!(
        "{who} {} the largest sum, {}, {share_text}. {}.",
        verb(&methods),
        number(sum.value(), 3),
        capital(&by_object)
    ))
}

/// All that share the largest value.
fn largest(values: impl IntoIterator<Item = (MethodId, Fraction)>) -> Option<(Vec<MethodId>, Fraction)> {
    let mut best: Option<(Vec<MethodId>, Fraction)> = None;
    for (method, value) in values {
        match &mut best {
            Some((methods, most)) if *most == value => methods.push(method),
            Some((_, most)) if most.value() >= value.value() => {}
            _ => best = Some((vec![method], value)),
        }
    }
    best
}
