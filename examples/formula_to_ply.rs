//! A formula becomes a PLY file.
//!
//! cargo run --release -p isostudy-expression --example formula_to_ply -- 'length(length(x, y) - 0.7, z) - 0.3' torus.ply

use std::env::args;
use std::error::Error;
use std::fs::File;

use isostudy_expression::Expression;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::Negated;
use isostudy_mesh::{Bounds, glam::Vec3, topology::topology, write_ply};

fn main() -> Result<(), Box<dyn Error>> {
    let formula = args().nth(1).unwrap_or("sqrt(x^2 + y^2 + z^2) - 1".into());
    let path = args().nth(2).unwrap_or("formula.ply".into());

    // Formulas are mostly distances, negative inside; the extractor takes what is above the isovalue for inside.
    let field = Negated(formula.parse::<Expression>()?);
    let bounds = Bounds { min: Vec3::splat(-1.2), max: Vec3::splat(1.2) };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.05)?;
    let surface = extract(&field, &lattice, &ExtractSettings::default(), &Execution::default())?.mesh;

    write_ply(&surface, File::create(&path)?)?;
    let report = topology(&surface);
    println!("{path}: {} triangles, Euler characteristic {}", report.triangles, report.euler_characteristic);
    Ok(())
}
