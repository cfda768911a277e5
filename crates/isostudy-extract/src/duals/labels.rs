//! Surface nets of labels: the boundaries between every two of them.
//!
//! A cell with more than one label at its corners has one vertex, at the mean of the middles of its edges whose ends differ. Each such
//! edge that four cells share has a quadrilateral round it (Gibson 1998; of many labels, Frisken 2022). So what is a net between two
//! labels is the same net as that of samples 0 and 1, and where boundaries meet they share their vertices.
//!
//! Two layers of labels and the vertex numbers of two layers of cells are held at a time.

use std::collections::{BTreeMap, TryReserveError};

use glam::Vec3;
use isostudy_mesh::{LabelledMesh, TriangleMesh};

use super::quads::{CORNERS, Quadrilateral};
use super::relaxed::{MOST_SMOOTHING, relax_positions};
use crate::builders::builders;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::lattice::CellBox;
use crate::memory::{filled, push};
use crate::surface::space::Space;
use crate::wording::in_words;

/// The label of what is outside of everything.
const BACKGROUND: u32 = 0;
/// More labels than any segmentation has: a volume of densities is none.
const MOST_LABELS: usize = 1 << 16;
/// Of a cell without a vertex.
const NONE: u32 = u32::MAX;

/// Labels on a regular grid that may be turned, mirrored, sheared and unequal in its steps. Label `(i, j, k)` lies at
/// `origin + i * steps[0] + j * steps[1] + k * steps[2]`, the first axis fastest. Label 0 is the background.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelVolume<'a> {
    /// Labels along each axis, two at least.
    pub counts: [usize; 3],
    /// All of them.
    pub labels: &'a [u32],
    /// Where the first one lies.
    pub origin: [f64; 3],
    /// From one to the next along each axis.
    pub steps: [[f64; 3]; 3],
}

/// What decides the boundaries of labels. By default all labels, no smoothing, open where they leave the volume.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelSettings<'a> {
    /// The labels that count; all others are background. All count if there are none.
    pub only: &'a [u32],
    /// As [`SurfaceNets::smoothing`](crate::SurfaceNets::smoothing): a vertex of several boundaries is drawn to its neighbours on all.
    pub smoothing: u32,
    /// Whether there is background beyond the volume, so that boundaries are closed half a step beyond its last labels.
    pub close: bool,
}

builders! {
    LabelSettings<'a> {
        with_only: only: &'a [u32],
        with_smoothing: smoothing: u32,
        with_close: close: bool,
    }
}

impl<'a> LabelSettings<'a> {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { only: &[], smoothing: 0, close: false }
    }
}

impl<'a> Default for LabelSettings<'a> {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

/// How many samples have a label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelCount {
    /// The label.
    pub label: u32,
    /// Its samples.
    pub samples: u64,
}

/// The boundaries between labels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LabelSurface {
    /// Inside is the larger label of each pair: so 0 is outside always, and triangles face the smaller label.
    pub labelled: LabelledMesh,
    /// The labels by which there are boundaries, the background among them, in ascending order.
    pub counts: Vec<LabelCount>,
    /// Edges between samples that have different labels.
    pub crossings: u64,
}

/// Why labels have no boundaries.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LabelError {
    /// An axis with fewer than two labels.
    Flat {
        /// As given.
        counts: [usize; 3],
    },
    /// Not as many labels as the counts say.
    Count {
        /// How many there are.
        given: usize,
        /// As given.
        counts: [usize; 3],
    },
    /// The steps span no space, or are not finite.
    Steps {
        /// As given.
        steps: [[f64; 3]; 3],
        /// As given.
        origin: [f64; 3],
    },
    /// Nothing to have a boundary with.
    Alone {
        /// The one label.
        label: u32,
    },
    /// A volume of something else.
    TooMany,
    /// A label was chosen that no sample has.
    Absent {
        /// As chosen.
        label: u32,
        /// Those that there are.
        known: Vec<u32>,
    },
    /// The background was chosen.
    Background,
    /// Cells beyond those of the volume, which begin at the first label, or with background beyond the volume one before it.
    Beyond {
        /// As given.
        cells: CellBox,
        /// Those that there are.
        all: CellBox,
    },
    /// More steps than there may be.
    Smoothing {
        /// As given.
        smoothing: u32,
    },
    /// The extraction fails.
    Extract(ExtractError),
}

