//! Memory and tables made before the first chunk, so that it takes as long as any.

use super::{ChunkExtractor, Control, Place};
use crate::chunks::chunk::Chunk;
use crate::chunks::error::ChunkError;
use crate::source::NormalsOf;
#[cfg(feature = "tetrahedra")]
use crate::{
    clustering::guard::Guard,
    settings::{Clustering, Topology},
};
use glam::Vec3;
use isostudy_field::{StudyField, from_fn};

impl ChunkExtractor {
    /// Makes room for windows with so many vertices and twice as many triangles, so that not even a surface larger than all
    /// before allocates; and makes the tables that are made otherwise when a point first needs them. A window is larger than its chunk: 36³ cells for 32³, body-centred.
    ///
    /// # Errors
    /// [`ChunkError::Extract`] if there is no memory.
    pub fn reserve(&mut self, vertices: usize) -> Result<(), ChunkError> {
        let (mesh, trace) = (&mut self.extraction.mesh, &mut self.extractor.trace);
        mesh.positions.try_reserve(vertices)?;
        mesh.normals.try_reserve(vertices)?;
        mesh.triangles.try_reserve(2 * vertices)?;
        if self.extractor.traced {
            trace.keys.try_reserve(vertices)?;
            trace.cells.try_reserve(2 * vertices)?;
            self.numbers.try_reserve(vertices)?;
        }
        self.complete_tables();
        Ok(())
    }

    /// Makes the tables of the method, and buffers for chunks of so many cells a side, by extracting a ball in one. The first chunk then takes
    /// as long as any. Nothing that it makes can be seen.
    ///
    /// # Errors
    /// [`ChunkError::Cells`] if there is no such chunk, [`ChunkError::Extract`] if there is no memory.
    pub fn warm_up(&mut self, cells: u32) -> Result<(), ChunkError> {
        self.complete_tables();
        let first = match &self.world.place {
            Place::Endless(grid) => grid.chunk([0; 3], cells),
            Place::Box(_) => self.grid(cells).next().unwrap_or_default(),
        };
        self.check(first)?;
        let bounds = self.lattice(first)?.sampled_bounds();
        let ball = Ball {
            centre: (bounds.min + bounds.max) * 0.5,
            radius: 0.4 * bounds.size().min_element(),
            isovalue: self.how.settings.isovalue,
        };
        if self.extractor.normals != NormalsOf::Samples {
            return self.of_field(&ball, first, Control::default(), &mut Chunk::default());
        }
        let window = self.window(first)?.unwrap_or(first);
        let layout = self.layout(window)?;
        let mut samples = Vec::new();
        layout.fill(&from_fn(|p: [f32; 3]| ball.sample(Vec3::from(p))), &mut samples);
        self.of_samples((window, &samples), first, Control::default(), &mut Chunk::default())
    }

    /// Makes the tables of integrated clustering that are made otherwise when a point first needs them.
    fn complete_tables(&self) {
        #[cfg(feature = "tetrahedra")]
        {
            let super::ByWindow { arrangement, settings, way, .. } = &self.how;
            let merges =
                settings.clustering == Clustering::Integrated && settings.topology == Topology::Guarded;
            if way.is_none() && merges {
                Guard::get(*arrangement).complete();
            }
        }
    }
}

/// A ball that is there to be extracted once.
struct Ball {
    centre: Vec3,
    radius: f32,
    isovalue: f32,
}

impl StudyField for Ball {
    fn sample(&self, p: Vec3) -> f32 {
        self.isovalue + self.radius - (p - self.centre).length()
    }
}
