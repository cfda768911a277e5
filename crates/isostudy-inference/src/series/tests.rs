use super::*;
use crate::power::{self, Assumptions};
use crate::{fixture, self_test};
use isostudy_design::config::{FormsSection, SideRule};

#[test]
fn every_study_is_in_one_part() {
    for (all, of) in [(10_000, 100), (10, 7), (7, 10), (1, 1), (100, 3), (0, 5), (u64::MAX, Part::MOST)] {
        let parts: Vec<Range<u64>> =
            (1..=of).map(|number| Part::new(number, of).unwrap().studies(all)).collect();
        assert!(parts[0].start == 0 && parts[of as usize - 1].end == all, "{all} {of}");
        assert!(parts.windows(2).all(|of| of[0].end == of[1].start), "{all} {of}");
        let sizes = || parts.iter().map(|own| own.end - own.start);
        assert!(sizes().max().unwrap() - sizes().min().unwrap() <= 1, "{all} {of}");
    }
    assert_eq!(Part::new(3, 100).unwrap().studies(10_000), 200..300);
    for (number, of) in [(0, 3), (4, 3), (0, 0), (1, Part::MOST + 1)] {
        assert_eq!(Part::new(number, of), None, "{number}/{of}");
    }
}

/// All parts of so many, in an order that is none.
fn parts(of: u64, simulated: impl Fn(Part) -> Vec<Series>) -> Vec<(Part, Vec<Series>)> {
    let parts = (1..=of).map(|number| Part::new(number, of).unwrap());
    let mut parts: Vec<(Part, Vec<Series>)> = parts.map(|part| (part, simulated(part))).collect();
    // Multiples of 37 modulo 101 come in no order.
    parts.sort_by_key(|(part, _)| part.number() * 37 % 101);
    assert!(of < 7 || !parts.is_sorted_by_key(|(part, _)| *part));
    parts
}

#[test]
fn the_self_test_is_the_same_in_any_number_of_parts() {
    let (studies, seed) = (30, 4);
    let one = self_test::simulated(studies, seed, Part::WHOLE);
    for of in [1, 2, 7, 100] {
        let parts = parts(of, |part| self_test::simulated(studies, seed, part));
        assert_eq!(whole(self_test::blank(studies), &parts).unwrap(), one, "{of}");
    }
    // Other studies count otherwise, so that equal counts prove something.
    assert_ne!(self_test::simulated(studies, seed + 1, Part::WHOLE), one);
    let outcomes = self_test::Outcomes::of(&one);
    assert!(
        outcomes.probes.iter().all(|of| of.studies == 3) && outcomes.rates.iter().all(|of| of.hits <= 30)
    );
    assert!(outcomes.rates.iter().filter(|rate| rate.counted() == "coverage").all(|rate| rate.hits > 15));
}

#[test]
fn power_is_the_same_in_any_number_of_parts() {
    let mut study = fixture::study();
    let forms: &mut FormsSection = study.file.forms.as_mut().unwrap();
    forms.sides = SideRule::Balanced;
    let assumptions = Assumptions {
        participants: vec![6, 18],
        shares: vec![0.6, 0.77],
        side_biases: vec![0.0, 1.5],
        person_sd: 1.0,
        object_sd: 0.5,
        ties: 0.3,
        way: power::Way::default(),
        studies: 40,
        seed: 3,
    };
    let simulated =
        |assumptions: &Assumptions, part| power::simulated(&study, assumptions, part, &|| ()).unwrap();
    let one = simulated(&assumptions, Part::WHOLE);
    assert_eq!(one.len(), 4);
    let blank = || power::blank(&study, &assumptions).unwrap();
    for of in [1, 2, 7, 100] {
        assert_eq!(whole(blank(), &parts(of, |part| simulated(&assumptions, part))).unwrap(), one, "{of}");
    }
    assert_ne!(simulated(&Assumptions { seed: 4, ..assumptions.clone() }, Part::WHOLE), one);
    let powers = power::powers(&study, &assumptions, &one);
    assert_eq!(powers, power::power(&study, &assumptions, &|| ()));
    // Parts of fewer studies, or of another share, are none of these.
    let fewer = Assumptions { studies: 39, ..assumptions.clone() };
    let other = Assumptions { shares: vec![0.6, 0.7], ..assumptions.clone() };
    for wrong in [fewer, other] {
        let mut mixed = parts(2, |part| simulated(&assumptions, part));
        mixed[1].1 = simulated(&wrong, mixed[1].0);
        assert_eq!(whole(blank(), &mixed), Err(Unfit::Contents(1)), "{wrong:?}");
    }
}

#[test]
fn parts_that_are_no_whole_are_refused() {
    let blank = || vec![Series::blank("a".into(), 10, 2), Series::blank("b".into(), 3, 1)];
    let part = |number: u64, of| {
        let part = Part::new(number, of).unwrap();
        let happened = |things: usize| move |study: u64| vec![u64::from(study % 3 == 1); things];
        (
            part,
            blank().into_iter().zip([2, 1]).map(|(own, n)| own.count(part, happened(n))).collect::<Vec<_>>(),
        )
    };
    let all = vec![part(3, 3), part(1, 3), part(2, 3)];
    let sum = whole(blank(), &all).unwrap();
    assert_eq!((sum[0].counts.as_slice(), sum[1].counts.as_slice()), (&[3, 3][..], &[1][..]));
    assert_eq!((sum[0].studies.clone(), sum[0].all), (0..10, 10));
    assert_eq!(whole(blank(), &[]), Err(Unfit::Missing(vec![1])));
    assert_eq!(whole(blank(), &[part(2, 4)]), Err(Unfit::Missing(vec![1, 3, 4])));
    assert_eq!(whole(blank(), &[part(1, 3), part(2, 3), part(1, 3)]), Err(Unfit::Twice([0, 2])));
    assert_eq!(whole(blank(), &[part(1, 3), part(2, 3), part(3, 4)]), Err(Unfit::Cuts([0, 2])));
    let changes: [fn(&mut Vec<Series>); 7] = [
        |of| of[0].name = "c".into(),
        |of| of[1].all = 4,
        |of| of[0].studies.start += 1,
        |of| of[0].counts[1] = 5,
        |of| of[0].counts[1] = u64::MAX,
        |of| of[0].counts.truncate(1),
        |of| of.truncate(1),
    ];
    for (number, change) in changes.iter().enumerate() {
        let mut wrong = all.clone();
        change(&mut wrong[2].1);
        assert_eq!(whole(blank(), &wrong), Err(Unfit::Contents(2)), "{number}");
    }
}
