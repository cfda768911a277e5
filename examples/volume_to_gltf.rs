//! A volume becomes a binary glTF file, which browsers and game engines show.
//!
//! cargo run --release -p isostudy-volume --example volume_to_gltf -- head.nrrd 300.5 head.glb

use std::env::args;
use std::error::Error;
use std::fs::File;

use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::{Beyond, VolumeField};
use isostudy_mesh::write_glb;

fn main() -> Result<(), Box<dyn Error>> {
    let [Some(input), Some(isovalue), Some(output)] = [1, 2, 3].map(|n| args().nth(n)) else {
        return Err("usage: volume_to_gltf VOLUME ISOVALUE OUTPUT.glb".into());
    };
    let volume = isostudy_volume::read(input.as_ref(), isostudy_volume::NO_LIMIT)?;
    println!("{:?} samples", volume.counts);
    // Where the surface leaves the volume it is closed; without `closing_at` the lattice's box would cut it off.
    let isovalue = isovalue.parse()?;
    let field =
        VolumeField::try_new(volume.counts, volume.values, volume.origin, volume.steps, Beyond::Falling)?
            .closing_at(isovalue);

    // One cube a sample, over all samples and a little more. Inside is what is brighter than the isovalue.
    let lattice = Lattice::try_new(Arrangement::BodyCentred, field.closing_bounds(), field.spacing())?;
    let settings = ExtractSettings::default().with_isovalue(isovalue);
    let mut surface = extract(&field, &lattice, &settings, &Execution::default())?.mesh;

    // glTF has y up; most scans have z. Turning keeps normals normals.
    for v in surface.positions.iter_mut().chain(&mut surface.normals) {
        *v = [v.x, v.z, -v.y].into();
    }
    write_glb(&surface, File::create(&output)?)?;
    println!("{output}: {} triangles", surface.triangles.len());
    Ok(())
}
