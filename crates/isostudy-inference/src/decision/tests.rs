use super::*;
use crate::Liking;
use crate::fixture::{self, Everything};
use isostudy_design::ConfigurationId;
use isostudy_design::record::{ChunkTimes, MeshRecord, Purpose};

fn exact(x: f64, y: f64) -> [f64; 2] {
    [x, y]
}

/// The paper's study with times and errors that are known: by place of the method, milliseconds and mean distance in cube edges.
fn planted(values: &[[f64; 2]]) -> Everything {
    let mut all = Everything::of(fixture::study());
    let place = |id: &ConfigurationId| all.study.place(id.method);
    for sample in &mut all.bench.samples {
        let [ms, _] = values[place(&sample.id)];
        // A scatter of 1 % that the median sees nothing of.
        let scatter = 1.0 + 0.01 * (f64::from(sample.iteration % 3) - 1.0);
        sample.total_s = 1e-3 * ms * scatter + sample.normals_s;
    }
    for mesh in &mut all.meshes {
        let [_, error] = values[place(&mesh.id)];
        plant_error(mesh, error);
    }
    all
}

fn plant_error(mesh: &mut MeshRecord, error: f64) {
    let mean = error * mesh.spacing;
    mesh.accuracy.distance.mean = 0.5 * mean;
    mesh.accuracy.distance.sd = 0.01 * mean;
    let back = mesh.accuracy.distance_to_mesh.as_mut().unwrap();
    (back.mean, back.sd) = (mean, 0.01 * mean);
}

/// By hand: a beats c in both; b is faster than a and worse; d has a's time and error to within the intervals and is a little worse.
#[test]
fn who_is_beaten_in_both_is_named_with_those_who_beat_them() {
    let values = [
        exact(10.0, 0.10),
        exact(5.0, 0.30),
        exact(20.0, 0.20),
        exact(10.02, 0.10001),
        exact(4.0, 0.5),
        exact(30.0, 0.05),
    ];
    let all = planted(&values);
    let ids = all.study.method_ids();
    let objects = candidates(&all.inputs(), &[]);
    assert_eq!(objects.len(), 3);
    for of in &objects {
        let fronts = fronts(of);
        let front = fronts.iter().find(|front| front.axes == Axes::TimeError).unwrap();
        let standings: Vec<&Standing> = front.points.iter().map(|point| &point.standing).collect();
        let want = [
            Standing::OnFront,
            Standing::OnFront,
            Standing::Beaten(vec![ids[0], ids[3]]),
            Standing::PerhapsBeaten(vec![ids[0]]),
            Standing::OnFront,
            Standing::OnFront,
        ];
        assert_eq!(standings, want.iter().collect::<Vec<_>>(), "{}", of.object.name);
        assert!((front.points[0].at[0].value - 0.010).abs() < 1e-12);
        assert!((front.points[0].at[1].value - 0.10).abs() < 1e-12, "the larger of both directions");
    }
}

#[test]
fn the_best_of_each_want_is_picked_with_its_price() {
    let values = [
        exact(10.0, 0.10),
        exact(5.0, 0.30),
        exact(20.0, 0.20),
        exact(5.01, 0.40),
        exact(8.0, 0.5),
        exact(30.0, 0.05),
    ];
    let mut all = planted(&values);
    let ids = all.study.method_ids();
    // The fastest has a fault on every object, so that another is the fastest without one.
    for mesh in all.meshes.iter_mut().filter(|mesh| mesh.purpose == Purpose::Benchmark) {
        mesh.topology.boundary_edges = 0;
        if mesh.id.method == ids[1] {
            mesh.topology.self_intersections = Some(7);
        }
    }
    let objects = candidates(&all.inputs(), &[]);
    let picks = picks(&objects);
    let of = |goal: Goal| -> Vec<&Pick<'_>> { picks.iter().filter(|pick| pick.want.goal == goal).collect() };
    let [fastest] = of(Goal::Fastest)[..] else { panic!("one method is the fastest on all objects") };
    assert_eq!((fastest.method.id, fastest.on.len()), (ids[1], 3));
    assert_eq!(fastest.on[0].alike, [ids[3]], "5.01 is within 1 % of 5");
    assert_eq!(fastest.on[0].next.unwrap().0.id, ids[3]);
    assert_eq!(fastest.on[0].cost.crossing_triangles, 7);
    assert!((fastest.on[0].cost.error.unwrap() - 6.0).abs() < 1e-9);
    assert_eq!(of(Goal::Faultless)[0].method.id, ids[3]);
    let time = of(Goal::Faultless)[0].on[0].cost.time.unwrap();
    assert!((time - 1.002).abs() < 1e-6, "beside the fastest of all, faults or none: {time}");
    let [closest] = of(Goal::Closest)[..] else { panic!("one is the closest on all") };
    assert_eq!(closest.method.id, ids[5]);
    assert!((closest.on[0].cost.time.unwrap() - 6.0).abs() < 0.05);
    assert!(of(Goal::ClosestPerTriangle).is_empty(), "nothing is matched in the paper's study");
}

