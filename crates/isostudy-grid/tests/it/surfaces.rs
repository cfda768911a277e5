//! Surfaces against what is known of them: planes, balls, counts of crossed cells, every crossing by itself.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use isostudy_grid::{CellKind, Grid, Surface};
use isostudy_mesh::topology::topology;
use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64;

use crate::files::{read, vtk};

/// How often something random is tried.
const ROUNDS: u64 = 60;

/// Numbers for points in any order: which point of a block comes where.
fn order(count: usize, random: &mut Pcg64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.shuffle(random);
    order
}

/// A block of hexahedra on the points 0 to 1 along each axis, in random order; inner points are moved. Each value is of its point.
pub(crate) fn block(n: usize, moved: f64, random: &mut Pcg64, value: impl Fn(DVec3) -> f64) -> Grid {
    let along = n + 1;
    let order = order(along * along * along, random);
    let mut points = vec![[0.0; 3]; order.len()];
    for (i, &number) in order.iter().enumerate() {
        let at = [i % along, i / along % along, i / along / along];
        points[number] = at.map(|k| {
            let is_inner = k > 0 && k < n;
            let by = if is_inner { moved * random.random_range(-1.0..1.0) } else { 0.0 };
            (k as f64 + by) / n as f64
        });
    }
    let mut cells = Vec::new();
    for (x, y, z) in (0..n * n * n).map(|i| (i % n, i / n % n, i / n / n)) {
        let at = |x: usize, y: usize, z: usize| order[x + along * (y + along * z)] as u32;
        let layer = |z: usize| [at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z)];
        let mut layers = [layer(z), layer(z + 1)];
        // As files have them: wound either way.
        if random.random() {
            layers.swap(0, 1);
        }
        cells.push(layers.concat());
    }
    let values = points.iter().map(|&at| value(DVec3::from_array(at))).collect();
    Grid::of_cells(points, values, cells.iter().map(|of| (CellKind::Hexahedron, of.as_slice()))).unwrap()
}

/// The crossed edges, triangles and tetrahedra of a grid, found one by one.
fn crossed(grid: &Grid, isovalue: f64) -> [BTreeSet<Vec<u32>>; 3] {
    let is_inside = |point: &u32| grid.values()[*point as usize] > isovalue;
    let mut found = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
    for of in grid.tetrahedra() {
        for chosen in 0u32..16 {
            let count = chosen.count_ones() as usize;
            let mut face: Vec<u32> = (0..4).filter(|i| chosen >> i & 1 == 1).map(|i| of[i]).collect();
            face.sort_unstable();
            let inside = face.iter().filter(|point| is_inside(point)).count();
            if count >= 2 && inside > 0 && inside < count {
                found[count - 2].insert(face);
            }
        }
    }
    found
}

/// Holds a surface against the definition: one vertex per crossed edge where its values say, the Euler characteristic of the crossed
/// cells, a manifold whose boundary is the grid's.
fn check(grid: &Grid, surface: &Surface, isovalue: f64) {
    let [edges, triangles, tetrahedra] = crossed(grid, isovalue);
    let euler = edges.len() as i64 - triangles.len() as i64 + tetrahedra.len() as i64;
    let found = topology(&surface.mesh);
    assert_eq!(found.euler_characteristic, euler);
    assert_eq!(surface.crossed_tetrahedra as usize, tetrahedra.len());
    let ours: BTreeSet<Vec<u32>> = surface.crossings.iter().map(|crossing| crossing.ends.to_vec()).collect();
    assert_eq!(ours, edges);
    assert_eq!(surface.crossings.len(), edges.len());
    for (crossing, position) in surface.crossings.iter().zip(&surface.mesh.positions) {
        let [a, b] = crossing.ends.map(|point| point as usize);
        let [from, to] = [a, b].map(|point| grid.values()[point]);
        assert!((from + crossing.share * (to - from) - isovalue).abs() <= 1e-12 * (1.0 + isovalue.abs()));
        let [start, end] = [a, b].map(|point| DVec3::from_array(grid.points()[point]));
        assert!((start.lerp(end, crossing.share) - position.as_dvec3()).abs().max_element() < 1e-6);
    }
    // Its boundary edges are the crossed triangles that one tetrahedron has.
    let mut uses: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    for of in grid.tetrahedra() {
        for left_out in 0..4 {
            let mut face: Vec<u32> = (0..4).filter(|&i| i != left_out).map(|i| of[i]).collect();
            face.sort_unstable();
            *uses.entry(face).or_default() += 1;
        }
    }
    assert!(uses.values().all(|&uses| uses <= 2), "a face has more than two tetrahedra");
    let open = triangles.iter().filter(|face| uses[*face] == 1).count();
    assert_eq!(found.boundary_edges as usize, open);
    assert_eq!([found.non_manifold_edges, found.misoriented_edges, found.non_manifold_vertices], [0; 3]);
    assert_eq!([found.duplicate_faces, found.unused_vertices, found.collapsed_triangles], [0; 3]);
}

