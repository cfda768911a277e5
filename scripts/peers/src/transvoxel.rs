//! transvoxel: Lengyel's marching cubes, without transitions.

use crate::{Extract, Extraction};
use isostudy_mesh::TriangleMesh;
use std::time::Instant;
use transvoxel::prelude::{Block, BlockStarView, GenericMeshBuilder, extract};
use transvoxel::structs::voxel_index::VoxelIndex;
use transvoxel::traits::voxel_block::VoxelBlock;

/// Looks samples up. Its normals ask for one layer beyond, where the last one is repeated.
struct Samples<'a> {
    samples: &'a [f32],
    block: Block<f32>,
}

impl VoxelBlock<f32, f32> for Samples<'_> {
    fn block(&self) -> &Block<f32> {
        &self.block
    }

    fn get(&self, VoxelIndex { x, y, z }: VoxelIndex) -> f32 {
        let cells = self.block.subdivisions;
        let at = |i: isize| i.clamp(0, cells as isize) as usize;
        self.samples[(at(z) * (cells + 1) + at(y)) * (cells + 1) + at(x)]
    }
}

pub(crate) fn extractor() -> Extract {
    Box::new(|request, samples| {
        let cells = request.cells_of_a_cube()?;
        let block = Block::new([0.0; 3], cells as f32, cells as usize);
        let source = Samples { samples, block };
        let view: BlockStarView<_, _, _, &Samples> = BlockStarView::new_simple(&source);
        let begin = Instant::now();
        let found = extract(&view, request.isovalue as f32, GenericMeshBuilder::new()).build();
        let extraction_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let corners = found.triangle_indices.as_chunks::<3>().0;
        let mesh = TriangleMesh {
            positions: found.positions.as_chunks::<3>().0.iter().map(|&p| request.place(p)).collect(),
            normals: Vec::new(),
            triangles: corners.iter().map(|t| t.map(|v| v as u32)).collect(),
        };
        Ok(Extraction { extraction_s, callback_s: begin.elapsed().as_secs_f64(), mesh })
    })
}
