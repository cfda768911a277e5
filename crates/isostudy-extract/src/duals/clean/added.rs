//! Vertices that are added in faces and on edges, and the triangles that need them.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::face::{Edge, Face, corner_between, divides, is_on_face};
use super::net::{Judged, Net};
use crate::duals::plan::{Table, VertexPer};
use crate::duals::region::margin;
use crate::duals::sharp::Sharp;
use crate::duals::tangents::tangent;
use crate::extraction::ExtractError;
use crate::lattice::Part;
use crate::memory::push;
use crate::surface::trace::VertexKey;

/// Numbers of keys: vertices on the edges that begin at a point, by axis, and in the faces that begin there, by the axis across.
const ON_EDGE: usize = 4;
const IN_FACE: usize = ON_EDGE + 3;
/// Of the planes in a face, as for dual contouring.
const TRUNCATION: f32 = 1e-3;

/// The vertices that were added, in edges and faces.
pub(super) struct Added<'a> {
    net: &'a Net<'a>,
    known: &'a mut HashMap<VertexKey, u32>,
    all: &'a mut Vec<(VertexKey, Vec3)>,
}

impl<'a> Added<'a> {
    /// None yet.
    pub(super) fn new(
        net: &'a Net<'a>,
        known: &'a mut HashMap<VertexKey, u32>,
        all: &'a mut Vec<(VertexKey, Vec3)>,
    ) -> Self {
        known.clear();
        all.clear();
        Self { net, known, all }
    }

    /// Writes the triangles of a quadrilateral that needs vertices.
    pub(super) fn polygon(
        &mut self,
        judged: &Judged,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), ExtractError> {
        let (net, quad) = (self.net, judged.quad);
        let mut polygon = [0; 8];
        let (mut count, mut in_faces) = (0, 0u8);
        let standing = quad.corners.map(|v| net.standing(v));
        for side in (0..4).filter(|&i| standing[i] != standing[(i + 1) % 4]) {
            polygon[count] = standing[side];
            count += 1;
            if judged.sides >> side & 1 != 0 {
                polygon[count] = self.in_face(net.face_of_vertex(quad, side))?;
                in_faces |= 1 << count;
                count += 1;
            }
        }
        let polygon = &mut polygon[..count];
        if !quad.leads_out {
            // Counter-clockwise seen from outside, as triangles are.
            polygon.reverse();
            in_faces = in_faces.reverse_bits() >> (8 - count);
        }
        let edge = net.edge(quad);
        let ends = edge.ends(quad.leads_out).map(|end| net.grid.position(end));
        let fan = |apex: usize| {
            let at = move |i: usize| (apex + i) % count;
            (1..count - 1).map(move |i| [at(0), at(i), at(i + 1)])
        };
        let is_within =
            |apex: &usize| fan(*apex).all(|of| divides(of.map(|i| self.position(polygon[i])), ends));
        let apex = (0..count).filter(|&i| in_faces >> i & 1 != 0).find(is_within);
        if let Some(apex) = apex {
            return Ok(fan(apex).try_for_each(|of| push(triangles, of.map(|i| polygon[i])))?);
        }
        let centre = self.on_edge(edge)?;
        for i in 0..count {
            push(triangles, [centre, polygon[i], polygon[(i + 1) % count]])?;
        }
        Ok(())
    }

    /// Fills the gaps between the runs of cut loops of cells in a part, and says whether there are any.
    pub(super) fn fill(
        &mut self,
        part: Part,
        triangles: &mut Vec<[u32; 3]>,
        of_cells: &mut Vec<u32>,
    ) -> Result<bool, ExtractError> {
        let net = self.net;
        let table = Table::get(VertexPer::Loop);
        let before = triangles.len();
        for v in 0..net.keys.len() as u32 {
            let (of, cell) = (net.loop_of(v), net.leaf(v));
            if of.open == 0 || !of.is_cut() || !part.contains(cell) {
                continue;
            }
            for (i, &edge) in of.edges.iter().enumerate() {
                if of.open >> edge & 1 == 0 {
                    continue;
                }
                let count = of.edges.len();
                let place = |edge: u8| {
                    let (corner, axis) = table.edge(edge);
                    let from = [0, 1, 2].map(|axis| cell[axis] + usize::from(corner >> axis & 1));
                    Edge { from, axis: usize::from(axis) }
                };
                let on_edge = self.on_edge(place(edge))?;
                for (beside, is_next) in [((i + count - 1) % count, false), ((i + 1) % count, true)] {
                    let other = of.edges[beside];
                    let is_common = |face: &(usize, bool)| {
                        [edge, other].into_iter().all(|edge| is_on_face(table, edge, face.0, face.1))
                    };
                    let faces = (0..3).flat_map(|across| [(across, false), (across, true)]);
                    let Some((across, is_high)) = faces.into_iter().find(is_common) else { continue };
                    let mut lowest = cell;
                    lowest[across] += usize::from(is_high);
                    let half = corner_between(table, [edge, other], across);
                    let in_face = self.in_face(Face { lowest, size: 1, across, half })?;
                    push(triangles, if is_next { [v, on_edge, in_face] } else { [v, in_face, on_edge] })?;
                    push(of_cells, part.number(cell))?;
                }
            }
        }
        Ok(triangles.len() != before)
    }

