//! What methods promise, the document that says so, and what holds a mesh against it. [`Method::promises`] says who promises most of it.

use std::path::Path;

use glam::{DMat3, Vec3};
use isostudy_extract::{
    ChunkExtractor, ChunkSettings, Clustering, Cubes, Execution, Extractor, Faces, Method, Placement, Source,
    Tetrahedra, Topology, VolumeCells, from_fn, weld_chunks,
};
use isostudy_mesh::quality::quality;
use isostudy_mesh::{TriangleMesh, self_intersections};
use isostudy_trilinear::{Samples, Ties, verify};

use super::made::{Broken, Made, Mesh, ONE, of_field, on_cells, own_cells, same};
use super::volume::Volume;
use crate::survey::survey;
use crate::two_levels::{chunks, extractor, open_edges};

/// A promise.
pub(super) struct Promise {
    /// What is promised.
    pub(super) name: &'static str,
    /// The file that says so, and its words.
    pub(super) source: [&'static str; 2],
    /// Whether a method makes it.
    pub(super) is_made_by: fn(&Method) -> bool,
    /// Whether a mesh keeps it.
    pub(super) holds: fn(&Made) -> Result<(), Broken>,
}

const FRONT: &str = "crates/isostudy-extract/src/lib.rs";
const METHOD: &str = "crates/isostudy-extract/src/method.rs";
const CELLS: &str = "crates/isostudy-extract/src/method/volume_cells.rs";
const LEVELS: &str = "crates/isostudy-extract/src/levels/extractor.rs";

/// All that is promised whatever the samples. A promise that a method does not make may still hold for a volume.
pub(super) const PROMISES: [Promise; 14] = [
    Promise {
        name: "three vertices to a triangle, all finite",
        source: [FRONT, "have three different vertices"],
        is_made_by: |_| true,
        holds: |made| made.each(is_sound),
    },
    Promise {
        name: "a manifold",
        source: [
            METHOD,
            "The mesh is an oriented 2-manifold, with or without boundary, that uses all its vertices.",
        ],
        is_made_by: |method| method.promises().manifold,
        holds: |made| made.each(is_manifold),
    },
    Promise {
        name: "closed off the box",
        source: [METHOD, "The mesh has no boundary where the surface stays clear of the box."],
        is_made_by: |method| method.promises().closed_off_the_box,
        holds: |made| made.each(|mesh| is_closed_off_the_box(mesh, reach(made.method))),
    },
    Promise {
        name: "no intersections",
        source: [
            METHOD,
            "No triangle has more in common with another one than vertices and sides that both have.",
        ],
        is_made_by: |method| method.promises().no_intersections,
        holds: |made| made.each(intersects_nowhere),
    },
    Promise {
        name: "in the box",
        source: [FRONT, "Vertices lie in the lattice's box."],
        is_made_by: stays_in_the_box,
        holds: |made| made.each(is_in_the_box),
    },
    Promise {
        name: "an area to every triangle",
        source: [FRONT, "no unclustered triangle is without area"],
        is_made_by: is_without_slivers,
        holds: |made| made.each(has_areas),
    },
    Promise {
        name: "the same triangles for all placements",
        source: [METHOD, "Triangles are the same, number by number, wherever vertices are placed"],
        is_made_by: |method| method.promises().same_triangles_for_all_placements,
        holds: placements_do_not_show,
    },
    Promise {
        name: "the same bytes on any number of threads",
        source: [
            FRONT,
            "The same field, lattice and settings give the same mesh to the byte, on any number of threads.",
        ],
        is_made_by: |_| true,
        holds: threads_do_not_show,
    },
    Promise {
        name: "samples suffice",
        source: [
            METHOD,
            "Whether the samples at the corners of a grid's cells are all that the method asks for",
        ],
        is_made_by: Method::is_of_corners,
        holds: samples_make_the_mesh_of_the_field,
    },
    Promise {
        name: "chunks weld to the whole",
        source: [
            METHOD,
            "Boxes of cells that fill the grid, extracted one by one, weld to the mesh of the whole, to the byte.",
        ],
        is_made_by: |method| method.promises().chunks,
        holds: chunks_weld_to_the_whole,
    },
    Promise {
        name: "levels have no open edge between them",
        source: [LEVELS, "have no open edge between them, whatever the field"],
        is_made_by: has_levels,
        holds: levels_weld_to_a_closed_mesh,
    },
    Promise {
        name: "the same triangles whatever the steps",
        source: [CELLS, "The same volume with other steps has the same triangles"],
        is_made_by: Method::is_of_cubes,
        holds: steps_do_not_show,
    },
    Promise {
        name: "the same bytes by bricks",
        source: [CELLS, "Extracts the same mesh, to the byte, without reading rows"],
        is_made_by: Method::is_of_cubes,
        holds: bricks_do_not_show,
    },
    Promise {
        name: "the topology of the trilinear interpolant",
        source: [
            FRONT,
            "the mesh has the components, tunnels and boundary loops of the trilinear interpolant of the samples",
        ],
        is_made_by: is_trilinear,
        holds: has_the_topology_of_the_samples,
    },
];

/// Whether the file says so, in these words, however its lines are broken.
pub(super) fn is_said([file, words]: [&str; 2]) -> bool {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file);
    let text = std::fs::read_to_string(path).expect("a file of the repository");
    let lines =
        text.lines().map(|line| line.trim().trim_start_matches('/').trim_start_matches(['!', '-', ' ']));
    lines.collect::<Vec<_>>().join(" ").contains(words)
}