/// Which of two is faster by 1 in 500 is chance; which is closer is not.
#[test]
fn of_those_not_told_apart_in_time_the_closest_is_taken() {
    // The third is no closer than the fourth as far as can be told, and slower.
    let all = planted(&[[10.0, 0.1], [5.0, 0.4], [5.02, 0.299999], [5.01, 0.3], [8.0, 0.2], [30.0, 0.05]]);
    let ids = all.study.method_ids();
    let objects = candidates(&all.inputs(), &[]);
    let picks = picks(&objects);
    let fastest = picks.iter().find(|pick| pick.want.goal == Goal::Fastest).unwrap();
    assert_eq!((fastest.method.id, fastest.on.len()), (ids[3], 3));
    let best = &fastest.on[0];
    assert_eq!((best.next.unwrap().0.id, &best.alike[..]), (ids[1], &[ids[1], ids[2]][..]));
    assert!((best.value.value - 5.01).abs() < 1e-9);
    assert!((best.cost.time.unwrap() - 1.002).abs() < 1e-6 && (best.cost.error.unwrap() - 6.0).abs() < 1e-9);
}

/// Places differ a hundredfold, methods by a few per cent; what is asked of all at one place is compared there.
#[test]
fn chunks_and_edits_are_compared_one_by_one() {
    // Runs of one program may differ by 5 %, where nobody measured by how much.
    for (third, alike) in [(1.06, None), (1.04, Some(2))] {
        one_by_one(third, alike);
    }
}

fn one_by_one(third: f64, alike: Option<usize>) {
    let all = planted(&[[10.0, 0.1], [5.0, 0.4], [20.0, 0.3], [6.0, 0.2], [8.0, 0.2], [30.0, 0.05]]);
    let ids = all.study.method_ids();
    let place = |i: usize| 1e-4 * 1.6f64.powi(i as i32);
    // The second is as fast as the first, here and there; the third is slower everywhere; the others by half.
    let share = |method: usize, i: usize| match method {
        0 => 1.0,
        1 => [0.99, 1.01, 1.001, 0.998][i % 4],
        2 => third,
        _ => 1.5,
    };
    let mut chunks = Vec::new();
    for object in &all.study.file.objects {
        for (method, &id) in ids.iter().enumerate() {
            let times: Vec<f64> = (0..10).map(|i| place(i) * share(method, i)).collect();
            chunks.push(ChunkTimes {
                id: ConfigurationId { object: object.id.clone(), method: id },
                cells: 32,
                chunks: 12,
                timed: 10,
                // Three rounds; the last was disturbed.
                chunk_s: [&times[..], &times, &[1.0; 10]].concat(),
                edit_chunks: vec![1; 10],
                edit_s: times,
                open_seam_edges: 0,
                is_whole: true,
            });
        }
    }
    let inputs = crate::inputs::Inputs { chunks: &chunks, ..all.inputs() };
    let objects = candidates(&inputs, &[]);
    let picks = picks(&objects);
    for goal in [Goal::Chunk, Goal::Edit] {
        let [pick] = picks.iter().filter(|pick| pick.want.goal == goal).collect::<Vec<_>>()[..] else {
            panic!("{goal:?}: one on all objects")
        };
        assert_eq!((pick.method.id, pick.on.len()), (ids[0], 3), "{goal:?}: of two alike the closer");
        assert_eq!(
            pick.on[0].alike,
            alike.map_or(vec![ids[1]], |third| vec![ids[1], ids[third]]),
            "{goal:?}"
        );
        let middle = 1e3 * (place(4) + place(5)) / 2.0;
        assert!((pick.on[0].value.value - middle).abs() < 1e-9, "{goal:?}: {}", pick.on[0].value.value);
    }
}

/// On a busy machine intervals are wide; who takes twice the time is not the fastest all the same.
#[test]
fn who_is_much_slower_is_not_taken_for_the_fastest() {
    let mut all = planted(&[[10.0, 0.1], [5.0, 0.4], [20.0, 0.3], [6.0, 0.2], [8.0, 0.2], [30.0, 0.05]]);
    let ids = all.study.method_ids();
    for (i, sample) in all.bench.samples.iter_mut().enumerate() {
        // Every third round takes ten times as long, so that all intervals meet.
        sample.total_s *= if sample.iteration % 3 == 0 { 10.0 } else { 1.0 + 1e-9 * i as f64 };
    }
    let objects = candidates(&all.inputs(), &[]);
    let picks = picks(&objects);
    let fastest = picks.iter().find(|pick| pick.want.goal == Goal::Fastest).unwrap();
    assert_eq!((fastest.method.id, fastest.on.len()), (ids[1], 3));
}

