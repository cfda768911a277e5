//! Warp clustering against the boundary of the published tetrahedra, and what it promises; its angles are in `warp_angles.rs`.

use std::collections::{HashMap, HashSet};

use crate::fields::{FAMILIES, Family, Numbers, Volume};
use crate::warp_rules::{ONE, Place, WARP, alpha, mesh_of, offsets, plus};
use glam::{DVec3, Vec3};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{
    Arrangement, BoxGrid, CellBox, ChunkExtractor, ChunkSettings, Clustering, Execution, ExtractError,
    Extractor, Method, Placement, Positions, Source, Tetrahedra, Topology, weld_chunks,
};
use isostudy_field::{Asteroid, Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

/// A lattice edge: what names a crossing.
type Name = [Place; 2];

/// The rules by brute force, on a volume that is outside at its box, with no two samples alike there: names of what the boundary of the tetrahedra has.
struct Stuffing {
    volume: Volume,
    last: i32,
    /// By name, where it is.
    crossings: HashMap<Name, DVec3>,
    /// The crossing that a warped point is moved to.
    warped: HashMap<Place, Name>,
}

impl Stuffing {
    fn of(volume: Volume) -> Self {
        let last = 2 * volume.cells as i32;
        let mut this = Self { volume, last, crossings: HashMap::new(), warped: HashMap::new() };
        let range = -1..=last + 1;
        for (x, y, z) in range.clone().flat_map(|x| {
            let range = range.clone();
            range.clone().flat_map(move |y| range.clone().map(move |z| (x, y, z)))
        }) {
            let place = [x, y, z];
            let odd = place.iter().filter(|c| *c % 2 != 0).count();
            if odd == 0 || odd == 3 {
                this.look(place);
            }
        }
        this
    }

    fn value(&self, place: Place) -> f64 {
        f64::from(self.volume.sample(self.position(place).as_vec3()))
    }

    /// Outermost centres lie on the box.
    fn position(&self, place: Place) -> DVec3 {
        DVec3::from_array(place.map(|c| f64::from(c.clamp(0, self.last)) / 2.0))
    }

    fn look(&mut self, place: Place) {
        let here = self.value(place);
        let mut nearest: Option<(f64, Name)> = None;
        for offset in offsets() {
            let other = plus(place, offset);
            let there = self.value(other);
            if (here > 0.0) == (there > 0.0) {
                continue;
            }
            let share = here / (here - there);
            let name = [place.min(other), place.max(other)];
            let at = self.position(place).lerp(self.position(other), share);
            self.crossings.insert(name, at);
            if share < alpha(offset) && nearest.is_none_or(|(least, _)| share < least) {
                nearest = Some((share, name));
            }
        }
        if let Some((_, name)) = nearest {
            self.warped.insert(place, name);
        }
    }

    /// All tetrahedra: round each edge between two centres, the four corners round it by pairs.
    fn tetrahedra(&self) -> Vec<[Place; 4]> {
        let odd = || (-1..=self.last + 1).filter(|c| c % 2 != 0);
        let centres = odd().flat_map(move |x| odd().flat_map(move |y| odd().map(move |z| [x, y, z])));
        let centres: Vec<Place> = centres.collect();
        let mut found = Vec::new();
        for centre in centres {
            for axis in 0..3 {
                let mut other = centre;
                other[axis] += 2;
                let ring = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(|[u, v]| {
                    let mut corner = centre;
                    corner[axis] += 1;
                    corner[(axis + 1) % 3] += u;
                    corner[(axis + 2) % 3] += v;
                    corner
                });
                found.extend((0..4).map(|i| [centre, other, ring[i], ring[(i + 1) % 4]]));
            }
        }
        found
    }

    /// Triangles by their corners' names, and quadrilaterals, which have two ways to be cut.
    fn boundary(&self) -> (HashSet<[Name; 3]>, Vec<[Name; 4]>) {
        let (mut triangles, mut quadrilaterals) = (HashSet::new(), Vec::new());
        for tetrahedron in self.tetrahedra() {
            let of = |keep: &dyn Fn(bool, bool) -> bool| -> Vec<Place> {
                let corners = tetrahedron.into_iter();
                corners.filter(|p| keep(self.value(*p) > 0.0, self.warped.contains_key(p))).collect()
            };
            let inside = of(&|inside, warped| inside && !warped);
            let outside = of(&|inside, warped| !inside && !warped);
            let zero = of(&|_, warped| warped);
            let cut = |p: Place, q: Place| [p.min(q), p.max(q)];
            // There twice, it is inside the solid.
            let mut add = |mut corners: [Name; 3]| {
                corners.sort_unstable();
                if !triangles.insert(corners) {
                    triangles.remove(&corners);
                }
            };
            if zero.len() == 4 && zero.iter().all(|p| self.value(*p) > 0.0) {
                for left_out in 0..4 {
                    let face = (0..4).filter(|i| *i != left_out).map(|i| self.warped[&zero[i]]);
                    add(face.collect::<Vec<_>>().try_into().expect("a face"));
                }
            }
            let mut corners: Vec<Name> = zero.iter().map(|p| self.warped[p]).collect();
            match (&inside[..], &outside[..]) {
                ([_], _) | ([_, _], [_]) | ([_, _, _], [_]) => {
                    corners.extend(inside.iter().flat_map(|&p| outside.iter().map(move |&q| cut(p, q))));
                    add(corners.try_into().expect("a triangle"));
                }
                (&[p, q], &[r, s]) => quadrilaterals.push([cut(p, r), cut(p, s), cut(q, s), cut(q, r)]),
                _ => {}
            }
        }
        (triangles, quadrilaterals)
    }

    fn name(&self, position: Vec3) -> Name {
        let away = |at: &DVec3| at.distance_squared(position.as_dvec3());
        let nearest = self.crossings.iter().min_by(|a, b| away(a.1).total_cmp(&away(b.1))).unwrap();
        assert!(away(nearest.1) < 1e-8, "{position} is no crossing");
        *nearest.0
    }
}

/// Triangle by triangle, whatever the samples. Tetrahedra are as published, and those of four points that were inside, all warped.
#[test]
fn the_mesh_is_the_boundary_of_the_tetrahedra() {
    let families = [
        Family::White,
        Family::LowPassOnce,
        Family::Spheres,
        Family::ThinShell,
        Family::Gyroid,
        Family::NoisyMagnitudes,
    ];
    let (mut warped, mut cut) = (0, 0);
    for (family, seed) in families.into_iter().flat_map(|family| [(family, 1), (family, 2), (family, 3)]) {
        let mut volume = Volume::random(Arrangement::BodyCentred, 5, family, seed).closed();
        // No two alike: of crossings that are equally near to a point, rounding would choose.
        let (last, mut numbers) = (2 * volume.cells as i32, Numbers::new(seed));
        for place in volume.places().into_iter().filter(|p| p.iter().any(|&c| c <= 0 || c >= last)) {
            volume.set(place, -0.3 - numbers.below(1 << 20) as f32 / (1 << 20) as f32);
        }
        let mesh = mesh_of(&volume, &WARP);
        let stuffing = Stuffing::of(volume);
        warped += stuffing.warped.len();
        let names: Vec<Name> = mesh.positions.iter().map(|&p| stuffing.name(p)).collect();
        let sorted = |corners: [Name; 3]| {
            let mut corners = corners;
            corners.sort_unstable();
            corners
        };
        let mut found: HashSet<[Name; 3]> = HashSet::new();
        for &triangle in &mesh.triangles {
            assert!(
                found.insert(sorted(triangle.map(|v| names[v as usize]))),
                "{family:?} {seed}: there twice"
            );
        }
        let (triangles, quadrilaterals) = stuffing.boundary();
        for [a, b, c, d] in quadrilaterals {
            let ways = [[[a, b, c], [a, c, d]], [[b, c, d], [b, d, a]]].map(|way| way.map(sorted));
            let way = ways.iter().find(|way| way.iter().all(|triangle| found.contains(triangle)));
            for triangle in way.unwrap_or_else(|| panic!("{family:?} {seed}: a quadrilateral is not there")) {
                found.remove(triangle);
            }
            cut += 1;
        }
        assert!(found == triangles, "{family:?} {seed}");
    }
    assert!(warped > 1000 && cut > 20, "{warped} {cut}");
}

/// Sides run as often one way as the other, all vertices are used, and triangles face outward.
#[test]
fn the_mesh_is_closed_whatever_the_samples() {
    let mut touching = 0;
    for (family, seed) in FAMILIES.into_iter().flat_map(|family| [(family, 4), (family, 5)]) {
        let mesh = mesh_of(&Volume::random(Arrangement::BodyCentred, 6, family, seed).closed(), &WARP);
        let mut sides: HashMap<[u32; 2], [i32; 2]> = HashMap::new();
        let mut used = vec![false; mesh.positions.len()];
        for &[a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                assert_ne!(from, to);
                sides.entry([from.min(to), from.max(to)]).or_default()[usize::from(from < to)] += 1;
                used[from as usize] = true;
            }
        }
        assert!(sides.values().all(|[there, back]| there == back), "{family:?} {seed}");
        assert!(used.iter().all(|used| *used), "{family:?} {seed}");
        assert!(mesh.triangles.is_empty() || mesh.volume() > 0.0, "{family:?} {seed}");
        touching += sides.values().filter(|[there, _]| *there > 1).count();
    }
    assert!(touching > 0, "no promise of a manifold is made in vain");
}

