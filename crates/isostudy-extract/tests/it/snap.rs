//! SnapMC against a slow and obvious one, its published numbers, and the bounds of its angles.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec3, Vec3};
use isostudy_cells::{Cell, Label, Point};
use isostudy_extract::{
    BoxGrid, ChunkExtractor, ChunkSettings, Cubes, Execution, Extraction, Extractor, Flat, Grid, Method,
    MethodError, SnapCubes, Source, from_fn, weld_chunks,
};
use isostudy_field::{Asteroid, Gyroid, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const ONE: Execution = Execution { threads: 1 };

const BOTH: [Flat; 2] = [Flat::Both, Flat::Neither];

fn snapped(gamma: f32, flat: Flat) -> Method {
    Method::SnapCubes(SnapCubes::default().with_gamma(gamma).with_flat(flat))
}

fn grid(counts: [usize; 3]) -> BoxGrid {
    let max = Vec3::from_array(counts.map(|n| (n - 1) as f32));
    BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 }
}

fn of_samples(method: &Method, counts: [usize; 3], values: &[f32], isovalue: f32) -> TriangleMesh {
    let source = Source::Samples(values);
    method.extract(&mut Extractor::new(), source, &grid(counts), isovalue, &ONE).unwrap().mesh
}

/// SnapMC as one would write it first, corner positions of each triangle in the order of cells.
fn obvious(
    values: &[f32],
    [nx, ny, nz]: [usize; 3],
    isovalue: f32,
    gamma: f32,
    flat: Flat,
) -> Vec<[DVec3; 3]> {
    type Place = [usize; 3];
    let cube = Cell::cube();
    let places = || (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
    let level = f64::from(isovalue);
    let at = |p: Place| f64::from(values[(p[2] * ny + p[1]) * nx + p[0]]) - level;
    let corner = |p: Place, c: usize| [p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)];
    let is_cell = |p: &Place| p[0] + 1 < nx && p[1] + 1 < ny && p[2] + 1 < nz;
    let point = |p: Place| DVec3::from_array(p.map(|x| x as f64));
    let crossing = |p: Place, q: Place| point(p).lerp(point(q), at(p) / (at(p) - at(q)));

    // On the box, with nothing inside next to it on a side that both are on.
    let is_wall = |p: Place| {
        let last = [nx - 1, ny - 1, nz - 1];
        let on = |p: Place, axis: usize| [p[axis] == 0, p[axis] == last[axis]];
        let share = |q: Place| (0..3).any(|axis| (0..2).any(|end| on(p, axis)[end] && on(q, axis)[end]));
        let is_near = |q: &Place| (0..3).all(|axis| p[axis].abs_diff(q[axis]) <= 1);
        share(p) && places().filter(is_near).all(|q| !share(q) || at(q) <= 0.0)
    };
    let mut label: HashMap<Place, Label> = HashMap::new();
    let mut position: HashMap<Place, DVec3> = HashMap::new();
    for p in places() {
        label.insert(p, if at(p) > 0.0 { Label::Inside } else { Label::Outside });
    }
    for cell in places().filter(is_cell) {
        let corners: Vec<Place> = (0..8).map(|c| corner(cell, c)).collect();
        if corners.iter().any(|&p| at(p) > 0.0) {
            for &p in corners.iter().filter(|&&p| at(p) == 0.0 && !is_wall(p)) {
                label.insert(p, Label::On);
                position.insert(p, point(p));
            }
        }
    }
    // Requests: at a point, by how near the crossing is and then by the number of the other end.
    let mut asked: BTreeMap<Place, Vec<(f64, [usize; 3], DVec3)>> = BTreeMap::new();
    for p in places() {
        for axis in 0..3 {
            let mut q = p;
            q[axis] += 1;
            if q[0] >= nx || q[1] >= ny || q[2] >= nz || at(p) * at(q) >= 0.0 {
                continue;
            }
            let way = (at(p) / (at(p) - at(q))).abs();
            let reversed = |p: Place| [p[2], p[1], p[0]];
            if way <= f64::from(gamma) {
                asked.entry(p).or_default().push((way, reversed(q), crossing(p, q)));
            } else if (at(q) / (at(p) - at(q))).abs() <= f64::from(gamma) {
                let way = (at(q) / (at(p) - at(q))).abs();
                asked.entry(q).or_default().push((way, reversed(p), crossing(p, q)));
            }
        }
    }
    // A wall drawn onto the box would be the box.
    asked.retain(|&p, _| !is_wall(p));
    for (p, mut requests) in asked {
        requests.sort_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap());
        label.insert(p, Label::On);
        position.insert(p, requests[0].2);
    }
    let mut triangles = Vec::new();
    let mut in_faces: HashMap<Vec<Place>, usize> = HashMap::new();
    for cell in places().filter(is_cell) {
        let labels: Vec<Label> = (0..8).map(|c| label[&corner(cell, c)]).collect();
        let is_flat = !labels.contains(&Label::Inside);
        for triangle in cube.hull_patch(&labels) {
            let of = |p: Point| match p {
                Point::Corner(c) => position[&corner(cell, usize::from(c))],
                Point::Edge(e) => {
                    let [a, b] = cube.edges()[usize::from(e)].map(|c| corner(cell, usize::from(c)));
                    crossing(a, b)
                }
            };
            let mut key = Vec::new();
            if is_flat && triangle.iter().all(|p| matches!(p, Point::Corner(_))) {
                key = (0..8).map(|c| corner(cell, c)).filter(|p| label[p] == Label::On).collect();
            }
            triangles.push((key.clone(), triangle.map(of)));
            if !key.is_empty() {
                *in_faces.entry(key).or_insert(0) += 1;
            }
        }
    }
    // A flat patch that both cells at a face have is left out, and one on the box that faces in.
    let on_box = |key: &[Place]| {
        (0..3).any(|axis| {
            let last = [nx, ny, nz][axis] - 1;
            [0, last].into_iter().any(|x| key.iter().all(|p| p[axis] == x))
        })
    };
    let is_kept = |(key, _): &(Vec<Place>, _)| {
        let of_one_cell = if key.len() == 3 { 1 } else { 2 };
        let is_face = (0..3).any(|axis| key.iter().all(|p| p[axis] == key[0][axis]));
        flat == Flat::Both || key.is_empty() || !is_face || (in_faces[key] == of_one_cell && !on_box(key))
    };
    triangles.into_iter().filter(is_kept).map(|(_, triangle)| triangle).collect()
}

