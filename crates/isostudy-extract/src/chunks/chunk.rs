//! What is extracted of a box of cells.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_field::Aabb;
use isostudy_mesh::TriangleMesh;

use super::world::World;
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;
use crate::memory::refill;
use crate::method::Method;
use crate::surface::trace::VertexKey;
use crate::wording::in_words;

/// The surface in a box of cells of a larger lattice: a [`ChunkExtractor`](crate::ChunkExtractor) makes it.
///
/// A triangle belongs to the cell whose tetrahedron it lies in, and a cell to one chunk. A vertex on the seam is in all
/// chunks that have a triangle at it, everywhere with the same key, position and normal, to the bit.
///
/// The numbers are plain: `bytemuck::cast_slice` makes bytes for a GPU of [`positions`](Self::positions),
/// [`normals`](Self::normals) and [`triangles`](Self::triangles), and vectors of any library are made from arrays.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    /// The cells whose triangles these are.
    pub cells: CellBox,
    /// Where the vertices are, in the field's coordinates, or from [`origin`](Self::origin) on
    /// ([`ChunkSettings::relative`](crate::ChunkSettings::relative)).
    pub positions: Vec<[f32; 3]>,
    /// Outward, of unit length: those of the whole mesh. As many as positions, or none
    /// ([`Normals::None`](crate::Normals)).
    pub normals: Vec<[f32; 3]>,
    /// Numbers of vertices, counter-clockwise seen from outside, in the order of the whole mesh. Those of
    /// [seams](crate::LevelExtractor) to other levels come last.
    pub triangles: Vec<[u32; 3]>,
    /// The key of each vertex. Ascending, unless edges were collapsed: then vertices are numbered by first use. Vertices that only
    /// seams have come last. None without [`ChunkSettings::keys`](crate::ChunkSettings::keys).
    pub keys: Vec<VertexKey>,
    /// The cell of each triangle by its number in `cells`, x fastest. Ascending, seams aside. See [`cell_of`](Self::cell_of). None
    /// without [`ChunkSettings::keys`](crate::ChunkSettings::keys).
    pub triangle_cells: Vec<u32>,
    /// The cells whose samples were looked at, those of seams aside.
    pub window: CellBox,
    /// The level whose grid the cells are of: 0 but for chunks of a [`LevelExtractor`](crate::LevelExtractor).
    pub level: u32,
    /// How many of the triangles, the last ones, are of seams to other levels.
    pub seam: u32,
    /// The box of those samples.
    pub(super) sampled: Aabb,
    /// The box of the vertices.
    pub(super) bounds: Option<Aabb>,
    pub(super) world: Option<World>,
    /// Whether vertices of the whole are numbered by first use, not by key.
    pub(super) numbered_by_use: bool,
}

impl Default for Chunk {
    /// Of no world: room for chunks to come.
    fn default() -> Self {
        Self {
            cells: CellBox::default(),
            positions: Vec::new(),
            normals: Vec::new(),
            triangles: Vec::new(),
            keys: Vec::new(),
            triangle_cells: Vec::new(),
            window: CellBox::default(),
            level: 0,
            seam: 0,
            sampled: Aabb { min: [f32::NEG_INFINITY; 3], max: [f32::INFINITY; 3] },
            bounds: None,
            world: None,
            numbered_by_use: false,
        }
    }
}

/// More vertices than 16 bits can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooManyVertices {
    /// How many there are.
    pub vertices: usize,
}

in_words! {
    TooManyVertices {
        Self { vertices } =>
            "{vertices} vertices are more than 16-bit indices can name, which is {}", 1 << 16;
    }
}

impl Chunk {
    /// Makes room for so many vertices, and for the triangles that as many have: twice as many. For chunks whose room is
    /// made before the first one is extracted.
    pub fn reserve(&mut self, vertices: usize) {
        self.positions.reserve(vertices);
        self.normals.reserve(vertices);
        self.keys.reserve(vertices);
        self.triangles.reserve(2 * vertices);
        self.triangle_cells.reserve(2 * vertices);
    }