in_words! {
    LabelError {
        Self::Flat { counts } => "{counts:?} samples along the axes; there must be two or more along each";
        Self::Count { given, counts } => "{given} labels for {counts:?} samples along the axes";
        Self::Steps { steps, origin } =>
            "the steps {steps:?} from sample to sample, from {origin:?}, span no space";
        Self::Alone { label } => "every sample has the label {label}: there is no boundary";
        Self::TooMany => "more than {MOST_LABELS} different labels: are these densities?";
        Self::Absent { label, known } => "no sample has the label {label}; labels are {}", few(known);
        Self::Background => "label {BACKGROUND} is the background, which is there always; choose others";
        Self::Beyond { cells, all } =>
            "cells {:?} to {:?} are not all of the volume's, {:?} to {:?}", cells.start, cells.end, all.start, all.end;
        Self::Smoothing { smoothing } => "smoothing = {smoothing}: must be from 0 to {MOST_SMOOTHING}, steps";
        Self::Extract(error) => "{error}";
    }
    from { ExtractError => Self::Extract }
}

/// The first of a list, for messages.
fn few(labels: &[u32]) -> String {
    const SHOWN: usize = 12;
    let mut shown: Vec<String> = labels.iter().take(SHOWN).map(u32::to_string).collect();
    if labels.len() > SHOWN {
        shown.push(format!("{} more", labels.len() - SHOWN));
    }
    shown.join(", ")
}

impl LabelVolume<'_> {
    /// Extracts the boundaries between labels. The same labels and settings give the same mesh to the byte, whatever `control` says; only
    /// steps of smoothing are taken on several threads.
    ///
    /// The boundary of each label, [`LabelledMesh::boundary_of`], is closed where it stays clear of the volume's faces, and everywhere if
    /// the settings say so. Where two of its sheets cross one cell they share a vertex, and an edge if they cross a face by turns.
    ///
    /// Vertices are placed in steps of the grid, then taken to space in double precision.
    ///
    /// # Errors
    /// [`LabelError`].
    pub fn extract<'c>(
        &self,
        settings: &LabelSettings,
        control: impl Into<Control<'c>>,
    ) -> Result<LabelSurface, LabelError> {
        let space = self.check(settings)?;
        let counted = counted(self.labels, settings)?;
        let net = Net::of(self, settings);
        let crossings = net.crossings(&control.into(), settings.smoothing, &space)?;
        Ok(LabelSurface { labelled: crossings.labelled, counts: counted, crossings: crossings.count })
    }

    /// The cells there are: between the labels, and with background beyond the volume half a step round them.
    fn all_cells(&self, settings: &LabelSettings) -> CellBox {
        let border = i32::from(settings.close);
        CellBox { start: [-border; 3], end: self.counts.map(|n| n as i32 - 1 + border) }
    }

    /// The net round the edges that begin at the lowest corners of some cells, on the calling thread. There may be vertices without a
    /// quadrilateral.
    ///
    /// # Errors
    /// [`LabelError`].
    pub(crate) fn net_of(&self, settings: &LabelSettings, cells: CellBox) -> Result<Placed, LabelError> {
        let space = self.check(settings)?;
        let all = self.all_cells(settings);
        if !all.contains_box(&cells) || cells.is_empty() {
            return Err(LabelError::Beyond { cells, all });
        }
        let mut net = Net { keeps_cells: true, keeps_edges: true, ..Net::of(self, settings) };
        // Numbers of points, those beyond the volume included. Below lie the cells that the lowest quadrilaterals lead to.
        let around = settings.smoothing as usize;
        let point = |cell: [i32; 3]| cell.map(|i| (i - all.start[0]) as usize);
        let (first, last) = (point(cells.start), point(cells.end));
        for axis in 0..3 {
            net.first[axis] = first[axis].saturating_sub(1 + around);
            net.window[axis] = (last[axis] + 1 + around).min(net.size[axis]) - net.first[axis];
        }
        let [nx, ny, _] = net.size;
        let mut placed = net.crossings(&Control::default(), settings.smoothing, &space)?;
        let is_own = |edge: u64| {
            let point = (edge / 3) as usize;
            let place = [point % nx, point / nx % ny, point / nx / ny];
            (0..3).all(|axis| (first[axis]..last[axis]).contains(&place[axis]))
        };
        placed.retain(is_own);
        Ok(placed)
    }

    /// What is wrong with the volume or the settings, whatever the labels are.
    fn check(&self, settings: &LabelSettings) -> Result<Space, LabelError> {
        let Self { counts, labels, origin, steps } = *self;
        let smoothing = settings.smoothing;
        if smoothing > MOST_SMOOTHING {
            return Err(LabelError::Smoothing { smoothing });
        }
        if counts.iter().any(|&n| n < 2) {
            return Err(LabelError::Flat { counts });
        }
        if labels.len() != counts.iter().product::<usize>() {
            return Err(LabelError::Count { given: labels.len(), counts });
        }
        Space::try_new(origin, steps).ok_or(LabelError::Steps { steps, origin })
    }
}