/// The triangles are the obvious ones, cell by cell, with samples given and called and on any number of threads.
#[test]
fn it_is_the_obvious_one() {
    let mut random = Pcg64Mcg::seed_from_u64(4);
    for (n, counts) in [[2, 2, 2], [5, 4, 7], [3, 9, 2], [64, 3, 3], [65, 4, 3], [66, 3, 40], [9, 9, 70]]
        .into_iter()
        .enumerate()
    {
        for levels in [1, 2, 10, 1000] {
            let samples: Vec<f32> =
                (0..counts.iter().product()).map(|_| random.random_range(-levels..=levels) as f32).collect();
            let called = Given { counts, values: samples.clone() };
            for (gamma, flat) in
                [0.0, 0.1, 0.3, 0.5].into_iter().flat_map(|gamma| BOTH.map(|flat| (gamma, flat)))
            {
                let method = snapped(gamma, flat);
                let wanted = obvious(&samples, counts, 0.0, gamma, flat);
                let mut first: Option<Extraction> = None;
                for (source, threads) in [
                    (Source::Samples(&samples), 1),
                    (Source::Samples(&samples), 3),
                    (Source::Study(&called), 1),
                    (Source::Study(&called), 2),
                ] {
                    let what = format!("{n} {levels} {gamma} {flat:?} {threads}");
                    let execution = Execution { threads };
                    let found = method
                        .extract(&mut Extractor::new(), source, &grid(counts), 0.0, &execution)
                        .unwrap();
                    assert_eq!(found.mesh.triangles.len(), wanted.len(), "{what}");
                    for (t, wanted) in wanted.iter().enumerate() {
                        for (is, wanted) in found.mesh.corners(t).into_iter().zip(wanted) {
                            assert!(is.as_dvec3().distance(*wanted) < 2e-4, "{what}: {is} for {wanted}");
                        }
                    }
                    let first = first.get_or_insert_with(|| found.clone());
                    assert_eq!(first.mesh, found.mesh, "{what}");
                }
            }
        }
    }
}