#[test]
fn smooth_surfaces_keep_their_topology_and_lose_no_more_than_a_net() {
    for radius in [0.8f32, 0.83, 0.9] {
        let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
        let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.05).unwrap();
        let sphere = Sphere { radius };
        let mesh = extract(&sphere, &lattice, &WARP, &ONE).unwrap().mesh;
        assert!(isostudy_mesh::topology::topology(&mesh).is_closed_manifold());
        let volume = 4.0 / 3.0 * std::f64::consts::PI * f64::from(radius).powi(3);
        assert!((mesh.volume() / volume - 1.0).abs() < 0.003, "{}", mesh.volume() / volume);
        // Every vertex is a crossing, so it is as near to the sphere as those are.
        let away = mesh.positions.iter().map(|p| (p.length() - radius).abs()).fold(0.0, f32::max);
        assert!(away < 0.0005, "{away}");
        let relaxed = WARP.with_placement(Placement::Relaxed);
        let moved = extract(&sphere, &lattice, &relaxed, &ONE).unwrap().mesh;
        assert_eq!(moved.triangles, mesh.triangles);
        let ratio = |mesh: &TriangleMesh| isostudy_mesh::quality::quality(mesh).radius_ratio.mean;
        assert!(ratio(&moved) > ratio(&mesh) + 0.01, "{} {}", ratio(&mesh), ratio(&moved));
    }
}

