//! A chunk of voxels for a page: samples go into a buffer, and a mesh comes out of three others.
//!
//! With default features the module has surface nets and nothing else. `scripts/test-wasm.sh` says how large it is.
//!
//! The attribute that gives a function its name for the page is the only `unsafe` thing here: two functions of one
//! program must not have one name. Nothing else is.

use std::cell::RefCell;

use isostudy_extract::{
    CellBox, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Source, SurfaceNets,
};

/// Cells along a side of the chunk.
const CHUNK: u32 = 32;

struct Page {
    extractor: ChunkExtractor,
    cells: CellBox,
    window: CellBox,
    samples: Vec<f32>,
    chunk: Chunk,
}

impl Page {
    fn new() -> Option<Self> {
        let grid = Grid::try_new([0.0; 3], 1.0).ok()?;
        let method = Method::SurfaceNets(SurfaceNets::new());
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).ok()?;
        extractor.warm_up(CHUNK).ok()?;
        let cells = grid.chunk([0; 3], CHUNK);
        let window = extractor.window(cells).ok()??;
        let samples = vec![0.0; extractor.layout(window).ok()?.len()];
        Some(Self { extractor, cells, window, samples, chunk: Chunk::default() })
    }

    fn extract(&mut self) -> Option<u32> {
        let source = Source::Window { cells: self.window, samples: &self.samples };
        self.extractor.extract_into(source, self.cells, Control::default(), &mut self.chunk).ok()?;
        Some(self.chunk.triangles.len() as u32)
    }
}

thread_local! {
    static PAGE: RefCell<Option<Page>> = RefCell::new(Page::new());
}

/// `otherwise` if there is no page, which cannot be.
fn with_page<R>(otherwise: R, of: impl FnOnce(&mut Page) -> R) -> R {
    PAGE.with_borrow_mut(|page| match page {
        Some(page) => of(page),
        None => otherwise,
    })
}

/// Where samples go, x fastest: a value above 0 is inside. The first one is that of the point two cells below the chunk along each axis.
#[unsafe(no_mangle)]
pub extern "C" fn samples() -> *mut f32 {
    with_page(std::ptr::null_mut(), |page| page.samples.as_mut_ptr())
}

/// How many samples there are along each axis.
#[unsafe(no_mangle)]
pub extern "C" fn samples_per_axis() -> u32 {
    with_page(0, |page| (page.window.end[0] - page.window.start[0] + 1) as u32)
}

/// Makes the mesh of the chunk. How many triangles it has; the greatest number there is if it cannot be made.
#[unsafe(no_mangle)]
pub extern "C" fn extract() -> u32 {
    with_page(u32::MAX, |page| page.extract().unwrap_or(u32::MAX))
}

/// The vertices of the mesh, three `f32` each.
#[unsafe(no_mangle)]
pub extern "C" fn positions() -> *const [f32; 3] {
    with_page(std::ptr::null(), |page| page.chunk.positions.as_ptr())
}

/// Their normals.
#[unsafe(no_mangle)]
pub extern "C" fn normals() -> *const [f32; 3] {
    with_page(std::ptr::null(), |page| page.chunk.normals.as_ptr())
}

/// The triangles, three `u32` each.
#[unsafe(no_mangle)]
pub extern "C" fn triangles() -> *const [u32; 3] {
    with_page(std::ptr::null(), |page| page.chunk.triangles.as_ptr())
}

/// How many vertices the mesh has.
#[unsafe(no_mangle)]
pub extern "C" fn vertex_count() -> usize {
    with_page(0, |page| page.chunk.positions.len())
}

/// How many methods have a name.
#[cfg(feature = "all-families")]
#[unsafe(no_mangle)]
pub extern "C" fn method_count() -> u32 {
    isostudy_extract::presets().len() as u32
}

/// Makes the mesh of the samples as a volume, by the method with this number among all that have a name. How many triangles it has; the
/// greatest number there is if it cannot be made.
#[cfg(feature = "all-families")]
#[unsafe(no_mangle)]
pub extern "C" fn extract_by(preset: u32) -> u32 {
    use isostudy_extract::{Execution, Extractor, VolumeCells, presets};

    let extracted = |page: &mut Page| {
        let method = presets().get(preset as usize)?.method;
        let counts = [0, 1, 2].map(|axis| (page.window.end[axis] - page.window.start[axis] + 1) as usize);
        let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let volume = VolumeCells { counts, values: &page.samples, origin: [-2.0; 3], steps };
        let execution = Execution { threads: 1 };
        let made = volume.extract_interpolated(&method, &mut Extractor::new(), 0.0, &execution).ok()?;
        page.chunk = Chunk::default();
        page.chunk.positions = made.mesh.positions.iter().map(|p| p.to_array()).collect();
        page.chunk.triangles = made.mesh.triangles;
        Some(page.chunk.triangles.len() as u32)
    };
    with_page(u32::MAX, |page| extracted(page).unwrap_or(u32::MAX))
}