/// With no distance to snap from, and no sample on the level, it is marching cubes with the table of convex hulls.
#[test]
fn without_snapping_it_is_the_hull_table() {
    let cube = Cell::cube();
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for _ in 0..200 {
        let values: Vec<f32> = (0..125).map(|_| random.random_range(-1.0..1.0)).collect();
        let mesh = of_samples(&snapped(0.0, Flat::Both), [5; 3], &values, 0.0);
        let mut t = 0;
        for cell in (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]) {
            let place = |c: usize| [cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)];
            let at = |c: u8| {
                let [x, y, z] = place(usize::from(c));
                f64::from(values[(z * 5 + y) * 5 + x])
            };
            let label = |c| if at(c) > 0.0 { Label::Inside } else { Label::Outside };
            for wanted in cube.hull_patch(&(0..8).map(label).collect::<Vec<_>>()) {
                for (is, wanted) in mesh.corners(t).into_iter().zip(wanted) {
                    let Point::Edge(e) = wanted else { panic!("no corner is on the surface") };
                    let [a, b] = cube.edges()[usize::from(e)];
                    let [p, q] = [a, b].map(|c| DVec3::from_array(place(usize::from(c)).map(|x| x as f64)));
                    let wanted = p.lerp(q, at(a) / (at(a) - at(b)));
                    assert!(is.as_dvec3().distance(wanted) < 1e-4);
                }
                t += 1;
            }
        }
        assert_eq!(t, mesh.triangles.len());
    }
}

/// Samples as a field at whole coordinates.
struct Given {
    counts: [usize; 3],
    values: Vec<f32>,
}

impl StudyField for Given {
    fn sample(&self, p: Vec3) -> f32 {
        let [x, y, z] = p.to_array().map(|x| x as usize);
        self.values[(z * self.counts[1] + y) * self.counts[0] + x]
    }
}

/// Where the field rules the surface out nothing is sampled; that must not show, nor may threads.
#[test]
fn pruning_and_threads_do_not_show() {
    struct Plain<'a>(&'a dyn StudyField);
    impl StudyField for Plain<'_> {
        fn sample(&self, p: Vec3) -> f32 {
            self.0.sample(p)
        }
    }
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::new(1.0, 0.93, 1.21) };
    let grid = BoxGrid { bounds, spacing: 0.04 };
    for field in [&Asteroid::default() as &dyn StudyField, &Gyroid { frequency: 14.0 }] {
        let run = |field: &dyn StudyField, threads| {
            let execution = Execution { threads };
            snapped(0.3, Flat::Both)
                .extract(&mut Extractor::new(), field.into(), &grid, 0.0, &execution)
                .unwrap()
                .mesh
        };
        let one = run(field, 1);
        assert!(one.triangles.len() > 2000);
        assert!([2, 5].iter().all(|&threads| run(field, threads) == one));
        assert_eq!(run(&Plain(field), 1), one);
    }
}

