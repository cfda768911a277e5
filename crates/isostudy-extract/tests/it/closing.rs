//! Surfaces that are asked to be closed are: round a volume whatever its steps and however it is turned, and at the walls
//! of any box.

use glam::{DMat3, DVec3, Vec3};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution};
use isostudy_field::{Asteroid, Beyond, Negated, Sphere, StudyField, VolumeField, Walled};
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::{first_boundary_edge, topology};
use isostudy_mesh::{Bounds, TriangleMesh};
use proptest::prelude::*;

const CLUSTERINGS: [Clustering; 3] = [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse];

fn mesh_of(field: &dyn StudyField, lattice: &Lattice, clustering: Clustering, isovalue: f32) -> TriangleMesh {
    let settings = ExtractSettings::default().with_clustering(clustering).with_isovalue(isovalue);
    extract(field, lattice, &settings, &Execution { threads: 1 }).unwrap().mesh
}

/// Closed, and sound otherwise, on every arrangement.
fn check(field: &dyn StudyField, bounds: Bounds, spacing: f32, isovalue: f32, what: &str) -> f64 {
    let mut volumes = Vec::new();
    for arrangement in Arrangement::ALL {
        let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
        for clustering in CLUSTERINGS.into_iter().filter(|&clustering| arrangement.supports(clustering)) {
            let mesh = mesh_of(field, &lattice, clustering, isovalue);
            assert_eq!(first_boundary_edge(&mesh), None, "{what}: {arrangement} {clustering}");
            assert!(
                mesh.triangles.is_empty() || topology(&mesh).is_closed_manifold(),
                "{what}: {arrangement}"
            );
            // Means of crossings can lie in a line, in noise of few levels.
            if clustering != Clustering::Integrated {
                assert_eq!(quality(&mesh).degenerate, 0, "{what}: {arrangement} {clustering}");
            }
            volumes.push(mesh.volume());
        }
    }
    volumes[0]
}

/// A volume as the command closes it: with its own box, or cut off by one.
fn closed(volume: VolumeField, bounds: Option<Bounds>, isovalue: f32) -> (Walled<VolumeField>, Bounds) {
    let field = volume.closing_at(isovalue);
    let bounds = bounds.unwrap_or(field.closing_bounds());
    (Walled::new(field, bounds, isovalue), bounds)
}

fn straight(x: f64, y: f64, z: f64) -> [[f64; 3]; 3] {
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
}

#[test]
fn unequal_steps_are_closed() {
    for steps in [[1.0, 1.0, 1.0], [1.0, 1.0, 2.0], [1.0, 1.0, 3.0], [1.0, 1.0, 5.0], [0.7, 0.7, 5.0]] {
        let [x, y, z] = steps;
        let volume = || {
            VolumeField::try_new([4; 3], vec![2.0; 64], [0.0; 3], straight(x, y, z), Beyond::Continued)
                .unwrap()
        };
        let (field, bounds) = closed(volume(), None, 0.5);
        let enclosed = check(&field, bounds, 1.0, 0.5, &format!("{steps:?}"));
        // To a shortest step beyond the samples on every side, and no farther.
        let grown = |by: f64| steps.iter().map(|step| 3.0 * step + 2.0 * by).product::<f64>();
        let step = x.min(y);
        assert!((grown(0.0)..=grown(step)).contains(&enclosed), "{steps:?}: {enclosed}");
        // Without the walls as well: there is room enough.
        check(&volume().closing_at(0.5), bounds, 1.0, 0.5, &format!("without walls {steps:?}"));
    }
}

