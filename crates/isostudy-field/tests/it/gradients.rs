//! Gradients are those of the values: against differences between samples, at random places.

#![cfg(feature = "shapes")]

use glam::{DVec3, Vec3};
use isostudy_field::{
    Asteroid, Fractal, Gyroid, MeshDistance, Negated, NoiseShape, ScalarField, Sphere, StudyField, Terrain,
    TerrainCharacter, TerrainSettings, Walled,
};
use isostudy_mesh::{Bounds, TriangleMesh};

const BOUNDS: Bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };

/// Numbers from 0 to 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn places(count: usize, seed: u64) -> Vec<Vec3> {
    let mut random = numbers(seed);
    (0..count).map(|_| Vec3::from_array(std::array::from_fn(|_| 2.0 * random() as f32 - 1.0))).collect()
}

/// The gradient by differences; `None` where those to either side do not agree, as at a crease.
fn by_differences(field: &dyn StudyField, p: Vec3) -> Option<DVec3> {
    let here = f64::from(field.sample(p));
    let slope = |axis: usize, step: f32| {
        let mut there = p;
        there[axis] += step;
        (f64::from(field.sample(there)) - here) / (f64::from(there[axis]) - f64::from(p[axis]))
    };
    let [low, high] = [-2e-4, 2e-4].map(|step| DVec3::new(slope(0, step), slope(1, step), slope(2, step)));
    (low.distance(high) < 5e-3 * (1.0 + high.length())).then_some((low + high) * 0.5)
}

/// Of so many random places, at least this share has differences that agree, and there the gradient is theirs.
fn check(name: &str, field: &dyn StudyField, least_share: f64) {
    let places = places(2_000, 7);
    let mut smooth = 0;
    for &p in &places {
        let Some(want) = by_differences(field, p) else { continue };
        let found = field.gradient(p).unwrap_or_else(|| panic!("{name}: none at {p}")).as_dvec3();
        smooth += 1;
        assert!(found.distance(want) < 5e-3 * (1.0 + want.length()), "{name} at {p}: {found}, not {want}");
    }
    assert!(f64::from(smooth) > least_share * places.len() as f64, "{name}: {smooth} smooth places");
}