    /// Whether the chunk can be another one when the field has changed in this box, and nowhere else. If not, it is the
    /// same to the bit: nothing in the box was looked at, for seams neither. [`Grid::touched`] names all such chunks of one level.
    ///
    /// The box is that of all points whose *value* changes. To dig a ball out of a distance with `min(solid, ball)`
    /// changes values everywhere outside of the ball that are greater than the distance to it: cut the field off a few
    /// cells inside the solid, as `examples/dig.rs` does.
    ///
    /// A bound that is not a number is a change everywhere. A chunk that was never extracted is touched by everything.
    pub fn is_touched_by(&self, changed: impl Into<Aabb>) -> bool {
        self.sampled.meets(&changed.into())
    }

    /// What it is a chunk of; `None` if it was never extracted.
    pub fn world(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// Whether it is a chunk of this grid, by this method. Of a level, the grid is that of the level.
    pub fn is_of(&self, grid: &Grid, method: &Method) -> bool {
        self.world.is_some_and(|world| world.grid() == Some(grid) && world.method() == method)
    }

    /// The lowest corner of its cells.
    pub fn origin(&self) -> [f64; 3] {
        self.world.map_or([0.0; 3], |world| world.position(self.cells.start))
    }

    /// The least box round the vertices, for culling; `None` without any.
    pub fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    /// The corners that a vertex lies between, in the grid of the vertex's [level](VertexKey::level): both ends of an edge for a
    /// crossing of marching cubes, else the lowest and the highest corner of a cell. They follow from the key, and so are the same
    /// in all chunks that have the vertex.
    ///
    /// # Panics
    /// If there is no such vertex, or chunks have no [keys](crate::ChunkSettings::keys).
    pub fn corners_of(&self, vertex: usize) -> [[i32; 3]; 2] {
        let key = self.keys[vertex];
        if self.world.is_some_and(|world| world.method.family().has_vertices_on_edges()) {
            return key.ends_of_crossing();
        }
        let low = key.cell();
        [low, low.map(|i| i.saturating_add(1))]
    }

    /// Something of one's own for each vertex, such as a material, a colour or light, into `payload`, whose room is used again. `of` is told
    /// the level and the [corners](Self::corners_of) that the vertex lies between. What follows from these alone is the same in all chunks
    /// that have the vertex, so that no seam shows. Without [keys](crate::ChunkSettings::keys) there is none.
    ///
    /// ```
    /// use isostudy_extract::{ChunkExtractor, ChunkSettings, Control, Cubes, Grid, Method, from_fn};
    ///
    /// // Stone below, and sand in the two layers of voxels at the top.
    /// let ground = from_fn(|[_, _, z]| 5.5 - z);
    /// let (is_solid, is_sand) = (|[_, _, z]: [i32; 3]| z <= 5, |[_, _, z]: [i32; 3]| z >= 4);
    ///
    /// let grid = Grid::try_new([0.0; 3], 1.0)?;
    /// let mut extractor = ChunkExtractor::try_new(&grid, &Method::Cubes(Cubes::default()), &ChunkSettings::default())?;
    /// let chunk = extractor.extract(&ground, grid.chunk([0, 0, 0], 8), Control::default())?;
    /// let mut sand = Vec::new();
    /// // Of the solid end of its edge.
    /// chunk.payload(|_, ends| ends.into_iter().find(|&end| is_solid(end)).is_some_and(is_sand), &mut sand);
    /// assert!(sand.len() == chunk.positions.len() && sand.iter().all(|&is_sand| is_sand));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn payload<T>(&self, mut of: impl FnMut(u32, [[i32; 3]; 2]) -> T, payload: &mut Vec<T>) {
        payload.clear();
        let vertices = self.keys.iter().enumerate();
        payload.extend(vertices.map(|(v, key)| of(key.level(), self.corners_of(v))));
    }

    /// The cell of a triangle, in the whole lattice.
    ///
    /// # Panics
    /// If there is no such triangle, or chunks have no [keys](crate::ChunkSettings::keys).
    pub fn cell_of(&self, triangle: usize) -> [i32; 3] {
        self.cells.cell(self.triangle_cells[triangle])
    }

    /// Positions less the [`origin`](Self::origin), for a renderer whose origin moves with the player. They are as fine as
    /// `f32` is at the vertex's own place: at 160,000 units that is 0.016. [`ChunkSettings::relative`](crate::ChunkSettings::relative)
    /// makes finer ones.
    pub fn relative_positions(&self, relative: &mut Vec<[f32; 3]>) {
        let is_relative = self.world.is_some_and(|world| world.settings.relative);
        let origin = if is_relative { [0.0; 3] } else { self.origin() };
        relative.clear();
        relative.extend(
            self.positions.iter().map(|p| [0, 1, 2].map(|axis| (f64::from(p[axis]) - origin[axis]) as f32)),
        );
    }