#[test]
fn random_values_have_the_surface_that_their_definition_says() {
    for seed in 0..ROUNDS {
        let mut random = Pcg64::seed_from_u64(seed);
        let noise: Vec<f64> = (0..64).map(|_| random.random_range(-1.0..1.0)).collect();
        let cell = |x: f64| (x * 3.0).round() as usize;
        let grid = block(3, 0.0, &mut random, |at| noise[cell(at.x) + 4 * (cell(at.y) + 4 * cell(at.z))]);
        let isovalue = 0.1 * (seed as f64 / ROUNDS as f64 - 0.5);
        check(&grid, &grid.extract(isovalue), isovalue);
        // Turned round, it is the same surface from the other side.
        let turned = grid.clone().negated();
        check(&turned, &turned.extract(-isovalue), -isovalue);
        let crossings = |grid: &Grid, isovalue: f64| {
            let mut all = grid.extract(isovalue).crossings;
            all.sort_by_key(|crossing| crossing.ends);
            all
        };
        assert!(crossings(&turned, -isovalue) == crossings(&grid, isovalue));
    }
}

#[test]
fn values_at_the_isovalue_are_outside() {
    for seed in 0..ROUNDS {
        let mut random = Pcg64::seed_from_u64(seed);
        let noise: Vec<f64> = (0..64).map(|_| f64::from(random.random_range(-1..=1i32))).collect();
        let cell = |x: f64| (x * 3.0).round() as usize;
        let grid = block(3, 0.0, &mut random, |at| noise[cell(at.x) + 4 * (cell(at.y) + 4 * cell(at.z))]);
        check(&grid, &grid.extract(0.0), 0.0);
    }
}

#[test]
fn a_linear_field_has_a_plane_that_faces_the_lower_values() {
    for seed in 0..ROUNDS {
        let mut random = Pcg64::seed_from_u64(seed);
        let normal = DVec3::from([(); 3].map(|()| random.random_range(0.2..1.0)));
        let grid = block(4, 0.2, &mut random, |at| normal.dot(at));
        // Through the middle, where a plane of this slope is a hexagon or a parallelogram.
        let isovalue = 0.5 * normal.element_sum();
        let surface = grid.extract(isovalue);
        check(&grid, &surface, isovalue);
        for t in 0..surface.mesh.triangles.len() {
            let [a, b, c] = surface.mesh.corners(t).map(|p| p.as_dvec3());
            let across = (b - a).cross(c - a);
            assert!(
                across.length() < 1e-9 || across.normalize().dot(normal.normalize()) < -0.99,
                "{across:?}"
            );
        }
        // The area of a cube's section, by counting corners (inclusion and exclusion over the cube's vertices).
        let [x, y, z] = normal.to_array();
        let mut twice = 0.0;
        for corner in 0..8u32 {
            let at = (0..3).filter(|axis| corner >> axis & 1 == 1).map(|axis| normal[axis]).sum::<f64>();
            let sign = if corner.count_ones() % 2 == 0 { 1.0 } else { -1.0 };
            twice += sign * (isovalue - at).max(0.0).powi(2);
        }
        let area = 0.5 * twice / (x * y * z) * normal.length();
        assert!((surface.mesh.area() - area).abs() < 1e-5 * area, "{} {area}", surface.mesh.area());
        assert_eq!(topology(&surface.mesh).euler_characteristic, 1);
    }
}

#[test]
fn a_ball_is_closed_and_its_volume_converges() {
    let mut random = Pcg64::seed_from_u64(7);
    let mut folded = 0;
    let errors = [8, 16].map(|n| {
        let grid = block(n, 0.25, &mut random, |at| 0.4 - at.distance(DVec3::splat(0.5)));
        let surface = grid.extract(0.0);
        assert!(topology(&surface.mesh).is_closed_manifold(), "{:?}", topology(&surface.mesh));
        assert_eq!(topology(&surface.mesh).euler_characteristic, 2);
        folded += grid.oddities().folded;
        assert!(grid.cells().turned > 0);
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.4f64.powi(3);
        (surface.mesh.volume() - ball).abs() / ball
    });
    // Some cells are not convex, and the surface faces one way through them too.
    assert!(folded > 0);
    // Second order: a quarter of it with half the edges.
    assert!(errors[1] < 0.35 * errors[0] && errors[1] < 0.02, "{errors:?}");
}

