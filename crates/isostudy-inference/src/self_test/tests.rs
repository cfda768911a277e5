use super::*;

/// How so many studies with one defect came out.
fn hits_of(design: Design, defect: Defect, of: [u64; 2]) -> Hits {
    Hits::of(design, defect, &probes_of(design, defect, of, Part::WHOLE))
}

#[test]
fn every_probe_finds_its_defect_and_no_other() {
    let all = probes(400, 11, Part::WHOLE);
    for (place, (design, defect)) in rows().enumerate() {
        let of = Hits::of(design, defect, &all[place]);
        for probe in Probe::ALL {
            let share = of.share(probe);
            let own = of.defect.probe() == Some(probe);
            let asked = of.defect.is_told_by(of.design) && !of.never_answerable(probe);
            // 0.02 of forty studies is one; chance makes up to four of it.
            let sound =
                if own { !asked || share >= 0.9 } else { share <= 0.1 || of.defect.may_be_seen_by(probe) };
            assert!(sound, "{probe:?} on {:?}, {:?}: {share}", of.design, of.defect);
        }
    }
}

#[test]
fn who_presses_one_button_makes_no_object_interaction() {
    let defects = [Defect::PressingLeft, Defect::PressingLeftAlike];
    for (design, defect) in Design::ALL.into_iter().flat_map(|design| defects.map(|defect| (design, defect)))
    {
        let of = hits_of(design, defect, [500, 1]);
        let share = of.share(Probe::ObjectInteraction);
        // Of 500 studies ten are 0.02. Those who press made it 0.04 to 0.06 of studies where they were not left out.
        assert!(share <= 0.02, "{design:?}, {defect:?}: {share}");
    }
}

#[test]
fn what_cannot_be_told_is_said() {
    let cannot = |probe, defect, design| {
        let one = hits_of(design, defect, [1, 5]);
        one.never_answerable(probe)
    };
    let sound = Defect::None { preferences: true, side: 0 };
    assert!(cannot(Probe::OutlyingRespondent, sound, Design::TwoMethods));
    assert!(cannot(Probe::CopiedRows, Defect::CopiedRows, Design::TwoMethods));
    assert!(!cannot(Probe::CopiedRows, sound, Design::TwoMethods));
    assert!(!cannot(Probe::SwappedKey, sound, Design::TwoMethods));
}

fn with_hits(rate: &Rate, hits: u64) -> Rate {
    let mut other = rate.clone();
    other.hits = hits;
    other
}

#[test]
fn a_rate_out_of_its_limits_fails() {
    let all = rates::of(&rates(200, 8, Part::WHOLE));
    let named = |method: &str| all.iter().find(|rate| rate.method == method).unwrap();
    let t = named("mean score, t interval");
    assert!(t.sound() && t.limits().is_some());
    assert!(!with_hits(t, t.studies / 2).sound());
    // What is there for comparison is far off and fails nothing.
    let naive = named("binomial over all answers");
    assert!(naive.share() > 0.1 && naive.sound() && naive.limits().is_none());
    let flip = named("sign-flip, 9 questions");
    assert!(flip.sound() && !with_hits(flip, flip.studies / 4).sound());
    // Three standard errors are 0.065 of 0.95 and 0.042 of 0.02 in a hundred studies; with ten thousand nothing is allowed.
    let hits = |found, studies| Hits {
        design: Design::Latin,
        defect: Defect::None { preferences: false, side: 8 },
        found,
        unanswerable: [0; 6],
        studies,
    };
    let few = hits([88, 6, 7, 0, 0, 0], 100);
    assert!(!few.sound(Probe::Side) && few.sound(Probe::OutlyingRespondent) && !few.sound(Probe::CopiedRows));
    assert!(hits([89, 0, 0, 0, 0, 0], 100).sound(Probe::Side));
    let many = hits([9499, 200, 201, 0, 0, 0], 10_000);
    assert!(
        !many.sound(Probe::Side) && many.sound(Probe::OutlyingRespondent) && !many.sound(Probe::CopiedRows)
    );
    let mut coverage = with_hits(t, 100);
    coverage.studies = 100;
    assert_eq!(coverage.limits().map(|(_, high)| high), Some(1.0));
}