/// The labels that count, and how many samples have each.
fn counted(labels: &[u32], settings: &LabelSettings) -> Result<Vec<LabelCount>, LabelError> {
    let mut found: BTreeMap<u32, u64> = BTreeMap::new();
    for run in labels.chunk_by(|a, b| a == b) {
        *found.entry(run[0]).or_default() += run.len() as u64;
        if found.len() > MOST_LABELS {
            return Err(LabelError::TooMany);
        }
    }
    for &label in settings.only {
        if label == BACKGROUND {
            return Err(LabelError::Background);
        }
        if !found.contains_key(&label) {
            return Err(LabelError::Absent { label, known: found.into_keys().collect() });
        }
    }
    let mut counts: BTreeMap<u32, u64> = BTreeMap::new();
    for (label, samples) in found {
        *counts.entry(chosen(label, settings.only)).or_default() += samples;
    }
    let alone = counts.first_key_value().filter(|_| counts.len() == 1).map(|(&label, _)| label);
    match alone {
        Some(label) if label == BACKGROUND || !settings.close => Err(LabelError::Alone { label }),
        _ => Ok(counts.into_iter().map(|(label, samples)| LabelCount { label, samples }).collect()),
    }
}

/// A label, or the background if it does not count.
fn chosen(label: u32, only: &[u32]) -> u32 {
    if only.is_empty() || only.contains(&label) { label } else { BACKGROUND }
}

/// The net as it grows, in steps of the grid.
struct Net<'a> {
    volume: &'a LabelVolume<'a>,
    only: &'a [u32],
    /// Layers of background on either side.
    border: usize,
    /// Samples along each axis, those beyond the volume included.
    size: [usize; 3],
    /// The first samples that are looked at, and how many along each axis.
    first: [usize; 3],
    window: [usize; 3],
    positions: Vec<Vec3>,
    /// The lowest corner of each vertex's cell; only where they are needed.
    cells: Vec<[i32; 3]>,
    keeps_cells: bool,
    triangles: Vec<[u32; 3]>,
    sides: Vec<[u32; 2]>,
    /// The number of each quadrilateral's edge; only where they are needed.
    edges: Vec<u64>,
    keeps_edges: bool,
    crossings: u64,
}

/// A net in space.
pub(crate) struct Placed {
    pub(crate) labelled: LabelledMesh,
    /// The cell of each vertex, where that was kept.
    pub(crate) cells: Vec<[i32; 3]>,
    /// The number of the edge of each quadrilateral, where that was kept: it grows as quadrilaterals follow each other.
    pub(crate) edges: Vec<u64>,
    count: u64,
}

impl Placed {
    /// Leaves the quadrilaterals of some edges.
    fn retain(&mut self, is_kept: impl Fn(u64) -> bool) {
        let LabelledMesh { mesh, sides } = &mut self.labelled;
        let mut kept = 0;
        for i in (0..self.edges.len()).filter(|&i| is_kept(self.edges[i])).collect::<Vec<_>>() {
            self.edges[kept] = self.edges[i];
            for half in 0..2 {
                mesh.triangles[2 * kept + half] = mesh.triangles[2 * i + half];
                sides[2 * kept + half] = sides[2 * i + half];
            }
            kept += 1;
        }
        self.edges.truncate(kept);
        mesh.triangles.truncate(2 * kept);
        sides.truncate(2 * kept);
    }
}

/// What is in sight of a layer of points: its labels and the next layer's, and the vertices of the cells below and above it.
struct Sight {
    here: Vec<u32>,
    next: Vec<u32>,
    below: Vec<u32>,
    above: Vec<u32>,
}

