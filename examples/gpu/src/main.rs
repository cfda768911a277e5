//! A chunk's buffers in the types of a GPU API (`wgpu-types`: those of wgpu, without the driver), and a field written with
//! mathematics that are not the extractor's own version.
//!
//! `cargo run --release --manifest-path examples/gpu/Cargo.toml --target-dir target/gpu`

use glam::Vec3;
use isostudy_extract::{
    Aabb, Arrangement, Bound, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, ScalarField,
    Tetrahedra,
};
use wgpu_types::{BufferUsages, IndexFormat, VertexAttribute, VertexFormat, VertexStepMode};

/// A ball, in `glam` 0.30: the extractor has another one inside, and nobody notices.
struct Ball {
    centre: Vec3,
    radius: f32,
}

impl ScalarField for Ball {
    fn sample(&self, p: [f32; 3]) -> f32 {
        self.radius - Vec3::from(p).distance(self.centre)
    }

    fn gradient(&self, p: [f32; 3]) -> Option<[f32; 3]> {
        (self.centre - Vec3::from(p)).try_normalize().map(Into::into)
    }

    fn bound(&self, _: Aabb) -> Bound {
        Bound::slope(1.0)
    }
}

/// Vertices in two buffers, one attribute each: positions as they are, normals in four bytes.
const ATTRIBUTES: [VertexAttribute; 2] = [
    VertexAttribute { format: VertexFormat::Float32x3, offset: 0, shader_location: 0 },
    VertexAttribute { format: VertexFormat::Snorm8x4, offset: 0, shader_location: 1 },
];

/// What `Queue::write_buffer` is given, with what the buffer is for.
struct Upload<'a> {
    usage: BufferUsages,
    bytes: &'a [u8],
}

/// Kept from chunk to chunk, so that nothing is allocated.
#[derive(Default)]
struct Scratch {
    positions: Vec<[f32; 3]>,
    normals: Vec<[i8; 4]>,
    indices: Vec<u16>,
}

impl Scratch {
    /// Positions less the chunk's origin, normals packed, indices in 16 bits where they suffice.
    fn fill<'a>(&'a mut self, chunk: &'a Chunk) -> ([Upload<'a>; 2], Upload<'a>, IndexFormat) {
        chunk.relative_positions(&mut self.positions);
        let pack = |normal: &[f32; 3]| {
            let [x, y, z] = normal.map(|c| (127.0 * c).round() as i8);
            [x, y, z, 0]
        };
        self.normals.clear();
        self.normals.extend(chunk.normals.iter().map(pack));
        let (format, indices) = match chunk.indices_u16(&mut self.indices) {
            Ok(()) => {
                // A buffer is written in fours of bytes.
                if self.indices.len() % 2 == 1 {
                    self.indices.push(0);
                }
                (IndexFormat::Uint16, bytemuck::cast_slice(&self.indices))
            }
            // Without a copy: triangles are numbers already.
            Err(_) => (IndexFormat::Uint32, bytemuck::cast_slice(&chunk.triangles)),
        };
        let upload = |usage, bytes| Upload { usage: usage | BufferUsages::COPY_DST, bytes };
        let vertices = [bytemuck::cast_slice(&self.positions), bytemuck::cast_slice(&self.normals)];
        (
            vertices.map(|bytes| upload(BufferUsages::VERTEX, bytes)),
            upload(BufferUsages::INDEX, indices),
            format,
        )
    }
}

fn ball_in_chunks(scratch: &mut Scratch, mut each: impl FnMut(&Chunk, &[Upload; 2], &Upload, IndexFormat)) {
    let grid = Grid::try_new([-1000.0, 0.0, 0.0], 0.5).expect("a grid");
    let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
    let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default())
        .expect("chunks go with the method");
    let ball = Ball { centre: Vec3::new(-1000.0, 0.0, 0.0), radius: 9.0 };
    let mut chunk = Chunk::default();
    for id in (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|n| n - 1)) {
        extractor
            .extract_into(&ball, grid.chunk(id, 32), Control::default(), &mut chunk)
            .expect("a chunk of the grid");
        let (vertices, indices, format) = scratch.fill(&chunk);
        each(&chunk, &vertices, &indices, format);
    }
}

fn main() {
    ball_in_chunks(&mut Scratch::default(), |chunk, vertices, indices, format| {
        let stride = |attribute: &VertexAttribute| attribute.format.size();
        println!(
            "chunk at {:?}: {} vertices, strides {:?} {:?}, {} bytes as {:?}; {} triangles, {format:?}, {} bytes as {:?}; box {:?}",
            chunk.origin(),
            chunk.positions.len(),
            ATTRIBUTES.each_ref().map(stride),
            VertexStepMode::Vertex,
            vertices.iter().map(|upload| upload.bytes.len()).sum::<usize>(),
            vertices[0].usage,
            chunk.triangles.len(),
            indices.bytes.len(),
            indices.usage,
            chunk.bounds()
        );
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu_types::BufferAddress;

    /// The buffers read back as a shader would, against the ball itself.
    #[test]
    fn buffers_hold_the_ball() {
        let mut seen = 0;
        ball_in_chunks(&mut Scratch::default(), |chunk, [positions, normals], indices, format| {
            let count = chunk.positions.len() as BufferAddress;
            let size = |upload: &Upload| upload.bytes.len() as BufferAddress;
            assert_eq!(size(positions), count * ATTRIBUTES[0].format.size());
            assert_eq!(size(normals), count * ATTRIBUTES[1].format.size());
            assert!(
                positions.usage.contains(BufferUsages::VERTEX) && indices.usage.contains(BufferUsages::INDEX)
            );
            assert_eq!(format, IndexFormat::Uint16);
            assert!(size(indices) % 4 == 0);
            let indices: &[u16] = bytemuck::cast_slice(indices.bytes);
            assert!(indices.iter().all(|&i| u64::from(i) < count));
            let positions: &[[f32; 3]] = bytemuck::cast_slice(positions.bytes);
            let normals: &[[i8; 4]] = bytemuck::cast_slice(normals.bytes);
            let origin = Vec3::from(chunk.origin().map(|c| c as f32));
            for (p, n) in positions.iter().zip(normals) {
                let outward = (Vec3::from(*p) + origin - Vec3::new(-1000.0, 0.0, 0.0)) / 9.0;
                assert!((outward.length() - 1.0).abs() < 0.01);
                let normal = Vec3::new(n[0].into(), n[1].into(), n[2].into()) / 127.0;
                assert!(normal.distance(outward.normalize()) < 0.05);
            }
            seen += chunk.triangles.len();
        });
        assert!(seen > 4000, "{seen} triangles of the ball");
    }

    /// Vectors of other libraries are made of arrays, without a feature.
    #[test]
    fn other_vectors_are_made_of_arrays() {
        ball_in_chunks(&mut Scratch::default(), |chunk, _, _, _| {
            for p in &chunk.positions {
                let (mint, glam): (mint::Point3<f32>, Vec3) = ((*p).into(), (*p).into());
                assert_eq!([mint.x, mint.y, mint.z], glam.to_array());
            }
        });
    }
}
