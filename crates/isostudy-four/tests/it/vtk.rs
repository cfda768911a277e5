//! Files of VTK, read by the crate that reads grids.

use std::fs::File;

use isostudy_four::interval_volume;
use isostudy_grid::Grid;

use crate::series::{ball, random};

fn read(name: &str, array: &str, write: impl FnOnce(File) -> std::io::Result<()>) -> Grid {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write(File::create(&path).unwrap()).unwrap();
    isostudy_grid::read(&path, Some(array), 1 << 30).unwrap()
}

#[test]
fn a_contour_of_time_is_a_slice() {
    let series = ball(10, 3.7);
    let space_time = series.extract(0.0).unwrap();
    let grid = read("a.vtk", "time", |file| space_time.write_vtk(std::io::BufWriter::new(file)));
    assert_eq!(grid.tetrahedra().len(), space_time.tetrahedra.len());
    for time in [1.3, 4.25, 7.6] {
        let (contour, slice) = (grid.extract(time).mesh, space_time.slice(time).unwrap());
        assert_eq!(contour.triangles.len(), slice.triangles.len(), "{time}");
        assert_eq!(contour.positions.len(), slice.positions.len(), "{time}");
        assert!((contour.area() / slice.area() - 1.0).abs() < 1e-5, "{} {}", contour.area(), slice.area());
        let places = |mesh: &isostudy_mesh::TriangleMesh| {
            let mut places: Vec<[i64; 3]> = mesh
                .positions
                .iter()
                .map(|p| p.to_array().map(|x| (f64::from(x) * 1e4).round() as i64))
                .collect();
            places.sort_unstable();
            places
        };
        let apart = places(&contour)
            .iter()
            .flatten()
            .zip(places(&slice).iter().flatten())
            .filter(|(a, b)| (*a - *b).abs() > 1)
            .count();
        assert_eq!(apart, 0, "{time}");
    }
}

#[test]
fn a_solid_is_a_grid_of_its_values() {
    let series = random([8, 8, 8], 3, 0.6, 3);
    let solid = interval_volume(series.placement(), &series.frames()[1], 0.1, 0.5).unwrap();
    let grid = read("b.vtk", "value", |file| solid.write_vtk(std::io::BufWriter::new(file)));
    assert_eq!(
        (grid.points().len(), grid.tetrahedra().len()),
        (solid.positions.len(), solid.tetrahedra.len())
    );
    let [low, high] = grid.value_range().unwrap();
    assert!((low - 0.1).abs() < 1e-6 && (high - 0.5).abs() < 1e-6, "{low} {high}");
}
