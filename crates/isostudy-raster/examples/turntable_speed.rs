//! Times the stages of the study's turntables, and leaves pictures to look at:
//! `cargo run --release -p isostudy-raster --example turntable_speed -- FOLDER`

#[path = "../tests/it/shapes.rs"]
mod shapes;

use isostudy_raster::{
    Animation, Look, Panel, Shading, Sheet, Turntable, panels, pixmap_to_png, render, turntable,
};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).map_or_else(std::env::temp_dir, std::path::PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let (settings, shading) = (Turntable::default(), Shading::default());
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (name, mesh) in [
        ("sphere 20k", shapes::sphere(1.0, 71)),
        ("sphere 100k", shapes::sphere(1.0, 159)),
        ("torus 20k", shapes::torus(0.7, 0.3, 140, 70)),
    ] {
        let start = Instant::now();
        let animation = one.install(|| turntable(&mesh, &settings, &shading, Look::Smooth, &|| ()))?;
        let drawn = start.elapsed();
        let pair = animation.side_by_side(&animation)?;
        let paired = start.elapsed() - drawn;
        println!(
            "{name}: {} triangles, {:.2} ms a frame, pair in {:.0} ms",
            mesh.triangles.len(),
            drawn.as_secs_f64() * 1e3 / settings.frames as f64,
            paired.as_secs_f64() * 1e3
        );
        for (what, animation) in [("turntable", &animation), ("pair", &pair), ("pair x 2", &pair.scaled(2))] {
            let start = Instant::now();
            let mut file = Vec::new();
            one.install(|| animation.write_gif(&mut file))?;
            let written = start.elapsed();
            let read = Instant::now();
            assert_eq!(&Animation::read_gif(&file[..])?, animation);
            println!(
                "  {what} GIF: {:.2} MB, written in {:.0} ms of one thread, read in {:.0} ms",
                file.len() as f64 / 1e6,
                written.as_secs_f64() * 1e3,
                read.elapsed().as_secs_f64() * 1e3
            );
            if what == "turntable" {
                std::fs::write(folder.join(format!("{}.gif", name.replace(' ', "_"))), &file)?;
            }
        }
    }

    let meshes = [("sphere", shapes::sphere(1.0, 14)), ("torus", shapes::torus(0.7, 0.3, 36, 18))];
    let mut pictures = Vec::new();
    for (name, mesh) in &meshes {
        for look in [Look::Smooth, Look::Flat, Look::Wireframe, Look::SmoothWireframe] {
            let picture = render(mesh, &settings.camera(20), settings.viewport(), &shading, look)?;
            pictures.push((picture, format!("{name}, {look:?}")));
        }
    }
    let sheet =
        Sheet { columns: 4, title: Some("Looks: spacing 0.1 µm, α ≤ 60°".into()), ..Sheet::default() };
    let list: Vec<Panel> = pictures.iter().map(|(picture, label)| Panel { picture, label }).collect();
    std::fs::write(folder.join("looks.png"), pixmap_to_png(&panels(&list, &sheet)?))?;

    let small = Turntable { width: 256, height: 256, frames: 6, ..settings };
    let mesh = shapes::torus(0.7, 0.3, 100, 50);
    for look in [Look::Smooth, Look::SmoothWireframe] {
        let animation = turntable(&mesh, &small, &shading, look, &|| ())?;
        let frames: Vec<_> = (0..6).map(|i| (animation.picture(i), format!("frame {i}"))).collect();
        let list: Vec<Panel> = frames.iter().map(|(picture, label)| Panel { picture, label }).collect();
        std::fs::write(folder.join(format!("frames_{look:?}.png")), pixmap_to_png(&panels(&list, &sheet)?))?;
    }
    Ok(())
}
