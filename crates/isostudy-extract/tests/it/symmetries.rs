//! Surface nets and dual contouring of a field that is turned, mirrored, moved or has its sides exchanged:
//! the same net, as far as the methods promise it.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use isostudy_cells::Cell;
use isostudy_extract::{
    BoxGrid, CellBox, ChunkExtractor, ChunkSettings, DualContouring, Execution, Extractor, Method, Source,
    SurfaceNets,
};
use isostudy_field::StudyField;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };

/// Cells along each axis, with steps of 1 and the origin in the middle: permutations and changes of sign are
/// exact.
const CELLS: i32 = 14;
const HALF: f32 = CELLS as f32 / 2.0;

/// How far apart vertices may be that should be one, in cells. Coordinates are up to 16, with a last digit of
/// 1e-6.
///
/// The mean of some crossings is off by a few last digits. The meeting of tangent planes is off by more: the
/// search for a crossing runs upwards along each axis, so that seen from the other side it ends up to 1e-6
/// away; and along the eigenvector of an eigenvalue of 1e-3 of the largest, the least that counts, planes
/// that are off by this meet some thirty times as far away.
const OF_MEANS: f32 = 4e-6;
const OF_MEETINGS: f32 = 1e-4;

/// A signed permutation of the axes, and a shift by whole cells.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Motion {
    /// Which axis of the source each axis of the image is.
    axes: [usize; 3],
    signs: [f32; 3],
    shift: Vec3,
}

impl Motion {
    /// All 48 symmetries of the cube: cyclic permutations, mirrors and quarter turns are among them.
    fn of_the_cube() -> impl Iterator<Item = Self> {
        let permutations = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        permutations.into_iter().flat_map(|axes| {
            (0..8).map(move |set| Self {
                axes,
                signs: [0, 1, 2].map(|axis| if set >> axis & 1 != 0 { -1.0 } else { 1.0 }),
                shift: Vec3::ZERO,
            })
        })
    }

    fn of(&self, p: Vec3) -> Vec3 {
        let turned = [0, 1, 2].map(|axis| self.signs[axis] * p[self.axes[axis]]);
        Vec3::from_array(turned) + self.shift
    }

    fn back(&self, p: Vec3) -> Vec3 {
        let p = p - self.shift;
        let mut source = Vec3::ZERO;
        (0..3).for_each(|axis| source[self.axes[axis]] = self.signs[axis] * p[axis]);
        source
    }
}

/// Waves without a symmetry, so short that many faces are ambiguous; cut off by a round wall if closed.
#[derive(Debug, Clone, Copy)]
struct Waves {
    closed: bool,
    /// -1 where inside and outside have changed places.
    sign: f64,
    motion: Motion,
}

const SAME: Motion = Motion { axes: [0, 1, 2], signs: [1.0; 3], shift: Vec3::ZERO };
const WAVES: [([f64; 3], f64); 5] = [
    ([1.71, 0.43, -0.92], 0.3),
    ([-0.64, 1.53, 1.12], 1.9),
    ([0.91, -1.27, 1.38], 4.1),
    ([1.13, 1.49, 0.57], 2.7),
    ([-1.36, 0.22, 1.61], 5.2),
];

impl Waves {
    fn at(&self, p: Vec3) -> (f64, DVec3) {
        let p = self.motion.back(p).as_dvec3();
        let mut at = (0.05, DVec3::ZERO);
        for (way, phase) in WAVES {
            let way = DVec3::from_array(way);
            let angle = way.dot(p) + phase;
            at.0 += angle.sin();
            at.1 += angle.cos() * way;
        }
        if self.closed {
            let wall = (p.length() / (0.8 * f64::from(HALF))).powi(8);
            at.0 -= 4.0 * wall;
            at.1 -= 32.0 * wall * p / p.length_squared().max(1e-9);
        }
        (self.sign * at.0, self.sign * at.1)
    }
}

impl StudyField for Waves {
    fn sample(&self, p: Vec3) -> f32 {
        self.at(p).0 as f32
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some(self.motion.of(self.at(p).1.as_vec3()) - self.motion.shift)
    }
}

fn grid(middle: Vec3) -> BoxGrid {
    BoxGrid { bounds: Bounds { min: middle - HALF, max: middle + HALF }, spacing: 1.0 }
}

