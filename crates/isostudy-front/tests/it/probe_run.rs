use crate::shapes::*;
use isostudy_field::*;
use isostudy_front::{Front, grow};
use isostudy_mesh::{Bounds, quality::quality, self_intersections, topology::topology};
use isostudy_mesh::glam::Vec3;

#[test]
fn explore() {
    let ground = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    let hills = TerrainSettings { margin: 0.013, ..TerrainCharacter::Hills.settings(3) };
    let cliffs = TerrainSettings { margin: 0.013, ..TerrainCharacter::Cliffs.settings(3) };
    let open = TerrainSettings { closed: false, ..TerrainCharacter::Hills.settings(3) };
    let (torus, double) = (torus(0.7, 0.25), double_torus());
    let t = |s| Box::new(Terrain::try_new(s, ground).unwrap());
    let all: Vec<(&str, Box<dyn StudyField + '_>, Bounds)> = vec![
        ("sphere", Box::new(Sphere { radius: 1.0 }), cube(1.1)),
        ("sphere cut", Box::new(Sphere { radius: 1.0 }), cube(0.8)),
        ("torus", Box::new(Plain(&torus)), cube(1.1)),
        ("double", Box::new(Plain(&double)), cube(1.3)),
        ("gyroid", Box::new(Gyroid::default()), cube(1.0)),
        ("asteroid", Box::new(Asteroid::default()), cube(1.1)),
        ("open", t(open), ground),
        ("hills", t(hills), ground),
        ("cliffs", t(cliffs), ground),
    ];
    let only = std::env::var("ONLY").unwrap_or_default();
    let edges = std::env::var("EDGES").unwrap_or("0.2,0.1,0.05".into());
    for (name, field, bounds) in all.iter().filter(|of| of.0.starts_with(&only)) {
        for edge in edges.split(',').map(|e| e.parse::<f64>().unwrap()) {
            let began = std::time::Instant::now();
            let made = grow(&**field, *bounds, 0.0, &Front::of_edge(edge));
            let s = began.elapsed().as_secs_f64();
            match made {
                Ok(made) => {
                    let (q, t) = (quality(&made.mesh), topology(&made.mesh));
                    println!("{name} {edge}: {} tri chi {} comp {} loops {} angle {:.1} mean-min {:.1} si {:?} evals/v {:.1} {:.1} {s:.2}s {:?}", t.triangles, t.euler_characteristic, t.components, t.boundary_loops, q.min_angle_deg.min, q.min_angle_deg.mean, self_intersections(&made.mesh), made.counts.evaluations as f64 / t.vertices as f64, made.counts.gradients as f64 / t.vertices as f64, made.counts);
                    sound(&made.mesh, *bounds);
                }
                Err(e) => println!("{name} {edge}: {e} {s:.2}s"),
            }
        }
    }
}
