//! Many small grids of random samples in one volume, each held against the exact topology of its trilinear interpolant.
//!
//! Grids lie side by side with a layer of samples between them that is outside, so that no surface leads from one to another. A program
//! that needs a millisecond for a request is held against a hundred thousand grids in seconds.

use std::collections::BTreeMap;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::DVec3;
use isostudy_trilinear::{Fault, Samples, topology, verify};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::engine::Ties;
use crate::judge::welded;

/// Random samples along each side of a grid.
pub const SIDE: usize = 4;
/// From a grid to the next: a layer of samples belongs to both.
const PERIOD: usize = SIDE + 1;
/// The layer between grids.
const BETWEEN: f32 = -1.0;

/// Grids in a cube of so many along each side.
#[derive(Debug, Clone, PartialEq)]
pub struct Packed {
    side: usize,
    values: Vec<f32>,
}

/// What became of the grids of one volume or of several.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Conformance {
    /// How many there were.
    pub grids: u64,
    /// Those with nothing wrong.
    pub right: u64,
    /// Those with the right number of pieces, of the right Euler characteristic.
    pub same_topology: u64,
    /// Those whose mesh is a closed, oriented manifold, of whatever topology.
    pub closed_manifold: u64,
    /// The first few that are wrong, by volume and number within it.
    pub wrong: Vec<[u64; 2]>,
}

/// How many wrong grids are named.
const NAMED: usize = 20;

impl Packed {
    /// Grids by chance, their samples even from -1 to 1; the same for the same seed.
    pub fn new(side: usize, seed: u64) -> Self {
        let samples = side * PERIOD + 1;
        let mut random = Pcg64::seed_from_u64(seed);
        let mut values = vec![BETWEEN; samples * samples * samples];
        for z in 0..samples {
            for y in 0..samples {
                for x in 0..samples {
                    if [x, y, z].iter().all(|i| i % PERIOD != 0) {
                        values[(z * samples + y) * samples + x] = random.random_range(-1.0f32..1.0);
                    }
                }
            }
        }
        Self { side, values }
    }

    /// Samples along each side of the volume.
    pub fn samples(&self) -> usize {
        self.side * PERIOD + 1
    }

    /// Those of the volume, x fastest, one unit apart from the origin on.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// How many grids there are.
    pub fn grids(&self) -> usize {
        self.side.pow(3)
    }

    /// The samples of a grid with the layers round it.
    ///
    /// # Panics
    /// If there is no such grid.
    pub fn grid(&self, number: usize) -> [f32; (PERIOD + 1).pow(3)] {
        let start = self.start(number);
        let samples = self.samples();
        std::array::from_fn(|i| {
            let [x, y, z] = [i % (PERIOD + 1), i / (PERIOD + 1) % (PERIOD + 1), i / (PERIOD + 1).pow(2)];
            self.values[((start[2] + z) * samples + start[1] + y) * samples + start[0] + x]
        })
    }

    fn start(&self, number: usize) -> [usize; 3] {
        let place = [number % self.side, number / self.side % self.side, number / self.side.pow(2)];
        place.map(|i| i * PERIOD)
    }

    /// Holds the mesh of the whole volume against each grid. `volume` is the volume's number among others. Triangles are of the grid that their
    /// middle is in.
    ///
    /// # Panics
    /// If a triangle's index is out of range.
    pub fn check(&self, mesh: &TriangleMesh, ties: Ties, soup: bool, volume: u64, found: &mut Conformance) {
        let mesh = if soup { welded(mesh, 1.0) } else { mesh.clone() };
        let mut parts: BTreeMap<usize, TriangleMesh> = BTreeMap::new();
        let mut numbers: BTreeMap<(usize, u32), u32> = BTreeMap::new();
        for &[a, b, c] in mesh.triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a) {
            let middle: DVec3 =
                [a, b, c].map(|v| mesh.positions[v as usize].as_dvec3()).into_iter().sum::<DVec3>() / 3.0;
            let place = middle.to_array().map(|x| (x.max(0.0) as usize / PERIOD).min(self.side - 1));
            let grid = (place[2] * self.side + place[1]) * self.side + place[0];
            let part = parts.entry(grid).or_default();
            let triangle = [a, b, c].map(|v| {
                *numbers.entry((grid, v)).or_insert_with(|| {
                    part.positions.push(mesh.positions[v as usize]);
                    part.positions.len() as u32 - 1
                })
            });
            part.triangles.push(triangle);
        }
        let nothing = TriangleMesh::default();
        let verdicts: Vec<Vec<Fault>> = (0..self.grids())
            .into_par_iter()
            .map(|grid| {
                let values = self.grid(grid);
                let samples =
                    Samples::try_new([PERIOD + 1; 3], &values).expect("finite samples, enough of them");
                let part = parts.get(&grid).unwrap_or(&nothing);
                let verdict = verify(part, &samples, 0.0, ties.into()).expect("the isovalue is finite");
                verdict.findings.iter().map(|finding| finding.fault).collect()
            })
            .collect();
        for (grid, faults) in verdicts.iter().enumerate() {
            let is_topology = |fault: &Fault| {
                matches!(
                    fault,
                    Fault::Components | Fault::EulerCharacteristic | Fault::Tunnels | Fault::UnlikeComponents
                )
            };
            found.grids += 1;
            found.right += u64::from(faults.is_empty());
            found.same_topology += u64::from(!faults.iter().any(is_topology));
            found.closed_manifold += u64::from(faults.iter().all(is_topology));
            if !faults.is_empty() && found.wrong.len() < NAMED {
                found.wrong.push([volume, grid as u64]);
            }
        }
    }

    /// How many grids have a cell with a tunnel, or a surface in several pieces: those that tell engines apart.
    pub fn with_tunnels(&self, ties: Ties) -> u64 {
        let has_tunnel = |grid: usize| {
            let values = self.grid(grid);
            let samples = Samples::try_new([PERIOD + 1; 3], &values).expect("finite samples, enough of them");
            topology(&samples, 0.0, ties.into()).expect("the isovalue is finite").tunnel_cells > 0
        };
        (0..self.grids()).into_par_iter().filter(|&grid| has_tunnel(grid)).count() as u64
    }
}