    fn position(&self, v: u32) -> Vec3 {
        let old = self.net.positions.len();
        match (v as usize).checked_sub(old) {
            Some(added) => self.all[added].1,
            None => self.net.positions[v as usize],
        }
    }

    fn add(
        &mut self,
        place: [usize; 3],
        number: usize,
        position: impl FnOnce() -> Vec3,
    ) -> Result<u32, ExtractError> {
        let lattice = self.net.grid.lattice;
        let key = VertexKey::new(lattice.arrangement(), lattice.stored(place), number);
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let number = (self.net.positions.len() + self.all.len()) as u32;
        self.known.try_reserve(1)?;
        self.known.insert(key, number);
        push(self.all, (key, position()))?;
        Ok(number)
    }

    /// The vertex on an edge: its crossing.
    fn on_edge(&mut self, edge: Edge) -> Result<u32, ExtractError> {
        let net = self.net;
        self.add(edge.from, ON_EDGE + edge.axis, || {
            let Edge { from, axis } = edge;
            let [low, high] = edge.ends(true).map(|end| net.grid.position(end).as_dvec3());
            let ends = edge.ends(true).map(|end| net.level.field.sample(net.grid.position(end)));
            let (crossing, _) = tangent(net.level, net.grid, from, axis, ends);
            let share = (crossing[axis] - low[axis]) / (high[axis] - low[axis]);
            let margin = margin(low, high, 1);
            (low + (high - low) * share.clamp(margin, 1.0 - margin)).as_vec3()
        })
    }

    /// The vertex in a face, or the loops' part of one: where the tangent planes at its two crossings meet in it.
    fn in_face(&mut self, face: Face) -> Result<u32, ExtractError> {
        let net = self.net;
        // The halves of a face that two loops cross are round opposite corners.
        let part = usize::from(face.half.is_some_and(|[a, _]| a));
        self.add(face.lowest, IN_FACE + 2 * face.across + part, || net.meeting_in_face(face))
    }
}

impl Net<'_> {
    fn meeting_in_face(&self, face: Face) -> Vec3 {
        let axes = face.axes();
        let [low, high] = [[false; 2], [true; 2]].map(|of| self.grid.position(face.corner(of)).as_dvec3());
        let mut crossings = [(DVec3::ZERO, None); 4];
        let mut count = 0;
        let value = |at: [usize; 3]| self.level.field.sample(self.grid.position(at));
        let is_inside = |at: [usize; 3]| value(at) > self.level.isovalue;
        for Edge { from, axis } in face.edges() {
            let at = |i: usize| {
                let mut at = from;
                at[axis] += i;
                at
            };
            let (mut low, mut high) = (0, face.size);
            let is_low_inside = is_inside(at(low));
            if is_low_inside == is_inside(at(high)) {
                continue;
            }
            // A side of a merged cell has one crossing.
            while high - low > 1 {
                let middle = low.midpoint(high);
                *(if is_inside(at(middle)) == is_low_inside { &mut low } else { &mut high }) = middle;
            }
            let (crossing, normal) =
                tangent(self.level, self.grid, at(low), axis, [low, high].map(|i| value(at(i))));
            // Within the face.
            let flat = normal.map(|mut normal| {
                normal[face.across] = 0.0;
                normal
            });
            crossings[count] = (crossing, flat);
            count += 1;
        }
        let crossings = &crossings[..count];
        let margin = margin(low, high, face.size);
        let share = |at: DVec3| [0, 1].map(|i| (at[axes[i]] - low[axes[i]]) / (high[axes[i]] - low[axes[i]]));
        let middle = face.half.map_or([0.5; 2], |of| of.map(|is_high| if is_high { 0.75 } else { 0.25 }));
        let [mut at, mut anchor] = [middle; 2];
        if !crossings.is_empty() {
            let point = Sharp { truncation: TRUNCATION, in_cell: true }.vertex(crossings, low, high);
            at = share(point).map(|share| share.clamp(margin, 1.0 - margin));
            anchor = [0, 1].map(|i| {
                let of = crossings.iter().map(|(crossing, _)| share(*crossing)[i].clamp(0.0, 1.0));
                of.sum::<f64>() / crossings.len() as f64
            });
        }
        if let Some(half) = face.half {
            // As far as the diagonal, from the middle of the crossings if that is in the half by enough.
            let way = |of: [f64; 2]| (0..2).map(|i| if half[i] { 1.0 - of[i] } else { of[i] }).sum::<f64>();
            if way(anchor) > 1.0 - 2.0 * margin {
                anchor = middle;
            }
            let (here, there) = (1.0 - margin - way(anchor), 1.0 - margin - way(at));
            if there < 0.0 {
                let of = (here / (here - there)).max(0.0);
                at = [0, 1].map(|i| anchor[i] + (at[i] - anchor[i]) * of);
            }
        }
        let mut found = low;
        for i in 0..2 {
            found[axes[i]] = low[axes[i]] + (high[axes[i]] - low[axes[i]]) * at[i];
        }
        found.as_vec3()
    }
}
