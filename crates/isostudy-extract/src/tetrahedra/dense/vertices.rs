//! Vertex stage: edge crossings, which end each is nearer to, and the vertices made of them.
//!
//! Each sample point with a crossing works alone: it looks at its fourteen neighbours, keeps the crossings that are
//! nearer to it than to the other end, partitions them into clusters and places one vertex a cluster. Vertices are
//! numbered in storage order of their points, then by direction.

use std::collections::TryReserveError;

use glam::Vec3;

use crate::clustering::clusters::Clusters;
use crate::clustering::guard::{Class, Guard};
use crate::extraction::ExtractError;
use crate::lattice::{
    ALL_DIRECTIONS, Arrangement, Border, Coordinates, DIRECTIONS, DirectionSet, Directions, Lattice, Layout,
    members,
};
use crate::memory::filled;
use crate::placement::spot::{Apart, Company, linear_ratio};
use crate::placement::{CrossingPlacer, Surroundings};
use crate::settings::{Clustering, ExtractSettings, Topology};
use crate::tetrahedra::dense::edges::EdgeTable;
use crate::tetrahedra::dense::sides::Sides;
use crate::tetrahedra::ties::Ties;

/// Places the vertices of a lattice, point by point.
pub(crate) struct VertexStage<'a> {
    lattice: &'a Lattice,
    directions: &'static Directions,
    arrangement: Arrangement,
    samples: &'a [f32],
    settings: &'a ExtractSettings,
    ties: Ties,
    apart: Apart,
    sides: &'a mut Sides,
    edges: &'a mut EdgeTable,
    positions: Vec<Vec3>,
    placer: Option<&'a CrossingPlacer<'a>>,
    targets: Vec<Vec3>,
    crossing_ends: u64,
}

impl<'a> VertexStage<'a> {
    pub(crate) fn new(
        lattice: &'a Lattice,
        samples: &'a [f32],
        settings: &'a ExtractSettings,
        placer: Option<&'a CrossingPlacer<'a>>,
        sides: &'a mut Sides,
        edges: &'a mut EdgeTable,
    ) -> Self {
        Self {
            lattice,
            directions: lattice.arrangement().directions(),
            arrangement: lattice.arrangement(),
            samples,
            settings,
            ties: Ties::of(settings.topology),
            apart: Apart::new(lattice, settings.topology).clamped(settings.edge_clamp),
            sides,
            edges,
            positions: Vec::new(),
            placer,
            targets: Vec::new(),
            crossing_ends: 0,
        }
    }

    /// Places all vertices. Returns their positions, those that the placer gives them, if there is one, and the number
    /// of lattice edges that cross the surface.
    ///
    /// # Errors
    /// [`ExtractError::TooManyVertices`], [`ExtractError::NoMemoryForMesh`].
    pub(crate) fn run(
        mut self,
        layout: &Layout,
        most_vertices: u32,
    ) -> Result<(Vec<Vec3>, Vec<Vec3>, u64), ExtractError> {
        self.sides.fill(self.samples, self.settings.isovalue);
        let coordinates =
            Coordinates::measured(self.lattice, layout, self.settings.positions, Border::of(self.settings))?;
        let mut active = filled(layout.grid()[0], 0)?;
        for (layer, &z) in coordinates.z().iter().enumerate() {
            let kind = layout.kind(layer);
            let [nx, ny] = layout.used(kind);
            let steps = layout.steps(kind);
            for row in 0..ny {
                let first = layout.index([0, row, layer]);
                self.sides.mark_active(first, steps, &mut active[..nx]);
                for column in (0..nx).filter(|&i| active[i] != 0) {
                    let incident = layout.incident(kind, [column, row, layer]);
                    let position = Vec3::new(coordinates.x(kind)[column], coordinates.y(kind)[row], z);
                    let place = [column, row, layer];
                    let offsets = &self.directions.offsets;
                    let ways = (!coordinates.is_regular(place))
                        .then(|| coordinates.ways(layout, place, incident, offsets));
                    self.visit(first + column, position, steps, incident, ways)?;
                    if self.positions.len() > most_vertices as usize {
                        return Err(ExtractError::TooManyVertices { limit: most_vertices });
                    }
                }
            }
        }
        // Each crossing was seen from both ends.
        Ok((self.positions, self.targets, self.crossing_ends / 2))
    }

