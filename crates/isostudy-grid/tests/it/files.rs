//! Files that VTK 9.7 wrote, and what `vtkContourGrid` makes of them; `scripts/grid-vtk.py --fixtures` writes both anew.

use std::path::{Path, PathBuf};

use isostudy_grid::Grid;

/// What no test comes near to.
pub(crate) const LIMIT: u64 = 1 << 20;

pub(crate) fn vtk(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/vtk").join(name)
}

/// All files of a grid, each with the name of its array.
pub(crate) fn all(grid: &str) -> Vec<(PathBuf, &'static str)> {
    let mut files: Vec<_> = std::fs::read_dir(vtk("")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.starts_with(grid) && !name.ends_with(".txt")
    });
    files.sort();
    let array = |path: &Path| match path.extension().unwrap().to_str().unwrap() {
        "node" | "ele" => "1",
        _ => "a value",
    };
    files.into_iter().map(|path| (path.clone(), array(&path))).collect()
}

pub(crate) fn read(path: &Path, array: &str) -> Grid {
    isostudy_grid::read(path, Some(array), LIMIT).unwrap()
}

/// A file in a folder of its own, which is gone with it.
pub(crate) struct Written {
    folder: tempfile::TempDir,
    name: &'static str,
}

impl Written {
    pub(crate) fn new(name: &'static str, text: impl AsRef<[u8]>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
        Self { folder, name }
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.folder.path().join(self.name)
    }

    pub(crate) fn beside(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.folder.path().join(name), text).unwrap();
    }
}

#[test]
fn every_way_to_write_a_grid_is_read_as_one_grid() {
    for (name, count) in [("few", 11), ("mixed", 9)] {
        let files = all(name);
        assert_eq!(files.len(), count, "{name}");
        let first = read(&files[0].0, files[0].1);
        for (path, array) in files {
            assert_eq!(read(&path, array), first, "{}", path.display());
        }
    }
}

#[test]
fn vertices_are_where_vtk_puts_them() {
    let grid = read(&vtk("few_51_1_vtu.vtk"), "a value");
    let surface = grid.extract(0.105);
    let rounded = |of: [f64; 3]| of.map(|x| (x * 1e6).round() as i64);
    let mut ours: Vec<_> =
        surface.mesh.positions.iter().map(|p| rounded(p.to_array().map(f64::from))).collect();
    let text = std::fs::read_to_string(vtk("few_places.txt")).unwrap();
    let place = |line: &str| {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        rounded([numbers[0], numbers[1], numbers[2]])
    };
    let mut theirs: Vec<_> = text.lines().map(place).collect();
    ours.sort_unstable();
    theirs.sort_unstable();
    assert_eq!(ours.len(), 49);
    // VTK rounds its places to single precision in another order.
    for (ours, theirs) in ours.iter().zip(&theirs) {
        assert!(ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() <= 1), "{ours:?} {theirs:?}");
    }
}

#[test]
fn cells_without_volume_are_counted_and_left_out() {
    let grid = read(&vtk("mixed_51_0_vtu.vtk"), "a value");
    assert_eq!((grid.cells().solid, grid.cells().flat), (5, 2));
    // Six tetrahedra in the hexahedron and in the voxel, two in the pyramid, three in the wedge.
    assert_eq!(grid.tetrahedra().len(), 6 + 2 + 3 + 6 + 1);
}

/// A curvilinear grid of 3 x 2 x 2 points.
const POINTS: &str = "0 0 0 1 0 0 3 0 1 0 1 0 1 1 0 3 1 1 0 0 2 1 0 2 3 0 3 0 1 2 1 1 2 3 1 3";
const VALUES: &str = "0 1 2 3 4 5 6 7 8 9 10 11";