/// An octahedron whose sides are divided and whose vertices are moved, so that it has dents and folds.
fn rock() -> TriangleMesh {
    let mut triangles: Vec<[Vec3; 3]> = Vec::new();
    for octant in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1.0_f32 } else { -1.0 });
        let [a, b, c] = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
        triangles.push(if x * y * z > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..3 {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let moved = |p: Vec3| {
        let q = p.normalize();
        q * (0.55 + 0.12 * (7.0 * q.x).sin() * (5.0 * q.y + 1.0).cos() + 0.08 * (9.0 * q.z).sin())
    };
    let soup = TriangleMesh {
        positions: triangles.iter().flatten().map(|&p| moved(p)).collect(),
        normals: Vec::new(),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    };
    isostudy_mesh::weld(&soup)
}

#[test]
fn formulas_have_their_gradients() {
    check("sphere", &Sphere { radius: 0.7 }, 0.99);
    check("gyroid", &Gyroid::default(), 0.9);
    check("asteroid", &Asteroid::default(), 0.95);
    let stretched =
        Asteroid { octaves: 5, lacunarity: 2.0, stretch: Vec3::new(0.6, 1.3, 0.8), ..Asteroid::default() };
    check("stretched asteroid", &stretched, 0.8);
    // The tables say the same.
    let mut kept = isostudy_field::FieldCache::default();
    let table = stretched.prepared(&mut kept).unwrap();
    for p in places(100, 3) {
        assert_eq!(table.gradient(p), StudyField::gradient(&stretched, p));
    }
    assert_eq!(StudyField::gradient(&Asteroid::default(), Vec3::ZERO), None);
}

#[test]
fn terrains_have_their_gradients() {
    for character in TerrainCharacter::ALL {
        for seed in 0..4 {
            for closed in [false, true] {
                let settings = TerrainSettings { closed, margin: 0.05, ..character.settings(seed) };
                let terrain = Terrain::try_new(settings, BOUNDS).unwrap();
                check(&format!("{character:?} {seed} {closed}"), &terrain, 0.5);
            }
        }
    }
}

#[test]
fn sums_of_noise_have_their_gradients() {
    let mut random = numbers(5);
    for shape in [NoiseShape::Plain, NoiseShape::Ridged, NoiseShape::Billowed] {
        let fractal = Fractal::new(shape, 3, 0.5, 11);
        for _ in 0..2_000 {
            let p = DVec3::from_array(std::array::from_fn(|_| 8.0 * random() - 4.0));
            let (value, gradient) = fractal.value_and_gradient(p);
            assert_eq!(value.to_bits(), fractal.value(p).to_bits());
            let slope = |axis: usize, step: f64| {
                let step = DVec3::AXES[axis] * step;
                (fractal.value(p + step) - fractal.value(p - step)) / (2.0 * step.length())
            };
            // At a crease they do not agree.
            let [narrow, wide] =
                [0.7e-5, 2e-5].map(|step| DVec3::new(slope(0, step), slope(1, step), slope(2, step)));
            if narrow.distance(wide) < 1e-6 {
                assert!(gradient.distance(narrow) < 1e-6, "{shape:?} at {p}: {gradient}, not {narrow}");
            }
        }
    }
}

#[test]
fn meshes_have_the_gradient_of_their_distance() {
    let rock = rock();
    let field = MeshDistance::try_new(&rock).unwrap();
    check("rock", &field, 0.9);
    check("rock turned round", &Negated(field.clone()), 0.9);
    // Near a hole there is none, and elsewhere it is that of the distance.
    let open = TriangleMesh { triangles: rock.triangles[8..].to_vec(), ..rock.clone() };
    let open = MeshDistance::try_from_any(&open, isostudy_field::Holes::Span).unwrap();
    let (mut without, mut with) = (0, 0);
    for p in places(2_000, 9) {
        let Some(found) = StudyField::gradient(&open, p) else {
            without += 1;
            continue;
        };
        with += 1;
        let Some(want) = by_differences(&open, p) else { continue };
        assert!(found.as_dvec3().distance(want) < 1e-2, "{p}: {found}, not {want}");
    }
    assert!(without > 20 && with > 200, "{without} {with}");
}

/// On the surface there is no way to go to it: the triangle's own normal counts, whatever rounding makes of the place.
#[test]
fn on_a_triangle_the_gradient_is_against_its_normal() {
    let rock = rock();
    let field = MeshDistance::try_new(&rock).unwrap();
    let mut random = numbers(1);
    for t in 0..rock.triangles.len() {
        let [a, b, c] = rock.corners(t);
        let outward = (b - a).cross(c - a).normalize();
        for _ in 0..8 {
            let [u, v] = [(); 2].map(|()| 0.05 + 0.4 * random() as f32);
            let p = a + (b - a) * u + (c - a) * v;
            let found = StudyField::gradient(&field, p).unwrap();
            assert!(found.distance(-outward) < 1e-5, "{t}: {found}, not {}", -outward);
        }
    }
}

/// A field in plain numbers knows what it knows, and walls have no gradient.
#[test]
fn wrappers_pass_gradients_on() {
    let sphere = Sphere { radius: 0.7 };
    let p = Vec3::new(0.3, 0.1, -0.2);
    assert_eq!(ScalarField::gradient(&sphere, p.into()).map(Vec3::from), StudyField::gradient(&sphere, p));
    let walled = Walled::new(sphere, Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) }, 0.0);
    assert_eq!(StudyField::gradient(&walled, p), StudyField::gradient(&sphere, p));
    assert_eq!(StudyField::gradient(&walled, Vec3::new(0.5, 0.0, 0.0)), None);
}