#[test]
fn a_body_between_thick_slices_is_closed() {
    let counts = [40, 40, 14];
    let values: Vec<f32> = (0..counts.iter().product::<usize>())
        .map(|i| {
            let p = Vec3::new((i % 40) as f32, (i / 40 % 40) as f32, (i / 1600) as f32 * 3.0);
            let wave = (0.31 * p.x).sin() * (0.23 * p.y).cos() + (0.17 * p.z + 0.1 * p.x).sin();
            (700.0 * wave - 40.0 * (p.truncate() - 20.0).length() + 500.0).clamp(-1024.0, 2000.0).round()
        })
        .collect();
    for steps in [straight(1.0, 1.0, 3.0), straight(0.7, 0.7, 5.0), straight(5.0, 0.7, -0.7)] {
        for isovalue in [300.5, -200.5, 300.0] {
            let make =
                |beyond| VolumeField::try_new(counts, values.clone(), [-3.0; 3], steps, beyond).unwrap();
            let spacing = make(Beyond::Continued).spacing();
            let (field, bounds) = closed(make(Beyond::Continued), None, isovalue);
            check(&field, bounds, 1.6 * spacing, isovalue, &format!("{steps:?} {isovalue}"));
            // What lies below.
            let below = Negated(make(Beyond::Rising).closing_at(isovalue));
            check(&below, bounds, 1.6 * spacing, -isovalue, &format!("below {steps:?} {isovalue}"));
        }
    }
}

#[test]
fn a_box_within_the_volume_cuts_the_solid_off() {
    let volume =
        || VolumeField::try_new([8; 3], vec![1.0; 512], [0.0; 3], straight(1.0, 1.0, 1.0), Beyond::Continued);
    for (low, high, spacing) in [(0.0, 7.0, 1.0), (0.5, 6.25, 1.0), (1.1, 5.9, 0.37), (3.0, 4.0, 5.0)] {
        let bounds = Bounds { min: Vec3::splat(low), max: Vec3::splat(high) };
        let (field, _) = closed(volume().unwrap(), Some(bounds), 0.5);
        let enclosed = check(&field, bounds, spacing, 0.5, &format!("{low} to {high}"));
        let whole = f64::from(high - low).powi(3);
        // Up to what a lattice makes of the edges of a cube.
        if spacing < 1.5 {
            assert!(
                enclosed > 0.6 * whole && enclosed <= whole * 1.0001,
                "{low} to {high}: {enclosed} of {whole}"
            );
        }
    }
    // What the walls do not meet stays as it is.
    let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
    let sphere = Sphere { radius: 1.0 };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1).unwrap();
    let walled = Walled::new(sphere, bounds, 0.0);
    assert_eq!(
        mesh_of(&walled, &lattice, Clustering::Integrated, 0.0),
        mesh_of(&sphere, &lattice, Clustering::Integrated, 0.0)
    );
    // And a ball that reaches through five of them is closed.
    let bounds = Bounds { min: Vec3::new(-0.5, -0.6, -0.7), max: Vec3::new(0.8, 0.9, 2.0) };
    check(&Walled::new(sphere, bounds, 0.0), bounds, 0.07, 0.0, "ball");
}

#[test]
fn a_diagonal_grid_is_closed_at_every_spacing() {
    // One axis along the diagonal of space.
    let turned = DMat3::from_cols(
        DVec3::ONE.normalize(),
        DVec3::new(1.0, -1.0, 0.0).normalize(),
        DVec3::new(1.0, 1.0, -2.0).normalize(),
    );
    for turn in
        [turned, DMat3::from_rotation_z(0.785), DMat3::from_rotation_x(0.6) * DMat3::from_rotation_y(0.5)]
    {
        let volume = VolumeField::try_new(
            [4; 3],
            vec![1.0; 64],
            [5.0, -3.0, 0.5],
            turn.to_cols_array_2d(),
            Beyond::Continued,
        );
        let field = volume.unwrap().closing_at(0.01);
        let bounds = field.closing_bounds();
        for cells in [5, 20, 40] {
            check(&field, bounds, bounds.spacing_of_cells(cells), 0.01, &format!("{turn} {cells}"));
        }
    }
}

/// A field of which nothing is known but its values.
struct Plain<'a>(&'a dyn StudyField);

impl StudyField for Plain<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p)
    }
}

