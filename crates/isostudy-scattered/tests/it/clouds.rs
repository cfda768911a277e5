//! Files of points, and points that make no surface.

use isostudy_field::StudyField;
use isostudy_mesh::glam::Vec3;
use isostudy_scattered::{
    PointCloud, PointField, PointFieldError, PointFormat, PointSettings, estimate_normals, read_points,
};

fn read(format: PointFormat, text: &str) -> Result<PointCloud, String> {
    read_points(format, text.as_bytes()).map_err(|error| error.to_string())
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                   property float nx\nproperty float ny\nproperty float nz\nend_header\n";

#[test]
fn one_cloud_in_three_formats() {
    let positions = vec![Vec3::new(1.0, 2.5, -3.0), Vec3::new(0.1, 0.0, 4.0)];
    let normals = vec![Vec3::new(0.0, 0.0, 2.0), Vec3::new(-1.0, 0.0, 0.5)];
    let xyz = "# x y z nx ny nz\r\n1 2.5 -3 0 0 2 255 0 0\r\n\r\n0.1;0,4\t-1 0 .5\r\n";
    let obj = "o scan\nv 1 2.5 -3\nvn 0 0 2\nv 0.1 0 4 # last\nvn -1 0 0.5\n";
    let ply = format!("{PLY}1 2.5 -3 0 0 2\n0.1 0 4 -1 0 0.5\n");
    let of = |lines| PointCloud { positions: positions.clone(), normals: normals.clone(), lines };
    assert_eq!(read(PointFormat::Xyz, xyz).unwrap(), of(vec![2, 4]));
    assert_eq!(read(PointFormat::Obj, obj).unwrap(), of(vec![2, 4]));
    assert_eq!(read(PointFormat::Ply, &ply).unwrap(), of(vec![]));
    assert_eq!(read(PointFormat::Xyz, "1 2 3\r4 5 6\r").unwrap().lines, [1, 2]);
    for format in PointFormat::ALL {
        assert_eq!(PointFormat::from_extension(&format.extension().to_uppercase()), Some(format));
    }
    assert_eq!(PointFormat::from_extension("stl"), None);
}

/// With faces, a vertex has the normal that its corners name.
#[test]
fn the_normals_of_a_mesh_are_those_of_its_faces() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//2 3//1\n";
    let cloud = read(PointFormat::Obj, obj).unwrap();
    assert_eq!(cloud.normals, [Vec3::Z, Vec3::X, Vec3::Z]);
}

#[test]
fn files_that_are_wrong_say_where() {
    let said = |format, text: &str| read(format, text).unwrap_err();
    assert_eq!(
        said(PointFormat::Xyz, "1 2 3\n\n4 nan 6\n"),
        "line 3: `nan` is not a finite single-precision number"
    );
    assert_eq!(said(PointFormat::Xyz, "1 2 1e39"), "line 1: `1e39` is not a finite single-precision number");
    assert_eq!(said(PointFormat::Xyz, "1 2"), "line 1: 2 values; x y z or x y z nx ny nz are wanted");
    assert_eq!(said(PointFormat::Xyz, "#\n1 2 3 4"), "line 2: 4 values; x y z or x y z nx ny nz are wanted");
    assert_eq!(
        said(PointFormat::Xyz, "1 2 3\n1 2 3 0 0 1"),
        "line 2: 6 values, where the points before have 3"
    );
    assert_eq!(said(PointFormat::Obj, "v 0 0 inf"), "line 1: `inf` is not a finite single-precision number");
    let uneven = "v 0 0 1\nv 1 2 3\nvn 0 0 1\n";
    assert_eq!(
        said(PointFormat::Obj, uneven),
        "1 normals for 2 points; without faces, line by line they belong together"
    );
    let nan = said(PointFormat::Ply, &format!("{PLY}1 2 3 0 0 1\n1 2 inf 0 0 1\n"));
    assert!(nan.starts_with("vertex 1, before byte ") && nan.contains("`z` is inf"), "{nan}");
    assert_eq!(read(PointFormat::Xyz, "").unwrap(), PointCloud::default());
}

fn refused(text: &str) -> PointFieldError {
    let cloud = read(PointFormat::Xyz, text).unwrap();
    let found = PointField::try_new(&cloud, &PointSettings::default()).unwrap_err();
    if found != PointFieldError::Flat {
        assert_eq!(PointField::check(&cloud, &PointSettings::default()).unwrap_err(), found);
    }
    found
}