/// As the front page of the crate says of each family: not as published, and not where a vertex may leave its cube.
fn stays_in_the_box(method: &Method) -> bool {
    match method {
        Method::DualContouring(planes) => planes.in_cell,
        Method::Tetrahedra(tetrahedra) => tetrahedra.topology == Topology::Guarded,
        _ => true,
    }
}

/// Crossings alone, or what is collapsed of them.
fn is_without_slivers(method: &Method) -> bool {
    match method {
        Method::Tetrahedra(Tetrahedra { topology, placement, clustering, .. }) => {
            *topology == Topology::Guarded
                && *placement == Placement::MeanOfCrossings
                && [Clustering::None, Clustering::EdgeCollapse].contains(clustering)
        }
        Method::Cubes(_) => true,
        _ => false,
    }
}

fn has_levels(method: &Method) -> bool {
    match method {
        Method::Cubes(_) => true,
        Method::SurfaceNets(nets) => !nets.patches,
        Method::DualContouring(nets) => !nets.patches,
        _ => false,
    }
}

fn is_trilinear(method: &Method) -> bool {
    matches!(method, Method::Cubes(Cubes { faces: Faces::Trilinear, .. }))
}

fn is_sound(Mesh { mesh, .. }: &Mesh) -> Result<(), String> {
    let TriangleMesh { positions, normals, triangles } = mesh;
    if normals.len() != positions.len() {
        return Err(format!("{} normals of {} vertices", normals.len(), positions.len()));
    }
    if let Some(p) = positions.iter().chain(normals).find(|p| !p.is_finite()) {
        return Err(format!("{p} is a position or a normal"));
    }
    let is_wrong = |&[a, b, c]: &[u32; 3]| {
        a == b || b == c || c == a || [a, b, c].iter().any(|&v| v as usize >= positions.len())
    };
    match triangles.iter().find(|triangle| is_wrong(triangle)) {
        Some(triangle) => Err(format!("a triangle {triangle:?} of {} vertices", positions.len())),
        None => Ok(()),
    }
}

fn is_manifold(Mesh { mesh, .. }: &Mesh) -> Result<(), String> {
    survey(mesh.positions.len(), &mesh.triangles).map(drop)
}

fn intersects_nowhere(Mesh { mesh, .. }: &Mesh) -> Result<(), String> {
    if mesh.triangles.is_empty() {
        return Ok(());
    }
    match self_intersections(mesh).map_err(|e| e.to_string())? {
        0 => Ok(()),
        pairs => Err(format!("{pairs} pairs of triangles that intersect")),
    }
}

/// How far from the box the mesh may end where the surface meets it, in cubes: in the outermost cubes, or where their vertices go.
fn reach(method: &Method) -> f32 {
    match method {
        Method::DualContouring(planes) if !planes.in_cell => 2.0,
        _ => 1.0,
    }
}