    /// Finds the crossings round one point and places the vertices of the near ones.
    fn visit(
        &mut self,
        point: usize,
        position: Vec3,
        steps: &[isize; DIRECTIONS],
        incident: DirectionSet,
        ways: Option<[Vec3; DIRECTIONS]>,
    ) -> Result<(), TryReserveError> {
        let inside = self.sides.is_inside(point);
        let value = self.samples[point];
        let difference = self.settings.isovalue - value;
        let mut crossing = 0;
        let mut near = 0;
        let mut ratios = [0.0; DIRECTIONS];
        for direction in members(incident) {
            let neighbour = point.checked_add_signed(steps[direction]).expect("a point of the lattice");
            if self.sides.is_inside(neighbour) == inside {
                continue;
            }
            crossing |= 1 << direction;
            let neighbour_value = self.samples[neighbour];
            let there = self.settings.isovalue - neighbour_value;
            if !self.ties.is_near(inside, difference, there) {
                continue;
            }
            near |= 1 << direction;
            ratios[direction] = linear_ratio(difference, value, neighbour_value);
        }
        self.edges.set_crossing(point, crossing);
        self.crossing_ends += u64::from(crossing.count_ones());
        let clusters = self.clusters(crossing, near, incident);
        self.positions.try_reserve(clusters.sets().len())?;
        let company = Company::of(clusters.sets().len(), near.count_ones());
        for direction in members(near) {
            ratios[direction] = self.apart.ratio(company, direction, ratios[direction]);
        }
        for &cluster in clusters.sets() {
            self.place(point, position, cluster, &ratios, ways.as_ref());
        }
        if let Some(placer) = self.placer {
            let mut neighbours = [f32::NAN; DIRECTIONS];
            for direction in members(incident) {
                let neighbour = point.checked_add_signed(steps[direction]).expect("a point of the lattice");
                neighbours[direction] = self.samples[neighbour] - self.settings.isovalue;
            }
            let around = Surroundings { position, difference: -difference, neighbours, ways };
            self.targets.try_reserve(clusters.sets().len())?;
            self.targets.extend(clusters.sets().iter().map(|&cluster| placer.place(&around, cluster)));
        }
        Ok(())
    }

    fn clusters(&self, crossing: DirectionSet, near: DirectionSet, incident: DirectionSet) -> Clusters {
        match (self.settings.clustering, self.settings.topology) {
            (Clustering::None | Clustering::EdgeCollapse | Clustering::Warp, _) => Clusters::single(near),
            (Clustering::Integrated | Clustering::IntegratedCollapse, Topology::Published) => {
                Clusters::integrated(near, self.directions)
            }
            (Clustering::Integrated | Clustering::IntegratedCollapse, Topology::Guarded) => {
                // Here, so that the other rules do without its tables.
                let guard = Guard::get(self.arrangement);
                if incident == ALL_DIRECTIONS && guard.class(crossing, near) != Class::Ask {
                    Clusters::whole(near)
                } else {
                    Clusters::from_partition(&guard.partition(crossing, near, incident))
                }
            }
        }
    }

    /// One vertex at the unweighted mean of the cluster's crossings, clamped to the box. `ways` lead to the neighbours
    /// where not all are as far as the spacing says.
    fn place(
        &mut self,
        point: usize,
        position: Vec3,
        cluster: DirectionSet,
        ratios: &[f32; DIRECTIONS],
        ways: Option<&[Vec3; DIRECTIONS]>,
    ) {
        // What goes beyond a number is an error when the point is done.
        let vertex = self.positions.len() as u32;
        let mut sum = Vec3::ZERO;
        for direction in members(cluster) {
            let way = ways.map_or_else(|| self.edge_vector(direction), |ways| ways[direction]);
            sum += way * ratios[direction] + position;
            self.edges.set_vertex(point, direction, vertex);
        }
        let bounds = self.lattice.bounds();
        self.positions.push((sum / cluster.count_ones() as f32).min(bounds.max).max(bounds.min));
    }

    /// From a point to its neighbour.
    fn edge_vector(&self, direction: usize) -> Vec3 {
        let [x, y, z] = self.directions.offsets[direction].map(f32::from);
        Vec3::new(x, y, z) * (self.lattice.spacing() / 2.0)
    }
}