const PYRAMID: &str = "0 0 0 -1 -1 -1\n1 0 0 1 0 0\n0 1 0 0 1 0\n0 0 1 0 0 1\n";

#[test]
fn points_that_make_no_surface_are_refused_with_their_place() {
    assert_eq!(refused("0 0 0\n1 0 0\n0 1 0\n0 0 1\n"), PointFieldError::NoNormals);
    assert_eq!(refused("0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n"), PointFieldError::Few { points: 3 });
    assert_eq!(refused(""), PointFieldError::Few { points: 0 });
    // Five lines at three places.
    let few = "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n0 1 0 0 0 2\n-0 0 0 0 0 1\n";
    assert_eq!(refused(few), PointFieldError::Few { points: 3 });
    let zero = refused(&format!("{PYRAMID}# next\n2 2 2 0 0 0\n")).to_string();
    assert_eq!(zero, "line 6: the normal [0, 0, 0] has no direction");
    let two = refused(&format!("{PYRAMID}1 0 0 0 0 1\n")).to_string();
    assert_eq!(
        two,
        "line 2 and line 5 are one point, at [1, 0, 0], and their normals differ: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]"
    );
    let far = refused(&format!("{PYRAMID}1 0 2e18 0 0 1\n")).to_string();
    assert!(far.starts_with("line 5: the point is at [1, 0, 2"), "{far}");
    // On a line, with all normals to one side.
    assert_eq!(refused("0 0 0 0 0 1\n1 0 0 0 0 1\n2 0 0 0 0 1\n5 0 0 0 0 1\n"), PointFieldError::Flat);
    let cloud = read(PointFormat::Xyz, PYRAMID).unwrap();
    for odd in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let settings = PointSettings { offset: Some(odd), ..PointSettings::default() };
        let said = PointField::try_new(&cloud, &settings).unwrap_err().to_string();
        assert!(said.starts_with("offset must be above 0 and finite, not "), "{said}");
    }
}

#[test]
fn a_point_twice_counts_once() {
    let once = read(PointFormat::Xyz, PYRAMID).unwrap();
    let twice = read(PointFormat::Xyz, &format!("{PYRAMID}1 0 0 3 0 0\n-0 0 1 0 0 1\n")).unwrap();
    let [once, twice] =
        [once, twice].map(|cloud| PointField::try_new(&cloud, &PointSettings::default()).unwrap());
    assert_eq!((once.repeated(), twice.repeated()), (0, 2));
    for i in 0..40 {
        let p = Vec3::new(0.1 * i as f32 - 1.0, 0.3, 0.07 * i as f32);
        assert_eq!(once.sample(p).to_bits(), twice.sample(p).to_bits());
    }
}

/// Of a plane a spline is its distance, whatever the points.
#[test]
fn points_in_a_plane_give_that_plane() {
    let mut text = String::new();
    for (i, j) in (0..5).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let (x, y) = (i as f32 + 0.25 * (j % 2) as f32, 0.5 * j as f32);
        text += &format!("{x} {y} {} -3 0 4\n", 1.0 + 0.75 * x);
    }
    let cloud = read(PointFormat::Xyz, &text).unwrap();
    let field = PointField::try_new(&cloud, &PointSettings::default()).unwrap();
    assert!(field.report().largest < 1e-12);
    for i in 0..60 {
        let p = Vec3::new(0.31 * i as f32 - 6.0, 3.0 - 0.17 * i as f32, 0.05 * (i * i) as f32 - 20.0);
        // Inside is below, and the normal has length 5.
        let want = (4.0 * (1.0 - p.z) + 3.0 * p.x) / 5.0;
        assert!((field.sample(p) - want).abs() < 1e-5 * (1.0 + p.length()), "{} for {want}", field.sample(p));
        let gradient = field.gradient(p).unwrap();
        assert!((gradient - Vec3::new(0.6, 0.0, -0.8)).length() < 1e-6, "{gradient}");
    }
}

#[test]
fn normals_are_estimated_where_there_are_none() {
    let cloud = estimate_normals(&PointCloud::default());
    assert_eq!(cloud, PointCloud::default());
    // Fewer points than neighbours, and one that is none.
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::NAN];
    let cloud = estimate_normals(&PointCloud { positions, ..PointCloud::default() });
    assert_eq!(cloud.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::ZERO]);
}