#[test]
fn curvilinear_grids_are_their_hexahedra() {
    let vts = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\"><StructuredGrid WholeExtent=\"5 7 0 1 -1 0\">\
         <Piece Extent=\"5 7 0 1 -1 0\"><PointData><DataArray type=\"Int16\" Name=\"T\" format=\"ascii\">{VALUES}</DataArray>\
         </PointData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{POINTS}</DataArray></Points>\
         </Piece></StructuredGrid></VTKFile>"
    );
    let head = "# vtk DataFile Version 3.0\na title\nASCII\n";
    let data = format!("POINT_DATA 12\nSCALARS T short\nLOOKUP_TABLE default\n{VALUES}\n");
    let structured =
        format!("{head}DATASET STRUCTURED_GRID\nDIMENSIONS 3 2 2\nPOINTS 12 double\n{POINTS}\n{data}");
    let unstructured = format!(
        "{head}DATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n{POINTS}\nCELLS 2 18\n8 0 1 4 3 6 7 10 9\n8 1 2 5 4 7 8 11 10\n\
         CELL_TYPES 2\n12 12\n{data}"
    );
    let grids = [("a.vts", vts), ("a.vtk", structured), ("b.vtk", unstructured)].map(|(name, text)| {
        let file = Written::new(name, text);
        read(&file.path(), "T")
    });
    assert_eq!(grids[0].tetrahedra().len(), 12);
    assert_eq!(grids[0], grids[1]);
    assert_eq!(grids[0], grids[2]);
}

#[test]
fn pieces_follow_each_other_and_are_not_joined() {
    let piece = |at: f64| {
        format!(
            "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData><DataArray type=\"Float32\" Name=\"T\" format=\"ascii\">\
             1 0 0 0</DataArray></PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\
             {at} 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\
             0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>"
        )
    };
    let empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>";
    let text = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>{}{empty}{}</UnstructuredGrid></VTKFile>",
        piece(0.0),
        piece(-1.0)
    );
    let file = Written::new("a.vtu", text);
    // There is only one array, so it need not be named.
    let grid = isostudy_grid::read(&file.path(), None, LIMIT).unwrap();
    assert_eq!(grid.tetrahedra(), [[0, 1, 2, 3], [4, 5, 6, 7]]);
    assert_eq!(grid.points()[4], [-1.0, 0.0, 0.0]);
    assert_eq!(grid.oddities().twice, 3);
}

#[test]
fn fields_colours_and_texts_of_a_legacy_file_are_passed_over() {
    let text = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\nTIME 1 1 double\n0.5\n\
                NAMES 1 2 string\nfirst%20one\nsecond\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n\
                CELL_DATA 1\nSCALARS c int 1\nLOOKUP_TABLE default\n7\nPOINT_DATA 4\nVECTORS v float\n0 0 0 0 0 0 0 0 0 0 0 0\n\
                COLOR_SCALARS rgb 3\n1 1 1 1 1 1 1 1 1 1 1 1\nLOOKUP_TABLE mine 1\n0 0 0 1\nFIELD FieldData 2\nfirst%20one 1 4 float\n\
                1 0 0 0\nMETADATA\nINFORMATION 0\n\nother 2 4 int\n0 0 0 0 0 0 0 0\n";
    let file = Written::new("a.vtk", text);
    assert_eq!(read(&file.path(), "first one").values(), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(isostudy_grid::read(&file.path(), None, LIMIT).unwrap().values(), [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn tetgen_counts_from_zero_or_one_and_has_comments() {
    let nodes = |first: usize| {
        let at = [[0, 0, 0, 1], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]];
        let row = |(i, [x, y, z, v]): (usize, &[i32; 4])| {
            format!("  {}  {x} {y} {z}.0  {v} 9.5 2 # a point\n", i + first)
        };
        let rows: String = at.iter().enumerate().map(row).collect();
        format!("# made by hand\n\n4 3 2 1\n{rows}# the end\n")
    };
    let elements =
        |first: usize| format!("1 4 1\n{} {} {} {} {} 5\n", first, first, first + 1, first + 2, first + 3);
    let grids = [0, 1].map(|first| {
        let file = Written::new("a.node", nodes(first));
        file.beside("a.ele", elements(first));
        let grid = read(&file.path(), "1");
        assert_eq!(read(&file.path().with_extension("ele"), "1"), grid);
        assert_eq!(read(&file.path(), "2").values(), [9.5; 4]);
        grid
    });
    assert_eq!(grids[0], grids[1]);
    assert_eq!(grids[0].tetrahedra(), [[0, 1, 2, 3]]);
    assert_eq!(grids[0].values(), [1.0, 0.0, 0.0, 0.0]);
}