/// Boxes of cells weld to the mesh of the whole, to the bit, and so do those of a grid without an end, of whatever size. Many samples
/// equal the isovalue.
#[test]
fn chunks_weld_to_the_whole() {
    let bits = |mesh: &TriangleMesh| {
        let of =
            |points: &[Vec3]| -> Vec<_> { points.iter().map(|p| p.to_array().map(f32::to_bits)).collect() };
        (of(&mesh.positions), of(&mesh.normals), mesh.triangles.clone())
    };
    let mut random = Pcg64Mcg::seed_from_u64(19);
    let counts = [9, 8, 10];
    for (round, gamma) in (0..64).zip([0.0, 0.1, 0.3, 0.5].into_iter().cycle()) {
        let (levels, flat) = ([1, 2, 5, 100][round / 4 % 4], BOTH[round / 16 % 2]);
        let values: Vec<f32> =
            (0..counts.iter().product()).map(|_| random.random_range(-levels..=levels) as f32).collect();
        let method = snapped(gamma, flat);
        let whole = of_samples(&method, counts, &values, 0.0);
        let called = Given { counts, values: values.clone() };
        let settings = ChunkSettings::default();
        let mut extractor = ChunkExtractor::in_box(&grid(counts), &method, &settings).unwrap();
        for (size, source) in [
            (1 + round as u32 % 4, Source::Samples(&values)),
            (1 + round as u32 % 3, Source::Study(&called)),
            (5, Source::Samples(&values)),
        ] {
            let boxes: Vec<_> = extractor.grid(size).collect();
            let parts: Vec<_> =
                boxes.into_iter().map(|cells| extractor.extract(source, cells, &ONE).unwrap()).collect();
            for part in &parts {
                assert!(part.keys.is_sorted() && part.triangle_cells.is_sorted());
            }
            let welded = weld_chunks(&parts).unwrap();
            assert!(bits(&welded) == bits(&whole), "{round} {gamma} {flat:?} {size}");
        }
    }
    let endless = Grid::try_new([16e3, -1e4, 3.1], 0.25).unwrap();
    let ball = from_fn(|p: [f32; 3]| {
        let from = Vec3::from(p) - Vec3::new(16e3, -1e4, 3.1);
        1.8 - from.length() + 0.3 * (5.0 * from.x).sin() * (4.0 * from.y).cos() * (6.0 * from.z).sin()
    });
    for flat in BOTH {
        let settings = ChunkSettings::default();
        let mut extractor = ChunkExtractor::try_new(&endless, &snapped(0.3, flat), &settings).unwrap();
        let mut welded = |size: u32, reach: i32| {
            let n = 2 * reach;
            let ids = (0..n.pow(3)).map(|i| [i % n, i / n % n, i / n / n].map(|at| at - reach));
            let parts: Vec<_> =
                ids.map(|id| extractor.extract(&ball, endless.chunk(id, size), &ONE).unwrap()).collect();
            weld_chunks(&parts).unwrap()
        };
        let (large, small) = (welded(12, 1), welded(3, 4));
        assert!(large.triangles.len() > 500 && bits(&large) == bits(&small), "{flat:?}");
    }
}

/// Every side of a triangle off the box is run as often one way as the other, all vertices are used, and no triangle has a corner
/// twice. Only at the box is the surface open.
#[test]
fn the_surface_has_no_end_off_the_box() {
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let counts = [6, 6, 6];
    for (round, gamma) in (0..400).zip([0.1, 0.2, 0.3, 0.5].into_iter().cycle()) {
        let levels = [1, 2, 5, 100][round / 4 % 4];
        let values: Vec<f32> = (0..216).map(|_| random.random_range(-levels..=levels) as f32).collect();
        let flat = BOTH[round / 16 % 2];
        let mesh = of_samples(&snapped(gamma, flat), counts, &values, 0.0);
        let mut sides: HashMap<[u32; 2], i64> = HashMap::new();
        let mut is_used = vec![false; mesh.positions.len()];
        for &[a, b, c] in &mesh.triangles {
            assert!(a != b && b != c && c != a);
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *sides.entry([from.min(to), from.max(to)]).or_insert(0) += if from < to { 1 } else { -1 };
                is_used[from as usize] = true;
            }
        }
        assert!(is_used.iter().all(|&used| used), "{round}");
        let near_box =
            |v: u32| mesh.positions[v as usize].to_array().into_iter().any(|x| !(0.6..=4.4).contains(&x));
        for (side, sum) in sides {
            assert!(sum == 0 || side.into_iter().all(near_box), "{round}: {side:?}");
        }
        let report = topology(&mesh);
        assert_eq!(
            [report.collapsed_triangles, report.unused_vertices, report.duplicate_faces],
            [0; 3],
            "{round}"
        );
    }
}