/// A method that is exact but for rounding is not a million times as good as the next.
#[test]
fn an_error_below_the_least_that_is_told_apart_counts_as_that() {
    let mut all = planted(&[[10.0, 0.5], [5.0, 0.6], [20.0, 0.02], [5.1, 0.6], [10.0, 0.5], [30.0, 3e-9]]);
    let ids = all.study.method_ids();
    for mesh in all.meshes.iter_mut().filter(|mesh| mesh.id.method == ids[4]) {
        plant_error(mesh, 0.0);
    }
    let objects = candidates(&all.inputs(), &[]);
    assert!(objects.iter().all(ObjectCandidates::has_least_error));
    let picks = picks(&objects);
    let closest: Vec<&Pick<'_>> = picks.iter().filter(|pick| pick.want.goal == Goal::Closest).collect();
    assert_eq!(closest[0].method.id, ids[4], "of two that are exact, the study's first");
    assert_eq!(closest[0].on[0].alike, [ids[5]]);
    let fastest = picks.iter().find(|pick| pick.want.goal == Goal::Fastest).unwrap();
    assert!((fastest.on[0].cost.error.unwrap() - 0.6 / LEAST_ERROR).abs() < 1e-6);
}

/// Davidson's own iteration (1970, J. Am. Statist. Ass. 65:317, section 3) on answers counted from the file by hand, object by object.
#[test]
fn a_preference_is_the_log_worth_less_the_mean_of_all() {
    let all = Everything::of(fixture::study());
    let objects = candidates(&all.inputs(), &Liking::all(&all.study, &all.answers, 0.05));
    let text = std::fs::read_to_string(all.study.responses.as_deref().unwrap()).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    for of in &objects {
        // Of each pair: answers for the first, for neither, for the second.
        let mut pairs: Vec<(usize, usize, [f64; 3])> = Vec::new();
        for comparison in all.study.comparisons.iter().filter(|c| c.left.object == of.object.id) {
            let column = rows[0].iter().position(|name| *name == comparison.question).unwrap();
            let mut counts = [0.0; 3];
            for row in &rows[1..] {
                counts[["L", "NP", "R"].iter().position(|of| *of == row[column].trim()).unwrap()] += 1.0;
            }
            let [a, b] = [&comparison.left, &comparison.right].map(|id| all.study.place(id.method));
            pairs.push((a, b, counts));
        }
        let (mut worths, mut nu) = (vec![1.0_f64; 6], 0.3);
        let is_separated = (0..6).any(|i| {
            let won = |(a, b, [x, t, y]): &(usize, usize, [f64; 3])| match i {
                i if i == *a => x + t,
                i if i == *b => y + t,
                _ => 0.0,
            };
            pairs.iter().map(won).sum::<f64>() == 0.0
        });
        assert!(!is_separated, "{}", of.object.id);
        for _ in 0..20_000 {
            let (mut score, mut weight, mut ties, mut tied) = (vec![0.0; 6], vec![0.0; 6], 0.0, 0.0);
            for &(a, b, [x, t, y]) in &pairs {
                let root = (worths[a] * worths[b]).sqrt();
                let share = (x + t + y) / (worths[a] + worths[b] + nu * root);
                for (i, j, wins) in [(a, b, x), (b, a, y)] {
                    score[i] += 2.0 * wins + t;
                    weight[i] += share * (2.0 + nu * (worths[j] / worths[i]).sqrt());
                }
                ties += t;
                tied += share * root;
            }
            (0..6).for_each(|i| worths[i] = score[i] / weight[i]);
            nu = ties / tied;
        }
        let mean = worths.iter().map(|w| w.ln()).sum::<f64>() / 6.0;
        for candidate in &of.candidates {
            let want = worths[all.study.place(candidate.id())].ln() - mean;
            let found = candidate.preference.unwrap();
            assert!(
                (found.value - want).abs() < 1e-6,
                "{} {}: {found:?} {want}",
                of.object.id,
                candidate.id()
            );
            assert!(found.low <= found.value && found.value <= found.high);
        }
    }
}

#[test]
fn a_look_is_no_method_and_same_cells_are_one_place_on_a_front() {
    let mut all = Everything::of(fixture::study());
    let copy = all.study.methods[0].clone();
    // Another name for the same recipe.
    all.study.methods[1].recipe = copy.recipe;
    let objects = candidates(&all.inputs(), &[]);
    assert_eq!(objects[0].candidates.len(), 5);
}