/// The cells of `mixed` in `vtk`, each with the area of its faces and its volume.
fn mixed(order: &[usize]) -> Vec<[u32; 4]> {
    let cells: [(CellKind, &[usize]); 5] = [
        (CellKind::Hexahedron, &[0, 1, 2, 3, 4, 5, 6, 7]),
        (CellKind::Pyramid, &[4, 5, 6, 7, 8]),
        (CellKind::Wedge, &[1, 9, 5, 2, 10, 6]),
        (CellKind::Voxel, &[11, 12, 0, 1, 13, 14, 4, 5]),
        (CellKind::Tetrahedron, &[5, 6, 8, 15]),
    ];
    let mut tetrahedra = Vec::new();
    for (kind, points) in cells {
        let points: Vec<u32> = points.iter().map(|&point| order[point] as u32).collect();
        kind.cut(&points, &mut tetrahedra);
    }
    tetrahedra
}

#[test]
fn cells_of_all_kinds_fit_however_their_points_are_numbered() {
    let places = read(&vtk("mixed_51_1_vtu.vtk"), "a value").points().to_vec();
    for seed in 0..500 {
        let mut random = Pcg64::seed_from_u64(seed);
        let order = order(places.len(), &mut random);
        let tetrahedra = mixed(&order);
        let mut points = vec![[0.0; 3]; places.len()];
        order.iter().zip(&places).for_each(|(&number, &at)| points[number] = at);
        // Hexahedron and voxel 1 each, pyramid and wedge 1/3 and 1/2, the tetrahedron by its determinant.
        let volume = |of: &[u32; 4]| {
            let [a, b, c, d] = of.map(|point| DVec3::from_array(points[point as usize]));
            (b - a).cross(c - a).dot(d - a) / 6.0
        };
        let total: f64 = tetrahedra.iter().map(volume).sum();
        let alone = volume(&[5, 6, 8, 15].map(|point| order[point] as u32));
        assert!(tetrahedra.iter().all(|of| volume(of) > 0.0), "seed {seed}");
        assert!((total - (2.0 + 1.0 / 3.0 + 0.5 + alone)).abs() < 1e-12, "seed {seed}: {total}");
        let values: Vec<f64> = points.iter().map(|_| random.random_range(-1.0..1.0)).collect();
        let grid = Grid::try_new(points, values, tetrahedra).unwrap();
        check(&grid, &grid.extract(0.05), 0.05);
    }
}

#[test]
fn a_cell_with_a_point_twice_is_one_of_fewer_corners() {
    // A hexahedron whose upper face is one edge is a wedge.
    let mut tetrahedra = Vec::new();
    CellKind::Hexahedron.cut(&[0, 1, 2, 3, 4, 5, 5, 4], &mut tetrahedra);
    let places = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1]];
    let points: Vec<[f64; 3]> = places.map(|at| at.map(f64::from)).to_vec();
    let volume: f64 = tetrahedra
        .iter()
        .map(|of| {
            let [a, b, c, d] = of.map(|point| DVec3::from_array(points[point as usize]));
            (b - a).cross(c - a).dot(d - a) / 6.0
        })
        .sum();
    assert!((volume - 0.5).abs() < 1e-12, "{volume}");
    assert_eq!(tetrahedra.len(), 3);
}

#[test]
fn a_flat_tetrahedron_goes_with_its_neighbours() {
    // Two pyramids on a square, cut along different diagonals, and the flat tetrahedron that joins both.
    let points = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.5, 0.5, 1.0],
        [0.5, 0.5, -1.0],
    ];
    let above = [[0, 1, 2, 4], [0, 2, 3, 4]];
    let below = [[1, 2, 3, 5], [1, 3, 0, 5]];
    for flat in [[0, 1, 2, 3], [1, 0, 2, 3], [2, 1, 3, 0]] {
        for values in
            [[1.0, 0.0, 0.2, 0.9, 0.3, 0.7], [1.0, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.1, 0.2, 0.9, 0.9]]
        {
            let tetrahedra = [&above[..], &below[..], &[flat]].concat();
            let grid = Grid::try_new(points.clone(), values.to_vec(), tetrahedra).unwrap();
            assert_eq!(grid.cells().without_volume, 1);
            check(&grid, &grid.extract(0.5), 0.5);
        }
    }
}

