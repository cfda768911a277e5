//! A mesh is extracted again from its distance field, at three spacings: even triangles, as many as are wanted.
//!
//! cargo run --release -p isostudy-extract --example mesh_three_spacings -- scan.ply coarse

use std::env::args;
use std::error::Error;
use std::fs::{File, read};
use std::path::Path;

use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{Arrangement, Execution, Extractor, Source};
use isostudy_field::{Holes, MeshDistance};
use isostudy_mesh::{MeshFormat, quality::quality, weld};

fn main() -> Result<(), Box<dyn Error>> {
    let [Some(input), Some(stem)] = [1, 2].map(|n| args().nth(n)) else {
        return Err("usage: mesh_three_spacings MESH OUTPUT-WITHOUT-ENDING".into());
    };
    let extension = Path::new(&input).extension().unwrap_or_default().to_string_lossy();
    let format = MeshFormat::from_extension(&extension).ok_or("not .obj, .ply or .stl")?;
    let mesh = weld(&format.read(&*read(&input)?)?);

    // Holes are spanned; `Holes::Refuse` would say where the largest is.
    let field = MeshDistance::try_from_any(&mesh, Holes::Span)?;
    let tight = mesh.surface_bounds().ok_or("the mesh is empty")?;
    // Its buffers serve all three.
    let mut extractor = Extractor::new();
    for cells in [32, 64, 128] {
        let spacing = tight.spacing_of_cells(cells);
        let lattice = Lattice::try_new(Arrangement::BodyCentred, tight.grown(2.0 * spacing), spacing)?;
        let settings = ExtractSettings::default();
        let surface =
            extractor.extract(Source::Study(&field), &lattice, &settings, &Execution::default())?.mesh;

        let path = format!("{stem}-{cells}.ply");
        isostudy_mesh::write_ply(&surface, File::create(&path)?)?;
        let worth = quality(&surface).radius_ratio.mean;
        println!(
            "{path}: spacing {spacing}, {} triangles, mean radius ratio {worth:.3}",
            surface.triangles.len()
        );
    }
    Ok(())
}