/// Boxes of cells weld to the whole, to the byte.
#[test]
fn chunks_weld_to_the_whole() {
    for (family, seed) in FAMILIES.into_iter().flat_map(|family| [(family, 0), (family, 1)]) {
        for placement in [Placement::MeanOfCrossings, Placement::Relaxed] {
            let volume = Volume::random(Arrangement::BodyCentred, 11, family, seed);
            let volume = if seed == 0 { volume.closed() } else { volume };
            let settings = WARP.with_placement(placement);
            if placement == Placement::Relaxed && !matches!(family, Family::Spheres | Family::Gyroid) {
                continue;
            }
            let whole = mesh_of(&volume, &settings);
            let method = Method::Tetrahedra(
                Tetrahedra::new(Arrangement::BodyCentred)
                    .with_clustering(Clustering::Warp)
                    .with_placement(placement),
            );
            let grid = BoxGrid::from(&volume.lattice());
            let mut chunks = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
            let boxes: Vec<CellBox> = chunks.grid(4).collect();
            let parts: Vec<_> = boxes
                .into_iter()
                .map(|cells| chunks.extract(Source::Study(&volume), cells, &ONE).unwrap())
                .collect();
            let welded = weld_chunks(&parts).unwrap_or_else(|error| panic!("{family:?} {seed}: {error}"));
            assert!(welded == whole || has_nan(&whole), "{family:?} {seed} {placement:?}");
        }
    }
}

fn has_nan(mesh: &TriangleMesh) -> bool {
    mesh.positions.iter().chain(&mesh.normals).any(|v| v.is_nan())
}

#[test]
fn threads_and_buffers_change_nothing() {
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.04).unwrap();
    let asteroid: &dyn StudyField = &Asteroid::default();
    let one = extract(asteroid, &lattice, &WARP, &ONE).unwrap();
    assert!(
        one.counts.vertices as usize == one.mesh.positions.len() && one.times.clustering > Default::default()
    );
    let unclustered = WARP.with_clustering(Clustering::None);
    let all = extract(asteroid, &lattice, &unclustered, &ONE).unwrap().counts;
    assert_eq!(one.counts.triangles + one.counts.discarded_triangles, all.triangles);
    assert_eq!(one.counts.crossings, all.crossings);
    let mut extractor = Extractor::new();
    for threads in [2, 3, 1] {
        let mesh = extractor.extract(asteroid.into(), &lattice, &WARP, &Execution { threads }).unwrap().mesh;
        assert!(mesh == one.mesh, "{threads}");
    }
}

#[test]
fn what_a_warp_does_not_know_is_refused() {
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let error = |arrangement, settings: ExtractSettings| {
        let lattice = Lattice::try_new(arrangement, bounds, 0.5).unwrap();
        extract(&Sphere { radius: 0.7 }, &lattice, &settings, &ONE).unwrap_err()
    };
    for arrangement in [Arrangement::SimpleCubic, Arrangement::FiveTetrahedra, Arrangement::FaceCentred] {
        assert_eq!(
            error(arrangement, WARP),
            ExtractError::ArrangementClustering { arrangement, clustering: Clustering::Warp }
        );
    }
    for (settings, with) in [
        (WARP.with_topology(Topology::Published), "published topology"),
        (WARP.with_positions(Positions::Accumulated { chunks: 1 }), "accumulated positions"),
        (WARP.with_placement(Placement::CurvatureWeighted), "curvature-weighted placement"),
        (WARP.with_refine_crossings(true), "refined crossings"),
    ] {
        assert_eq!(error(Arrangement::BodyCentred, settings), ExtractError::Warp { with });
    }
}
