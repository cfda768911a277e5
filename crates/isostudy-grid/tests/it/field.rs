//! A grid as a field: its own values, what is linear between them, and what is beyond.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use isostudy_field::StudyField;
use isostudy_grid::{CellKind, Grid, GridField};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::files::{read, vtk};
use crate::surfaces::block;

fn random_point(random: &mut Pcg64, low: f32, high: f32) -> Vec3 {
    Vec3::from([(); 3].map(|()| random.random_range(low..high)))
}

#[test]
fn a_linear_field_is_itself_and_continues_from_the_boundary() {
    let (mut random, slope) = (Pcg64::seed_from_u64(5), DVec3::new(0.7, -0.4, 1.1));
    let grid = block(5, 0.15, &mut random, |at| slope.dot(at) + 0.2);
    let field = GridField::try_new(Arc::new(grid)).unwrap();
    assert_eq!((field.bounds().min, field.bounds().max), (Vec3::ZERO, Vec3::ONE));
    for _ in 0..20_000 {
        let p = random_point(&mut random, -0.5, 1.5);
        // The nearest point of a cube. Which triangle has it is decided in single precision.
        let inside = p.clamp(Vec3::ZERO, Vec3::ONE);
        let (want, rounding) = (slope.dot(inside.as_dvec3()) + 0.2, if p == inside { 2e-6 } else { 2e-4 });
        assert!((f64::from(field.sample(p)) - want).abs() < rounding, "{p} {} {want}", field.sample(p));
        if p.cmpge(Vec3::splat(1e-3)).all() && p.cmple(Vec3::splat(0.999)).all() {
            assert!((field.gradient(p).unwrap().as_dvec3() - slope).length() < 1e-5);
        }
    }
    assert_eq!(field.gradient(Vec3::splat(1.5)), None);
    assert!(field.sample(Vec3::splat(f32::NAN)).is_nan());
}

#[test]
fn values_at_points_and_in_tetrahedra_are_those_of_the_grid() {
    let grid = Arc::new(read(&vtk("few_51_1_vtu.vtk"), "a value"));
    let field = GridField::try_new(Arc::clone(&grid)).unwrap();
    for (at, value) in grid.points().iter().zip(grid.values()) {
        let p = DVec3::from_array(*at).as_vec3();
        assert!((f64::from(field.sample(p)) - value).abs() < 1e-5, "{at:?}");
    }
    for of in grid.tetrahedra() {
        let middle =
            of.iter().map(|&point| DVec3::from_array(grid.points()[point as usize])).sum::<DVec3>() / 4.0;
        let mean = of.iter().map(|&point| grid.values()[point as usize]).sum::<f64>() / 4.0;
        assert!((f64::from(field.sample(middle.as_vec3())) - mean).abs() < 1e-5);
    }
}

#[test]
fn vertices_of_the_surface_have_the_isovalue() {
    let mut random = Pcg64::seed_from_u64(9);
    let grid = Arc::new(block(6, 0.1, &mut random, |at| (5.0 * at.x).sin() + at.y * at.z));
    let field = GridField::try_new(Arc::clone(&grid)).unwrap();
    for position in grid.extract(0.4).mesh.positions {
        assert!((field.sample(position) - 0.4).abs() < 1e-5);
    }
}

#[test]
fn cells_much_larger_than_others_are_found() {
    // A small tetrahedron at a corner of one that is a thousand times as large, and 200 more on its tip.
    let mut points = vec![[0.0, 0.0, 0.0], [1000.0, 0.0, 0.0], [0.0, 1000.0, 0.0], [0.0, 0.0, 1000.0]];
    let mut cells = vec![vec![0, 1, 2, 3]];
    for i in 0..200u32 {
        let at = f64::from(i);
        let first = points.len() as u32;
        points.extend([[-at - 1.0, 0.0, 0.0], [-at, 0.0, 0.0], [-at, 1.0, 0.0], [-at, 0.0, 1.0]]);
        cells.push(vec![first, first + 1, first + 2, first + 3]);
    }
    let values = points.iter().map(|at| at[0]).collect();
    let cells = cells.iter().map(|of| (CellKind::Tetrahedron, of.as_slice()));
    let field = GridField::try_new(Arc::new(Grid::of_cells(points, values, cells).unwrap())).unwrap();
    for x in [-150.25, -3.25, 0.5, 300.0] {
        assert!((field.sample(Vec3::new(x, 0.01, 0.01)) - x).abs() < 1e-3 * x.abs());
    }
}

#[test]
fn tiny_grids_have_bins_too() {
    let points = vec![[0.0, 0.0, 0.0], [1e-30, 0.0, 0.0], [0.0, 1e-30, 0.0], [0.0, 0.0, 1e-30]];
    let grid = Grid::try_new(points, vec![1.0, 0.0, 0.0, 0.0], vec![[0, 1, 2, 3]]).unwrap();
    let field = GridField::try_new(Arc::new(grid)).unwrap();
    assert!((field.sample(Vec3::splat(1e-31)) - 0.7).abs() < 1e-5);
}

#[test]
fn a_grid_without_an_inside_is_no_field() {
    let told = |points: Vec<[f64; 3]>, cells: Vec<[u32; 4]>| {
        let values = vec![0.0; points.len()];
        GridField::try_new(Arc::new(Grid::try_new(points, values, cells).unwrap())).unwrap_err().to_string()
    };
    let flat = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(told(flat.clone(), vec![]), "the grid has no cells with a volume");
    assert_eq!(told(flat, vec![[0, 1, 2, 3]]), "the grid has no cells with a volume");
}