#[test]
fn a_chain_of_flat_tetrahedra_goes_with_the_first_that_has_a_volume() {
    // All in the plane z = 0 but for the last point; each shares a face with the one before.
    let points =
        [[0, 0, 0], [4, 0, 0], [0, 4, 0], [3, 3, 0], [5, 2, 0], [1, 1, 7]].map(|at| at.map(f64::from));
    let chain = [[1, 2, 3, 4], [0, 2, 1, 3], [0, 1, 2, 5]];
    for swaps in 0..8u32 {
        let mut tetrahedra = chain.to_vec();
        (0..3).filter(|i| swaps >> i & 1 == 1).for_each(|i| tetrahedra[i].swap(0, 3));
        let values = vec![1.0, 0.0, 1.0, 0.0, 1.0, 0.0];
        let grid = Grid::try_new(points.to_vec(), values, tetrahedra).unwrap();
        assert_eq!(grid.cells().without_volume, 2);
        check(&grid, &grid.extract(0.5), 0.5);
    }
}

#[test]
fn what_has_no_value_is_no_part_of_the_grid() {
    let mut random = Pcg64::seed_from_u64(3);
    let whole = block(4, 0.1, &mut random, |at| at.x + 0.3 * at.y);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let at = |i: usize, value: f64| if i == 60 { bad } else { value };
        let values = whole.values().iter().enumerate().map(|(i, &value)| at(i, value)).collect();
        let grid = Grid::try_new(whole.points().to_vec(), values, whole.tetrahedra().to_vec()).unwrap();
        let rest: Vec<[u32; 4]> = whole.tetrahedra().iter().copied().filter(|of| !of.contains(&60)).collect();
        assert_eq!(grid.oddities().without_value as usize, whole.tetrahedra().len() - rest.len());
        let values = whole.values().to_vec();
        let rest = Grid::try_new(whole.points().to_vec(), values, rest).unwrap();
        let isovalue = whole.values()[60] - 0.01;
        assert!(grid.extract(isovalue) == rest.extract(isovalue));
        assert!(grid.extract(isovalue) != whole.extract(isovalue));
    }
}

#[test]
fn points_at_one_place_leave_a_crack_and_are_counted() {
    let at = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
    let points = [&at(0.0)[..], &at(1.0), &[[0.0, 0.0, 2.0]], &at(1.0)].concat();
    let values = vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
    // Below and above the triangle at z = 1; above it has points of its own, or not.
    let grid = |upper: [u32; 3]| {
        let [a, b, c] = upper;
        let tetrahedra = vec![[0, 3, 4, 5], [a, b, c, 6]];
        Grid::try_new(points.clone(), values.clone(), tetrahedra).unwrap()
    };
    let (joined, apart) = (grid([3, 4, 5]), grid([7, 8, 9]));
    assert_eq!((joined.oddities().twice, apart.oddities().twice), (0, 3));
    assert_eq!(topology(&joined.extract(0.5).mesh).components, 1);
    assert_eq!(topology(&apart.extract(0.5).mesh).components, 2);
}

#[test]
fn tetrahedra_that_are_wound_otherwise_are_counted_and_face_right() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    let values = vec![1.0, 0.0, 0.0, 0.0, -1.0];
    let surface = |second: [u32; 4]| {
        let grid = Grid::try_new(points.clone(), values.clone(), vec![[0, 1, 2, 3], second]).unwrap();
        (grid.cells().turned, grid.extract(-0.5).mesh)
    };
    let (right, turned) = (surface([1, 2, 3, 4]), surface([1, 3, 2, 4]));
    assert_eq!((right.0, turned.0), (0, 1));
    let facing = |mesh: &isostudy_mesh::TriangleMesh| {
        let [a, b, c] = mesh.corners(0);
        (b - a).cross(c - a).dot(glam::Vec3::ONE)
    };
    assert!(facing(&right.1) > 0.0 && facing(&turned.1) > 0.0);
}

#[test]
fn what_is_no_grid_is_refused() {
    let points = || vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let told =
        |values: Vec<f64>, of: [u32; 4]| Grid::try_new(points(), values, vec![of]).unwrap_err().to_string();
    assert_eq!(told(vec![0.0; 3], [0, 1, 2, 3]), "3 values are on 4 points");
    assert_eq!(told(vec![0.0; 4], [0, 1, 2, 4]), "cell 0: names point 4, and the points are 0 to 3");
    assert_eq!(told(vec![0.0; 4], [0, 1, 2, 1]), "cell 0: [0, 1, 2, 1] names a point twice");
    let empty = Grid::try_new(Vec::new(), Vec::new(), Vec::new()).unwrap();
    assert_eq!(
        (empty.extract(0.0).mesh.triangles.len(), empty.bounds(), empty.value_range()),
        (0, None, None)
    );
}

#[test]
fn values_at_both_ends_of_double_precision_cross_in_between() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let values = vec![f64::MAX, -f64::MAX, -f64::MAX, -f64::MAX];
    let grid = Grid::try_new(points, values, vec![[0, 1, 2, 3]]).unwrap();
    assert!(grid.extract(0.0).crossings.iter().all(|crossing| crossing.share == 0.5));
}