/// What is closed off the box in the samples is closed in the mesh.
#[test]
fn a_closed_surface_is_closed() {
    let bounds = Bounds { min: Vec3::splat(-1.3), max: Vec3::splat(1.3) };
    for spacing in [0.3, 0.11, 0.05] {
        let field: &dyn StudyField = &Asteroid::default();
        let grid = BoxGrid { bounds, spacing };
        let mesh = snapped(0.3, Flat::Neither)
            .extract(&mut Extractor::new(), field.into(), &grid, 0.0, &ONE)
            .unwrap()
            .mesh;
        let plain = Method::Cubes(Cubes::default());
        let plain = plain.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &ONE).unwrap().mesh;
        let report = topology(&mesh);
        assert_eq!([report.boundary_edges, report.misoriented_edges], [0; 2], "{spacing}");
        assert!(mesh.triangles.len() < plain.triangles.len() * 3 / 4);
        assert!((mesh.volume() / plain.volume() - 1.0).abs() < 0.02 * f64::from(spacing / 0.1).powi(2));
    }
}

/// A solid that fills its box, whose samples on the box equal the isovalue: a wall is as closed as with marching cubes.
#[test]
fn walls_on_the_box_are_closed() {
    let counts = [9, 8, 7];
    let values: Vec<f32> = (0..9 * 8 * 7)
        .map(|i| {
            let place = [i % 9, i / 9 % 8, i / 72];
            let depth = (0..3).map(|axis| place[axis].min(counts[axis] - 1 - place[axis])).min();
            depth.unwrap_or(0) as f32
        })
        .collect();
    for flat in BOTH {
        let mesh = of_samples(&snapped(0.3, flat), counts, &values, 0.0);
        let report = topology(&mesh);
        assert!(report.is_closed_manifold() && report.euler_characteristic == 2, "{report:?}");
        assert!((mesh.volume() - 8.0 * 7.0 * 6.0).abs() < 8.0 * 7.0 * 6.0 * 0.2, "{}", mesh.volume());
    }
}

#[test]
fn a_distance_that_is_none_is_refused() {
    for gamma in [-0.1, 0.51, f32::NAN, f32::INFINITY] {
        let error = snapped(gamma, Flat::Both).check(&grid([3; 3])).unwrap_err();
        assert!(matches!(error, MethodError::Setting { key: "gamma", .. }));
        assert!(error.to_string().contains("from 0 to 0.5"), "{error}");
        let values = [0.0; 27];
        let made = snapped(gamma, Flat::Both).extract(
            &mut Extractor::new(),
            Source::Samples(&values),
            &grid([3; 3]),
            0.5,
            &ONE,
        );
        assert!(made.is_err());
    }
    assert!([0.0, 0.5].into_iter().all(|gamma| snapped(gamma, Flat::Both).check(&grid([3; 3])).is_ok()));
}

/// The smallest and the largest angle, in degrees.
fn angles(corners: [DVec3; 3]) -> [f64; 2] {
    let angle = |i: usize| {
        let [a, b] = [1, 2].map(|k| corners[(i + k) % 3] - corners[i]);
        a.cross(b).length().atan2(a.dot(b)).to_degrees()
    };
    let all = [0, 1, 2].map(angle);
    [all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(0.0, f64::max)]
}