#[test]
fn what_is_known_of_a_walled_field_changes_nothing() {
    let bounds = Bounds { min: Vec3::new(-0.5, -0.6, -0.7), max: Vec3::new(0.8, 0.9, 2.0) };
    let values = (0..1000).map(|i| ((i * i) % 17) as f32).collect();
    let volume =
        VolumeField::try_new([10; 3], values, [-0.9; 3], straight(0.2, 0.2, 0.3), Beyond::Continued).unwrap();
    let fields: [(&dyn StudyField, f32); 3] = [
        (&Walled::new(Sphere { radius: 1.0 }, bounds, 0.0), 0.0),
        (&Walled::new(Asteroid::default(), bounds, 0.05), 0.05),
        (&Walled::new(volume.closing_at(8.0), bounds, 8.0), 8.0),
    ];
    for (field, isovalue) in fields {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            for spacing in [0.05, 0.0431] {
                let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
                let [known, plain] = [field, &Plain(field)]
                    .map(|field: &dyn StudyField| mesh_of(field, &lattice, Clustering::Integrated, isovalue));
                assert!(known == plain && topology(&known).is_closed_manifold(), "{arrangement} {spacing}");
            }
        }
    }
}

/// Counts, steps, turn, seed and levels of samples.
fn volumes() -> impl Strategy<Value = VolumeField> {
    let counts = prop::array::uniform3(2usize..9);
    let steps = prop::array::uniform3(prop::sample::select(vec![0.2, 0.7, 1.0, 1.3, 5.0]));
    let turn = prop_oneof![
        2 => Just([0.0; 3]),
        3 => prop::array::uniform3(-3.0f64..3.0),
    ];
    let shear = prop_oneof![3 => Just(0.0), 1 => -0.7f64..0.7];
    let origin = prop::array::uniform3(-50.0f64..50.0);
    let levels = prop::sample::select(vec![1u32, 2, 7, 1000]);
    (counts, steps, turn, shear, origin, levels, any::<u64>()).prop_map(
        |(counts, [x, y, z], [a, b, c], shear, origin, levels, mut state)| {
            let turn = DMat3::from_rotation_x(a) * DMat3::from_rotation_y(b) * DMat3::from_rotation_z(c);
            let frame = DMat3::from_cols(DVec3::X, DVec3::new(shear, 1.0, 0.0), DVec3::Z);
            let steps = turn * frame * DMat3::from_diagonal(DVec3::new(x, y, z));
            let values = (0..counts.iter().product::<usize>()).map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                ((state >> 40) as u32 % (levels + 1)) as f32 / levels as f32
            });
            let values = values.collect();
            VolumeField::try_new(counts, values, origin, steps.to_cols_array_2d(), Beyond::Continued).unwrap()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Whatever the volume, the side, the isovalue, the spacing and the box.
    #[test]
    fn random_volumes_are_closed(
        volume in volumes(),
        isovalue in prop::sample::select(vec![-3.0f32, 0.0, 0.2, 0.5, 0.999, 1.0, 1.5]),
        below: bool,
        cells in 2u32..20,
        cut in prop::option::of((prop::array::uniform3(-0.2f32..0.4), prop::array::uniform3(0.5f32..1.2))),
    ) {
        let beyond = if below { Beyond::Rising } else { Beyond::Falling };
        let field = volume.with_beyond(beyond).closing_at(isovalue);
        let all = field.closing_bounds();
        let part = |share: [f32; 3]| all.min + all.size() * Vec3::from(share);
        let bounds = cut.map_or(all, |(low, high)| Bounds { min: part(low), max: part(high) });
        let spacing = bounds.spacing_of_cells(cells);
        let sides = bounds.size() / spacing;
        prop_assume!(sides.element_product() < 4000.0);
        if below {
            check(&Walled::new(Negated(field), bounds, -isovalue), bounds, spacing, -isovalue, "below");
        } else {
            if cut.is_none() {
                check(&field, bounds, spacing, isovalue, "without walls");
            }
            check(&Walled::new(field, bounds, isovalue), bounds, spacing, isovalue, "above");
        }
    }
}