fn mesh(method: &Method, field: &Waves) -> TriangleMesh {
    let (source, grid) = (Source::Study(field), grid(field.motion.shift));
    method.extract(&mut Extractor::new(), source, &grid, 0.0, &ONE).unwrap().mesh
}

fn methods() -> Vec<(Method, f32)> {
    let mut all = Vec::new();
    for patches in [false, true] {
        for smoothing in [0, 3] {
            let nets = SurfaceNets::default().with_patches(patches).with_smoothing(smoothing);
            all.push((Method::SurfaceNets(nets), OF_MEANS));
        }
        for in_cell in [false, true] {
            let planes = DualContouring::default().with_patches(patches).with_in_cell(in_cell);
            all.push((Method::DualContouring(planes), OF_MEETINGS));
        }
    }
    all
}

fn has_patches(method: &Method) -> bool {
    match method {
        Method::SurfaceNets(nets) => nets.patches,
        Method::DualContouring(planes) => planes.patches,
        _ => unreachable!("these are the methods"),
    }
}

/// Of each point the place among `others` of one that is within the tolerance, each given once; or the first
/// that has none.
fn matched(points: &[Vec3], others: &[Vec3], tolerance: f32) -> Result<Vec<u32>, Vec3> {
    let mut by_cell: HashMap<[i32; 3], Vec<u32>> = HashMap::new();
    let cell = |p: Vec3| p.floor().to_array().map(|c| c as i32);
    for (i, &other) in others.iter().enumerate() {
        by_cell.entry(cell(other)).or_default().push(i as u32);
    }
    let mut find = |&p: &Vec3| {
        let (low, high) = (cell(p - tolerance), cell(p + tolerance));
        let places =
            (0..8).map(|c| [0, 1, 2].map(|axis| if c >> axis & 1 != 0 { high[axis] } else { low[axis] }));
        let mut best: Option<([i32; 3], usize, f32)> = None;
        for place in places {
            for (i, &other) in by_cell.get(&place).into_iter().flatten().enumerate() {
                let apart = (others[other as usize] - p).abs().max_element();
                if apart <= best.map_or(tolerance, |(_, _, least)| least) {
                    best = Some((place, i, apart));
                }
            }
        }
        let (place, i, _) = best.ok_or(p)?;
        Ok(by_cell.get_mut(&place).unwrap().swap_remove(i))
    };
    points.iter().map(&mut find).collect()
}

/// The corners of each quadrilateral, by the numbers that `name` gives them, in order.
fn quadrilaterals(mesh: &TriangleMesh, name: impl Fn(u32) -> u32) -> Vec<Vec<u32>> {
    let corners = |pair: &[[u32; 3]]| {
        let mut all: Vec<u32> = pair.concat().into_iter().map(&name).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let mut all: Vec<Vec<u32>> = mesh.triangles.chunks(2).map(corners).collect();
    all.sort_unstable();
    all
}

/// Six times the volume round which the triangles run counter-clockwise.
fn volume(mesh: &TriangleMesh, middle: Vec3) -> f64 {
    let part = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| (mesh.positions[v as usize] - middle).as_dvec3());
        a.dot(b.cross(c))
    };
    mesh.triangles.iter().map(part).sum()
}

/// The image of the net is the net of the image: vertices, quadrilaterals, and which side they face.
fn assert_same(method: &Method, tolerance: f32, field: &Waves, plain: &TriangleMesh) {
    let image = mesh(method, field);
    let moved: Vec<Vec3> = plain.positions.iter().map(|&p| field.motion.of(p)).collect();
    assert_eq!(
        (image.positions.len(), image.triangles.len()),
        (moved.len(), plain.triangles.len()),
        "{method:?} {field:?}"
    );
    let places =
        matched(&moved, &image.positions, tolerance).unwrap_or_else(|p| panic!("{method:?} {field:?}: {p}"));
    if field.closed {
        assert_eq!(quadrilaterals(plain, |v| places[v as usize]), quadrilaterals(&image, |v| v));
        let [is, want] =
            [(&image, field.motion.shift), (plain, Vec3::ZERO)].map(|(mesh, middle)| volume(mesh, middle));
        assert!((is - field.sign * want).abs() < 1e-3 * want.abs(), "{method:?} {field:?}: {is} {want}");
    }
}