/// The corner that each of a cube's edges begins at, and its axis.
const EDGES: [(usize, usize); 12] = {
    let mut edges = [(0, 0); 12];
    let (mut count, mut corner) = (0, 0);
    while corner < 8 {
        let mut axis = 0;
        while axis < 3 {
            if corner >> axis & 1 == 0 {
                edges[count] = (corner, axis);
                count += 1;
            }
            axis += 1;
        }
        corner += 1;
    }
    edges
};

impl<'a> Net<'a> {
    /// Of the whole volume.
    fn of(volume: &'a LabelVolume, settings: &LabelSettings<'a>) -> Self {
        let border = usize::from(settings.close);
        let size = volume.counts.map(|n| n + 2 * border);
        Self {
            volume,
            only: settings.only,
            border,
            size,
            first: [0; 3],
            window: size,
            positions: Vec::new(),
            cells: Vec::new(),
            keeps_cells: settings.smoothing > 0,
            triangles: Vec::new(),
            sides: Vec::new(),
            edges: Vec::new(),
            keeps_edges: false,
            crossings: 0,
        }
    }

    /// Makes the net, smooths it and takes it to space.
    fn crossings(mut self, control: &Control, smoothing: u32, space: &Space) -> Result<Placed, ExtractError> {
        self.fill(control)?;
        let Self { positions, cells, triangles, sides, edges, crossings, .. } = self;
        let mut mesh = TriangleMesh { positions, triangles, normals: Vec::new() };
        if smoothing > 0 {
            let cell = |v: usize| {
                let low = Vec3::from_array(cells[v].map(|i| i as f32));
                [low, low + 1.0]
            };
            relax_positions(control, smoothing, &mut mesh, cell)?;
        }
        space.place(&mut mesh);
        Ok(Placed { labelled: LabelledMesh { mesh, sides }, cells, edges, count: crossings })
    }

    fn fill(&mut self, control: &Control) -> Result<(), ExtractError> {
        let [nx, ny, nz] = self.window;
        let layer = || filled(nx * ny, NONE);
        let mut sight = Sight { here: layer()?, next: layer()?, below: layer()?, above: layer()? };
        self.read(0, &mut sight.next);
        for z in 0..nz {
            control.check()?;
            std::mem::swap(&mut sight.here, &mut sight.next);
            std::mem::swap(&mut sight.below, &mut sight.above);
            if z + 1 < nz {
                self.read(z + 1, &mut sight.next);
                self.vertices(z, &mut sight)?;
            }
            self.quadrilaterals(z, &sight)?;
            if let Some(progress) = control.progress {
                progress(z + 1, nz);
            }
        }
        Ok(())
    }

    /// The labels of a layer of points.
    fn read(&self, z: usize, layer: &mut [u32]) {
        let [nx, ..] = self.window;
        let [cx, cy, cz] = self.volume.counts;
        layer.fill(BACKGROUND);
        let within = |at: usize, count: usize| at.checked_sub(self.border).filter(|&at| at < count);
        let Some(z) = within(self.first[2] + z, cz) else { return };
        let (from, to) = (self.first[0].max(self.border), (self.first[0] + nx).min(cx + self.border));
        for (y, row) in layer.chunks_exact_mut(nx).enumerate() {
            let Some(y) = within(self.first[1] + y, cy).filter(|_| from < to) else { continue };
            let labels = &self.volume.labels[(z * cy + y) * cx..][from - self.border..to - self.border];
            for (to, &label) in row[from - self.first[0]..].iter_mut().zip(labels) {
                *to = chosen(label, self.only);
            }
        }
    }