/// The extremes of edge lengths, areas, angles and radius ratios.
#[derive(Debug)]
struct Shape {
    edge: f64,
    area: f64,
    angles: [f64; 2],
    ratio: f64,
}

impl Shape {
    fn of(mesh: &TriangleMesh) -> Self {
        let mut shape = Self { edge: f64::INFINITY, area: f64::INFINITY, angles: [180.0, 0.0], ratio: 1.0 };
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t).map(|p| p.as_dvec3());
            let [a, b, c] = corners;
            let lengths = [a.distance(b), b.distance(c), c.distance(a)];
            shape.edge = lengths.into_iter().fold(shape.edge, f64::min);
            shape.area = shape.area.min((b - a).cross(c - a).length() / 2.0);
            let [least, most] = angles(corners);
            shape.angles = [shape.angles[0].min(least), shape.angles[1].max(most)];
            shape.ratio = shape.ratio.min(isostudy_cells::radius_ratio(corners.map(|p| p.to_array())));
        }
        shape
    }
}

/// The published row of the Marschner-Lobb volume, isovalue 100 (Raman & Wenger 2008, table 4), from its bytes: `METHODS_DATA` names
/// the folder that has them.
#[test]
fn the_published_row_of_marschner_and_lobb() {
    let path = std::env::var_os("METHODS_DATA")
        .map(|folder| std::path::Path::new(&folder).join("marschner_lobb_41x41x41_u8.raw"))
        .filter(|path| path.is_file());
    let Some(path) = path else {
        eprintln!("SKIPPED: METHODS_DATA names no folder with the volume");
        return;
    };
    let bytes = std::fs::read(path).unwrap();
    let values: Vec<f32> = bytes.iter().map(|&byte| f32::from(byte)).collect();
    let counts = [41; 3];
    let mesh = of_samples(&snapped(0.3, Flat::Both), counts, &values, 100.0);
    let shape = Shape::of(&mesh);
    println!("{} triangles, {shape:?}", mesh.triangles.len());
    let hull = of_samples(&snapped(0.0, Flat::Both), counts, &values, 100.01);
    // From the snapped surface to the other, as the printed number must be: what is lost is farther than that. Over middles of
    // sides and of triangles, since the greatest distance over more points is a little more.
    let surface = isostudy_mesh::metro::Surface::try_new(&hull).unwrap();
    let middles = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|p| p.as_dvec3()));
    let middles =
        middles.flat_map(|[a, b, c]| [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]);
    let hausdorff = middles.map(|p| surface.nearest(p, f64::INFINITY).distance).fold(0.0, f64::max);
    println!("distance {hausdorff}");
    for (name, is, printed, digit) in [
        ("edge", shape.edge, 0.442, 0.001),
        ("area", shape.area, 0.231, 0.001),
        ("smallest angle", shape.angles[0], 14.58, 0.01),
        ("largest angle", shape.angles[1], 122.63, 0.01),
        ("distance", hausdorff, 0.71, 0.01),
    ] {
        assert!((is - printed).abs() <= digit / 2.0, "{name}: {is}, printed {printed}");
    }
}