/// One symmetry of each kind, where the net is closed and where it ends at the box; and where it is closed a
/// fifth of all 48, in which kinds are mixed.
#[test]
fn nets_turn_and_move_with_the_field() {
    let of_each_kind = [
        Motion { axes: [1, 2, 0], ..SAME },
        Motion { signs: [1.0, -1.0, 1.0], ..SAME },
        Motion { axes: [1, 0, 2], signs: [-1.0, 1.0, 1.0], ..SAME },
        Motion { shift: Vec3::new(3.0, 0.0, 0.0), ..SAME },
        Motion { shift: Vec3::new(-8.0, 5.0, 9.0), ..SAME },
    ];
    for (method, tolerance) in methods() {
        for closed in [false, true] {
            let field = Waves { closed, sign: 1.0, motion: SAME };
            let plain = mesh(&method, &field);
            assert!(plain.positions.len() > 500);
            let motions = of_each_kind.into_iter().chain(Motion::of_the_cube().step_by(5).filter(|_| closed));
            for motion in motions {
                assert_same(&method, tolerance, &Waves { motion, ..field }, &plain);
            }
        }
    }
}

/// With one vertex a cell nothing asks which side is inside.
#[test]
fn nets_without_patches_stay_when_sides_are_exchanged() {
    for (method, tolerance) in methods().into_iter().filter(|(method, _)| !has_patches(method)) {
        for closed in [false, true] {
            let field = Waves { closed, sign: 1.0, motion: SAME };
            let plain = mesh(&method, &field);
            assert_same(&method, tolerance, &Waves { sign: -1.0, ..field }, &plain);
        }
    }
}

/// Patches keep the inside corners of an ambiguous face apart, so where sides are exchanged they part what
/// they had joined. There are as many quadrilaterals, and vertices of cells without such a face stay; that is
/// all there can be. Smoothing draws those that stay after the others, so it is left out.
#[test]
fn patches_change_in_ambiguous_cells_alone_when_sides_are_exchanged() {
    let cube = Cell::cube();
    let field = Waves { closed: true, sign: 1.0, motion: SAME };
    let fields = [field, Waves { sign: -1.0, ..field }];
    let is_ambiguous = |cell: [i32; 3]| {
        let corner = |c: usize| {
            Vec3::from_array([0, 1, 2].map(|axis| (cell[axis] + (c >> axis & 1) as i32) as f32 - HALF))
        };
        let inside = (0..8).fold(0, |set, c| set | u32::from(field.sample(corner(c)) > 0.0) << c);
        cube.ambiguous_faces(inside) != 0
    };
    let is_smoothed = |method: &Method| matches!(method, Method::SurfaceNets(nets) if nets.smoothing > 0);
    let patched = methods().into_iter().filter(|(method, _)| has_patches(method) && !is_smoothed(method));
    for (method, tolerance) in patched {
        let [plain, other] = fields.map(|field| mesh(&method, &field));
        assert_eq!(plain.triangles.len(), other.triangles.len(), "{method:?}");
        // Sheets that one has joined the other has not.
        let [before, after] = [&plain, &other].map(|mesh| topology(mesh).euler_characteristic);
        assert_ne!(before, after, "{method:?}");
        // Chunks say which cell a vertex is of.
        let mut chunks =
            ChunkExtractor::in_box(&grid(Vec3::ZERO), &method, &ChunkSettings::default()).unwrap();
        let cells = CellBox { start: [0; 3], end: [CELLS; 3] };
        let [plain, other] = fields.map(|field| -> Vec<Vec3> {
            let chunk = chunks.extract(Source::Study(&field), cells, &ONE).unwrap();
            let of = chunk.keys.iter().zip(&chunk.positions).filter(|(key, _)| !is_ambiguous(key.cell()));
            of.map(|(_, &p)| Vec3::from(p)).collect()
        });
        assert!(
            plain.len() > 400 && plain.len() == other.len(),
            "{method:?}: {} {}",
            plain.len(),
            other.len()
        );
        matched(&plain, &other, tolerance).unwrap_or_else(|p| panic!("{method:?}: {p}"));
    }
}