    /// Gives each cell of a layer a vertex that has more than one label and a quadrilateral.
    fn vertices(&mut self, z: usize, sight: &mut Sight) -> Result<(), ExtractError> {
        let [nx, ny, _] = self.window;
        for y in 0..ny - 1 {
            let rows = [
                &sight.here[y * nx..],
                &sight.here[(y + 1) * nx..],
                &sight.next[y * nx..],
                &sight.next[(y + 1) * nx..],
            ];
            for x in 0..nx - 1 {
                let corners: [u32; 8] = std::array::from_fn(|c| rows[c >> 1][x + (c & 1)]);
                let cell = [0, 1, 2].map(|axis| self.first[axis] + [x, y, z][axis]);
                sight.above[y * nx + x] = match self.mean(cell, &corners) {
                    None => NONE,
                    Some(place) => {
                        let number = self.positions.len() as u32;
                        if number == NONE {
                            return Err(ExtractError::TooManyVertices { limit: NONE });
                        }
                        let low = cell.map(|i| i as i32 - self.border as i32);
                        push(&mut self.positions, Vec3::from_array(low.map(|i| i as f32)) + place)?;
                        if self.keeps_cells {
                            push(&mut self.cells, low)?;
                        }
                        number
                    }
                };
            }
        }
        Ok(())
    }

    /// Where in its cell the vertex lies, if there is one.
    fn mean(&self, cell: [usize; 3], corners: &[u32; 8]) -> Option<Vec3> {
        if corners.iter().all(|label| *label == corners[0]) {
            return None;
        }
        // In halves of a step.
        let (mut sum, mut count, mut is_used) = ([0; 3], 0, false);
        for (corner, axis) in EDGES {
            if corners[corner] == corners[corner | 1 << axis] {
                continue;
            }
            count += 1;
            for (a, sum) in sum.iter_mut().enumerate() {
                *sum += if a == axis { 1 } else { 2 * (corner >> a & 1) };
            }
            let place = [0, 1, 2].map(|a| cell[a] + (corner >> a & 1));
            is_used |= self.is_shared(place, axis);
        }
        is_used.then(|| Vec3::from_array(sum.map(|s| s as f32 * 0.5)) / count as f32)
    }

    /// Whether four cells share the edge that begins at a point.
    fn is_shared(&self, place: [usize; 3], axis: usize) -> bool {
        (0..3).all(|a| a == axis || (0 < place[a] && place[a] + 1 < self.size[a]))
    }

    /// Whether the four cells round the edge that begins at a point are all looked at.
    fn is_in_sight(&self, place: [usize; 3], axis: usize) -> bool {
        let is_within = |a: usize| self.first[a] < place[a] && place[a] + 1 < self.first[a] + self.window[a];
        (0..3).all(|a| a == axis || is_within(a))
    }

    /// The quadrilaterals round the edges that begin in a layer of points.
    fn quadrilaterals(&mut self, z: usize, sight: &Sight) -> Result<(), TryReserveError> {
        let [nx, ny, _] = self.window;
        for y in 0..ny {
            for x in 0..nx {
                let (at, from) = (y * nx + x, [x, y, z]);
                let here = sight.here[at];
                for axis in 0..3 {
                    if from[axis] + 1 == self.window[axis] {
                        continue;
                    }
                    let there = if axis == 2 { sight.next[at] } else { sight.here[at + [1, nx][axis]] };
                    if here == there {
                        continue;
                    }
                    self.crossings += 1;
                    let place = [0, 1, 2].map(|axis| self.first[axis] + from[axis]);
                    if self.is_in_sight(place, axis) {
                        self.quadrilateral(from, axis, here > there, sight)?;
                        let sides = [here.max(there), here.min(there)];
                        self.sides.try_reserve(2)?;
                        self.sides.extend([sides; 2]);
                        if self.keeps_edges {
                            let [px, py, pz] = place.map(|i| i as u64);
                            let [sx, sy, _] = self.size.map(|n| n as u64);
                            push(&mut self.edges, 3 * ((pz * sy + py) * sx + px) + axis as u64)?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// That round the edge which begins at a point of the window.
    fn quadrilateral(
        &mut self,
        place: [usize; 3],
        axis: usize,
        leads_out: bool,
        sight: &Sight,
    ) -> Result<(), TryReserveError> {
        let [nx, ..] = self.window;
        let corners = std::array::from_fn(|cell| {
            // As many steps back as the corner of the cell that the edge begins at is forward.
            let corner = usize::from(CORNERS[axis][cell]);
            let [x, y, z] = [0, 1, 2].map(|a| corner >> a & 1);
            let layer = if z == 1 { &sight.below } else { &sight.above };
            layer[(place[1] - y) * nx + place[0] - x]
        });
        self.triangles.try_reserve(2)?;
        self.triangles.extend(Quadrilateral { corners, leads_out }.by_shorter_diagonal(&self.positions));
        Ok(())
    }
}