/// The least and the largest angle that a triangle of the table can have: every corner at its lattice point or up to `gamma` from it
/// along any of its six edges, every crossing that was not snapped at least `gamma` from both ends; at five places each.
fn bounds_of_angles(gamma: f64) -> [f64; 2] {
    let cube = Cell::cube();
    let mut triangles = std::collections::BTreeSet::new();
    for number in 0..6561usize {
        let labels: Vec<Label> =
            (0..8).map(|c| [Label::Outside, Label::On, Label::Inside][number / 3usize.pow(c) % 3]).collect();
        for mut triangle in cube.hull_patch(&labels) {
            triangle.sort_unstable();
            triangles.insert(triangle);
        }
    }
    let place = |c: u8| DVec3::from_array(cube.corners()[usize::from(c)].map(f64::from));
    let shares = [0.0, 0.25, 0.5, 0.75, 1.0];
    // Where a point may be, and from which lattice point towards which it was drawn.
    let places = |point: Point| -> Vec<(DVec3, Option<[DVec3; 2]>)> {
        match point {
            Point::Edge(e) => {
                let [a, b] = cube.edges()[usize::from(e)].map(place);
                shares.map(|s| (a.lerp(b, gamma + (1.0 - 2.0 * gamma) * s), None)).to_vec()
            }
            Point::Corner(c) => [DVec3::X, DVec3::Y, DVec3::Z]
                .into_iter()
                .flat_map(|axis| [axis, -axis])
                .flat_map(|way| {
                    shares.map(|s| (place(c) + way * gamma * s, Some([place(c), place(c) + way])))
                })
                .collect(),
        }
    };
    let mut bounds = [180.0f64, 0.0];
    for triangle in triangles {
        let [a, b, c] = triangle.map(places);
        for p in &a {
            for q in b.iter().filter(|q| !meet(p, q)) {
                for r in c.iter().filter(|r| !meet(p, r) && !meet(q, r)) {
                    let [least, most] = angles([p.0, q.0, r.0]);
                    bounds = [bounds[0].min(least), bounds[1].max(most)];
                }
            }
        }
    }
    bounds
}

/// Whether two points are drawn towards each other: an edge has one crossing, for one of its ends.
fn meet(p: &(DVec3, Option<[DVec3; 2]>), q: &(DVec3, Option<[DVec3; 2]>)) -> bool {
    matches!((p.1, q.1), (Some([a, b]), Some([c, d])) if a == d && b == c)
}

/// 10,000 random fields have no angle beyond the bounds, and some near them.
#[test]
fn angles_keep_within_the_bounds_of_the_table() {
    let mut random = Pcg64Mcg::seed_from_u64(6);
    for gamma in [0.1, 0.2, 0.3, 0.4] {
        let bounds = bounds_of_angles(gamma);
        let mut found = [180.0f64, 0.0];
        for round in 0..2500 {
            let rough = round % 2 == 0;
            let values: Vec<f32> = (0..64)
                .map(|_| {
                    let value: f32 = random.random_range(-1.0..1.0);
                    if rough { value } else { value.powi(5) }
                })
                .collect();
            let mesh = of_samples(&snapped(gamma as f32, Flat::Both), [4; 3], &values, 0.0);
            if !mesh.triangles.is_empty() {
                let [least, most] = Shape::of(&mesh).angles;
                found = [found[0].min(least), found[1].max(most)];
            }
        }
        println!("gamma {gamma}: {found:?} within {bounds:?}");
        assert!(found[0] >= bounds[0] - 1e-2 && found[1] <= bounds[1] + 1e-2, "{gamma}");
    }
}

/// Walls nearer to the box than crossings are snapped from: the mesh is closed, and its triangles are as good as elsewhere.
#[test]
fn walls_beside_the_box_stay() {
    let n = 21;
    for distance in [0.0, 0.05, 0.15, 0.29, 0.31, 0.6] {
        let half = (n - 1) as f32 / 2.0;
        let values: Vec<f32> = (0..n * n * n)
            .map(|i| [i % n, i / n % n, i / n / n].map(|x| (x as f32 - half).abs()))
            .map(|away| half - distance - away.into_iter().fold(0.0, f32::max))
            .collect();
        let mesh = of_samples(&snapped(0.3, Flat::Both), [n; 3], &values, 0.0);
        let report = topology(&mesh);
        assert_eq!((report.boundary_edges, report.euler_characteristic), (0, 2), "{distance}");
        let worst = isostudy_mesh::quality::quality(&mesh).min_angle_deg.min;
        assert!(worst > 12.0, "{distance}: {worst}");
    }
}
