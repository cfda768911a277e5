//! Best-of-many CPU and stage times of the streaming extractor with samples in memory, for quick comparisons.
//! Arguments: cells along an axis, repetitions, part of a case's name.

mod given;

use given::{cpu_ms, samples};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{Arrangement, Clustering, Execution, Extraction, Extractor, Source};
use isostudy_field::{Asteroid, Sphere, StudyField};
use isostudy_mesh::Bounds;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let cells: u32 = arguments.next().map_or(256, |a| a.parse().unwrap());
    let repetitions: usize = arguments.next().map_or(20, |a| a.parse().unwrap());
    let wanted = arguments.next().unwrap_or_default();
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        let lattice = Lattice::try_new(arrangement, bounds, 2.0 / cells as f32).unwrap();
        let fields: [(&str, &dyn StudyField); 2] =
            [("sphere 0.8", &Sphere { radius: 0.8 }), ("asteroid", &Asteroid::default())];
        for (name, field) in fields {
            let mut values = None;
            for clustering in [Clustering::Integrated, Clustering::None] {
                for threads in [1, 2] {
                    let id = format!("{arrangement:?} {name} {clustering:?} {threads}");
                    if !id.contains(&wanted) {
                        continue;
                    }
                    let values = values.get_or_insert_with(|| samples(field, &lattice));
                    let settings = ExtractSettings::default().with_clustering(clustering);
                    let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
                    let mut best: Option<(f64, Extraction)> = None;
                    let mut walls = Vec::new();
                    for _ in 0..repetitions {
                        let start = cpu_ms();
                        let execution = Execution { threads };
                        extractor
                            .extract_into(
                                Source::Samples(values),
                                &lattice,
                                &settings,
                                &execution,
                                &mut extraction,
                            )
                            .unwrap();
                        let ms = cpu_ms() - start;
                        walls.push(extraction.times.total().as_secs_f64() * 1e3);
                        if best.as_ref().is_none_or(|b| ms < b.0) {
                            best = Some((ms, extraction.clone()));
                        }
                    }
                    walls.sort_by(f64::total_cmp);
                    let (wall, median) = (walls[0], walls[walls.len() / 2]);
                    let (ms, e) = best.unwrap();
                    let t = |d: std::time::Duration| d.as_secs_f64() * 1e3;
                    println!(
                        "{arrangement:?} {name} {clustering:?} threads {threads}: wall {wall:.1} ms, median {median:.1} ms, first thread's CPU {ms:.1} ms (alloc {:.1} signs {:.1} \
                         vertex {:.1} geometry {:.1} normals {:.1}) V {} T {}",
                        t(e.times.allocation),
                        t(e.times.sampling),
                        t(e.times.vertex),
                        t(e.times.geometry),
                        t(e.times.normals),
                        e.counts.vertices,
                        e.counts.triangles
                    );
                }
            }
        }
    }
}