/// No edge is open where the surface stays clear of the box; else both its ends are near the box.
fn is_closed_off_the_box(Mesh { mesh, bounds, spacing, closed }: &Mesh, reach: f32) -> Result<(), String> {
    if *closed {
        let open = open_edges(mesh);
        return if open == 0 { Ok(()) } else { Err(format!("{open} open edges")) };
    }
    let is_near = |p: Vec3| (p - bounds.min).min(bounds.max - p).min_element() <= 1.001 * reach * spacing;
    let far = boundary(mesh).into_iter().flatten().find(|&v| !is_near(mesh.positions[v as usize]));
    far.map_or(Ok(()), |v| Err(format!("an open edge ends in {}, off the box", mesh.positions[v as usize])))
}

/// Sides of one triangle.
fn boundary(mesh: &TriangleMesh) -> Vec<[u32; 2]> {
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    sides.sort_unstable();
    sides.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}

fn is_in_the_box(Mesh { mesh, bounds, .. }: &Mesh) -> Result<(), String> {
    let out = mesh.positions.iter().find(|p| !(p.cmpge(bounds.min) & p.cmple(bounds.max)).all());
    out.map_or(Ok(()), |p| Err(format!("{p} is not from {} to {}", bounds.min, bounds.max)))
}

fn has_areas(Mesh { mesh, .. }: &Mesh) -> Result<(), String> {
    match quality(mesh).degenerate {
        0 => Ok(()),
        count => Err(format!("{count} triangles without area")),
    }
}

fn placements_do_not_show(made: &Made) -> Result<(), Broken> {
    let Some((sampled, mesh)) = &made.of_field else { return Ok(()) };
    let placement = Placement::Relaxed;
    let other = match *made.method {
        Method::Tetrahedra(tetrahedra) => Method::Tetrahedra(tetrahedra.with_placement(placement)),
        Method::Cubes(cubes) => Method::Cubes(cubes.with_placement(placement)),
        _ => return Err(Broken::of_field("the method has no placements".to_owned())),
    };
    let other = of_field(&other, sampled, made.volume.isovalue, &ONE).map_err(Broken::of_field)?;
    let is_same = other.triangles == mesh.mesh.triangles;
    if is_same { Ok(()) } else { Err(Broken::of_field("relaxed, the triangles are others".to_owned())) }
}

fn threads_do_not_show(made: &Made) -> Result<(), Broken> {
    let Made { method, volume, .. } = made;
    if volume.threads == 1 {
        return Ok(());
    }
    let several = Execution { threads: volume.threads };
    if let Some(mesh) = &made.on_cells {
        let other = on_cells(method, &own_cells(volume), volume.isovalue, &several);
        other.and_then(|other| same(&mesh.mesh, &other)).map_err(Broken::on_cells)?;
    }
    if let Some((sampled, mesh)) = &made.of_field {
        let other = of_field(method, sampled, volume.isovalue, &several);
        other.and_then(|other| same(&mesh.mesh, &other)).map_err(Broken::of_field)?;
    }
    Ok(())
}

fn samples_make_the_mesh_of_the_field(made: &Made) -> Result<(), Broken> {
    let Some((sampled, mesh)) = &made.of_field else { return Ok(()) };
    let make = || {
        let cubes = Method::Cubes(Cubes::default());
        let samples = cubes.corner_samples(&*sampled.field, &sampled.grid).map_err(|e| e.to_string())?;
        let samples = samples.expect("cubes have corners");
        let source = Source::Samples(&samples.values);
        let mut extractor = Extractor::new();
        let other = made.method.extract(&mut extractor, source, &sampled.grid, made.volume.isovalue, &ONE);
        same(&mesh.mesh, &other.map_err(|e| e.to_string())?.mesh)
    };
    make().map_err(Broken::of_field)
}

fn chunks_weld_to_the_whole(made: &Made) -> Result<(), Broken> {
    let Some((sampled, mesh)) = &made.of_field else { return Ok(()) };
    let make = || {
        let settings = ChunkSettings::default().with_isovalue(made.volume.isovalue);
        let extractor = ChunkExtractor::in_box(&sampled.grid, made.method, &settings);
        let mut extractor = extractor.map_err(|e| e.to_string())?;
        // Two along each axis; the last may be small or none.
        let cells = made.method.cells(&sampled.grid).map_err(|e| e.to_string())?;
        let most = cells.into_iter().max().unwrap_or(1);
        let boxes = extractor.grid(most.div_ceil(2) + made.volume.chunk);
        let source = Source::Study(&*sampled.field);
        let parts: Result<Vec<_>, _> = boxes.map(|cells| extractor.extract(source, cells, &ONE)).collect();
        let welded = weld_chunks(&parts.map_err(|e| e.to_string())?).map_err(|e| e.to_string())?;
        same(&mesh.mesh, &welded)
    };
    make().map_err(Broken::of_field)
}

