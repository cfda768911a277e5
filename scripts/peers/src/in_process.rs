//! What runs in this process: isostudy's own configurations and the two Rust crates.

use crate::{Grid, Outcome, Peer, REACH, field};
use anyhow::Result;
use extract::{Arrangement, Clustering, Execution, ExtractSettings, Lattice};
use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::Vec3;
use isosurface::marching_cubes::MarchingCubes;
use isosurface::source::Source;
use mesh::{Bounds, TriangleMesh};
use std::time::Instant;

pub(crate) fn peers() -> Vec<Box<dyn Peer>> {
    let mut peers: Vec<Box<dyn Peer>> = Vec::new();
    for (label, arrangement, clustering) in [
        ("isostudy bi", Arrangement::BodyCentred, Clustering::Integrated),
        ("isostudy bu", Arrangement::BodyCentred, Clustering::None),
        ("isostudy si", Arrangement::SimpleCubic, Clustering::Integrated),
        ("isostudy su", Arrangement::SimpleCubic, Clustering::None),
    ] {
        peers.push(Box::new(Ours { label, arrangement, clustering }));
    }
    peers.push(Box::new(SurfaceNets::default()));
    peers.push(Box::new(Cubes));
    peers
}

struct Ours {
    label: &'static str,
    arrangement: Arrangement,
    clustering: Clustering,
}

impl Peer for Ours {
    fn name(&self) -> String {
        format!(
            "{}; calls the field, the time of which is taken off; normals are not in its time",
            self.label
        )
    }

    fn extract(&mut self, grid: &Grid, with_mesh: bool) -> Result<Outcome> {
        let bounds = Bounds { min: Vec3::splat(-REACH), max: Vec3::splat(REACH) };
        let lattice = Lattice::try_new(self.arrangement, bounds, grid.spacing)?;
        let settings = ExtractSettings { clustering: self.clustering, ..Default::default() };
        let made = extract::extract(&*field(grid.field), &lattice, &settings, &Execution { threads: 1 })?;
        let times = made.times;
        let extraction = times.allocation + times.vertex + times.geometry + times.clustering;
        Ok(Outcome {
            extraction_s: extraction.as_secs_f64(),
            sampling_s: times.sampling.as_secs_f64(),
            mesh: with_mesh.then_some(made.mesh),
        })
    }
}

#[derive(Default)]
struct SurfaceNets {
    buffer: SurfaceNetsBuffer,
    negated: Vec<f32>,
}

impl Peer for SurfaceNets {
    fn name(&self) -> String {
        "fast-surface-nets 0.2.1; normals included".into()
    }

    fn extract(&mut self, grid: &Grid, with_mesh: bool) -> Result<Outcome> {
        // Inside is negative there.
        self.negated.clear();
        self.negated.extend(grid.samples.iter().map(|sample| -sample));
        let n = grid.cells + 1;
        let shape = RuntimeShape::<u32, 3>::new([n; 3]);
        let begin = Instant::now();
        surface_nets(&self.negated, &shape, [0; 3], [n - 1; 3], &mut self.buffer);
        let extraction_s = begin.elapsed().as_secs_f64();
        let mesh = with_mesh.then(|| TriangleMesh {
            positions: self
                .buffer
                .positions
                .iter()
                .map(|p| Vec3::from_array(*p) * grid.spacing - REACH)
                .collect(),
            normals: Vec::new(),
            triangles: self.buffer.indices.as_chunks::<3>().0.to_vec(),
        });
        Ok(Outcome { extraction_s, sampling_s: 0.0, mesh })
    }
}

struct Cubes;

/// Looks samples up; what lies beyond the grid repeats its last layer.
struct Samples<'a>(&'a Grid);

impl Source for Samples<'_> {
    fn sample(&self, x: f32, y: f32, z: f32) -> f32 {
        let cells = self.0.cells as usize;
        let at = |v: f32| ((v * cells as f32).round() as usize).min(cells);
        -self.0.samples[(at(z) * (cells + 1) + at(y)) * (cells + 1) + at(x)]
    }
}

impl Peer for Cubes {
    fn name(&self) -> String {
        "isosurface 0.0.4 MarchingCubes; looking samples up included".into()
    }

    fn extract(&mut self, grid: &Grid, with_mesh: bool) -> Result<Outcome> {
        let begin = Instant::now();
        let (mut vertices, mut indices) = (Vec::new(), Vec::new());
        MarchingCubes::new(grid.cells as usize + 1).extract(&Samples(grid), &mut vertices, &mut indices);
        let extraction_s = begin.elapsed().as_secs_f64();
        let place = |p: &[f32; 3]| Vec3::from_array(*p) * (2.0 * REACH) - REACH;
        let mesh = with_mesh.then(|| TriangleMesh {
            positions: vertices.as_chunks::<3>().0.iter().map(place).collect(),
            normals: Vec::new(),
            triangles: indices.as_chunks::<3>().0.to_vec(),
        });
        Ok(Outcome { extraction_s, sampling_s: 0.0, mesh })
    }
}