    /// Vertex numbers in 16 bits, three a triangle. A chunk of 32³ cells has some thousand vertices.
    ///
    /// # Errors
    /// [`TooManyVertices`]; then there are none.
    pub fn indices_u16(&self, indices: &mut Vec<u16>) -> Result<(), TooManyVertices> {
        indices.clear();
        if self.positions.len() > 1 << 16 {
            return Err(TooManyVertices { vertices: self.positions.len() });
        }
        indices.extend(self.triangles.iter().flatten().map(|&v| v as u16));
        Ok(())
    }

    /// The triangles as a mesh, with vertices of `glam`: a copy.
    pub fn mesh(&self) -> TriangleMesh {
        let points = |of: &[[f32; 3]]| of.iter().copied().map(Vec3::from).collect();
        TriangleMesh {
            positions: points(&self.positions),
            normals: points(&self.normals),
            triangles: self.triangles.clone(),
        }
    }

    /// Begins another chunk, in the room that there is.
    pub(super) fn start(&mut self, world: &World, cells: CellBox, window: CellBox, sampled: Aabb) {
        self.clear();
        (self.cells, self.window, self.sampled) = (cells, window, sampled);
        self.world = Some(*world);
    }

    /// Empty and of no world; its vectors keep their room.
    pub(crate) fn clear(&mut self) {
        let Self { positions, normals, triangles, keys, triangle_cells, .. } = self;
        positions.clear();
        normals.clear();
        triangles.clear();
        keys.clear();
        triangle_cells.clear();
        *self = Self {
            positions: std::mem::take(positions),
            normals: std::mem::take(normals),
            triangles: std::mem::take(triangles),
            keys: std::mem::take(keys),
            triangle_cells: std::mem::take(triangle_cells),
            ..Self::default()
        };
    }

    /// Makes it one of several levels, seams and all.
    pub(crate) fn close_level(&mut self, level: u32) {
        self.level = level;
        self.world = self.world.map(|world| World { level: Some(level), ..world });
        self.close();
    }

    /// Takes away the vertices that no triangle has, but for some.
    pub(crate) fn drop_unused(&mut self, stays: impl Fn(VertexKey) -> bool) -> Result<(), TryReserveError> {
        let mut numbers = Vec::new();
        refill(&mut numbers, self.keys.len(), u32::MAX)?;
        let used = self.triangles.iter().flatten().map(|&v| v as usize);
        used.chain((0..self.keys.len()).filter(|&v| stays(self.keys[v]))).for_each(|v| numbers[v] = 0);
        let mut next = 0;
        for (v, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number != u32::MAX) {
            let to = next as usize;
            (self.keys[to], self.positions[to], *number) = (self.keys[v], self.positions[v], next);
            if let Some(&normal) = self.normals.get(v) {
                self.normals[to] = normal;
            }
            next += 1;
        }
        self.keys.truncate(next as usize);
        self.positions.truncate(next as usize);
        self.normals.truncate(next as usize);
        self.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
        Ok(())
    }

    /// It depends on the samples of another chunk, too.
    pub(crate) fn also_sampled(&mut self, other: &Self) {
        let axes = [0, 1, 2];
        let (one, other) = (self.sampled, other.sampled);
        self.sampled = Aabb {
            min: axes.map(|i| one.min[i].min(other.min[i])),
            max: axes.map(|i| one.max[i].max(other.max[i])),
        };
    }

    /// Finds the box of the vertices.
    pub(super) fn close(&mut self) {
        self.bounds = self.positions.first().map(|&first| {
            let (mut min, mut max) = (first, first);
            for p in &self.positions {
                for axis in 0..3 {
                    // No position is not a number. So written it is one instruction.
                    min[axis] = if p[axis] < min[axis] { p[axis] } else { min[axis] };
                    max[axis] = if p[axis] > max[axis] { p[axis] } else { max[axis] };
                }
            }
            Aabb { min, max }
        });
    }
}