/// Cells along a side of a coarse chunk.
const COARSE: i32 = 3;

/// The volume closed at its sides, in the middle of eight chunks.
fn levels_weld_to_a_closed_mesh(made: &Made) -> Result<(), Broken> {
    let Some(volume) = made.volume.interpolated() else { return Ok(()) };
    let isovalue = made.volume.isovalue;
    let volume = volume.closing_at(isovalue);
    let bounds = volume.closing_bounds();
    let centre = (bounds.min + bounds.max) * 0.5;
    // Some room beside.
    let spacing = 0.55 * bounds.size().max_element() / (2 * COARSE) as f32;
    let field = from_fn(|p| isostudy_extract::StudyField::sample(&volume, Vec3::from(p) + centre) - isovalue);
    let mut extractor = extractor(f64::from(spacing), made.method);
    let parts = chunks(&mut extractor, &field, made.volume.fine, COARSE);
    let welded = weld_chunks(&parts).map_err(|e| Broken::of_field(e.to_string()))?;
    match open_edges(&welded) {
        0 => Ok(()),
        open => Err(Broken::of_field(format!("{open} open edges"))),
    }
}

/// Triangles face outward wherever the steps lead: where these are mirrored, two corners are exchanged.
fn steps_do_not_show(made: &Made) -> Result<(), Broken> {
    let Some(mesh) = &made.on_cells else { return Ok(()) };
    let Volume { counts, ref values, origin, steps, isovalue, .. } = *made.volume;
    let cells = VolumeCells { counts, values, origin, steps };
    let placed = on_cells(made.method, &cells, isovalue, &ONE).map_err(Broken::on_cells)?;
    let is_mirrored = DMat3::from_cols_array_2d(&steps).determinant() < 0.0;
    let facing = |&[a, b, c]: &[u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
    let is_same = placed.triangles.iter().map(facing).eq(mesh.mesh.triangles.iter().copied());
    if is_same { Ok(()) } else { Err(Broken::on_cells("other triangles than on cubes".to_owned())) }
}

fn bricks_do_not_show(made: &Made) -> Result<(), Broken> {
    let Some(mesh) = &made.on_cells else { return Ok(()) };
    let cells = own_cells(made.volume);
    let make = || {
        let bricks = cells.bricks().map_err(|e| e.to_string())?;
        let mut extractor = Extractor::new();
        let other = cells.extract_by_bricks(&bricks, made.method, &mut extractor, made.volume.isovalue, &ONE);
        same(&mesh.mesh, &other.map_err(|e| e.to_string())?.mesh)
    };
    make().map_err(Broken::on_cells)
}

/// How many times as far from nought as another a sample, the isovalue or their difference may be, for
/// [`has_the_topology_of_the_samples`]. The place of a tunnel's saddle is the root of a quadratic in double precision, known to about
/// 1e-8. Beyond, a tunnel may be missed or made: of -1, 1, 1e-40 and 0 at the corners of a cell, which was the first that was found.
const FARTHER: f64 = 1e7;

/// Of samples that are numbers; others have no interpolant.
fn has_the_topology_of_the_samples(made: &Made) -> Result<(), Broken> {
    let Some(mesh) = &made.on_cells else { return Ok(()) };
    let Ok(samples) = Samples::try_new(made.volume.counts, &made.volume.values) else { return Ok(()) };
    let isovalue = f64::from(made.volume.isovalue);
    let values = made.volume.values.iter().map(|&v| f64::from(v));
    let sizes = values.flat_map(|v| [v, v - isovalue]).map(f64::abs).filter(|&size| size > 0.0);
    let (least, most) =
        sizes.fold((f64::MAX, 0.0), |(least, most): (f64, f64), s| (least.min(s), most.max(s)));
    if most > FARTHER * least {
        return Ok(());
    }
    let verdict = verify(&mesh.mesh, &samples, made.volume.isovalue, Ties::Outside);
    let verdict = verdict.map_err(|e| Broken::on_cells(e.to_string()))?;
    let wrong = verdict.findings.first();
    wrong.map_or(Ok(()), |f| Err(Broken::on_cells(format!("{} {}, not {}", f.found, f.fault, f.expected))))
}
