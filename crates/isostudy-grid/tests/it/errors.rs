//! What is wrong with a file is told with its place.

use crate::files::{LIMIT, Written, vtk};

/// A tetrahedron in a `.vtu`, with one passage replaced.
fn vtu(from: &str, to: &str) -> String {
    let text = "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
                <Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<PointData>\n\
                <DataArray type=\"Float32\" Name=\"heat\" format=\"ascii\">1 0 0 0</DataArray>\n\
                <DataArray type=\"Float32\" Name=\"wind\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 0 0 0 0 0 0 0 0 0</DataArray>\n\
                </PointData>\n<CellData>\n<DataArray type=\"Int32\" Name=\"rock\" format=\"ascii\">1</DataArray>\n</CellData>\n<Points>\n\
                <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray>\n</Points>\n<Cells>\n\
                <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\n\
                <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>\n\
                <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

fn legacy(from: &str, to: &str) -> String {
    let text = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n\
                CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n1 0 0 0\n";
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

const NODES: &str = "4 3 1 0\n1 0 0 0 1\n2 1 0 0 0\n3 0 1 0 0\n4 0 0 1 0\n";
const ELEMENTS: &str = "1 4 0\n1 1 2 3 4\n";

/// The error, without the path of the file.
fn told(name: &'static str, text: &str, array: &str) -> String {
    let file = Written::new(name, text);
    told_of(&file, array)
}

fn told_of(file: &Written, array: &str) -> String {
    let error = isostudy_grid::read(&file.path(), Some(array), LIMIT).unwrap_err().to_string();
    let folder = file.path().parent().unwrap().display().to_string();
    error.replace(&format!("{folder}/"), "")
}

#[test]
fn arrays_that_cannot_be_taken_are_told_with_those_that_can() {
    let whole = vtu("", "");
    let of = |array| told("a.vtu", &whole, array);
    assert_eq!(
        of("heap"),
        "a.vtu: no array on points has the name `heap`; those on points are `heat`, `wind`"
    );
    assert!(
        of("rock").starts_with("a.vtu: the array `rock` has its values on cells. A surface needs"),
        "{}",
        of("rock")
    );
    assert_eq!(of("wind"), "a.vtu: the array `wind` has 3 numbers per point; a surface needs one");
    let two =
        vtu("NumberOfComponents=\"3\" format=\"ascii\">0 0 0 0 0 0 0 0 0 0 0 0", "format=\"ascii\">0 0 0 0");
    let file = Written::new("a.vtu", two);
    let error = isostudy_grid::read(&file.path(), None, LIMIT).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("which array shall be taken is not said; those on points are `heat`, `wind`")
    );
    let none = format!("{}# no attributes\n", NODES.replace("4 3 1 0", "4 3 0 0").replace(" 0\n", "\n"));
    let file = Written::new("a.node", none);
    file.beside("a.ele", ELEMENTS);
    assert_eq!(
        told_of(&file, "1"),
        "a.node: no array on points has the name `1`; the file has none on points"
    );
}

#[test]
fn faults_of_a_vtu_are_told_with_their_place() {
    for (from, to, want) in [
        (
            "UnstructuredGrid",
            "ImageData",
            "line 1: type=\"ImageData\" is not supported; UnstructuredGrid and StructuredGrid are",
        ),
        ("LittleEndian", "Middle", "line 1: byte_order=\"Middle\" is not supported"),
        (
            "byte_order",
            "compressor=\"vtkLZ4DataCompressor\" byte_order",
            "line 1: compressor=\"vtkLZ4DataCompressor\" is not supported",
        ),
        ("<VTKFile", "<html", "line 1: the file begins with <html>, not <VTKFile>"),
        (
            "NumberOfPoints=\"4\"",
            "NumberOfPoints=\"5\"",
            "line 12: the array ``: it has 12 numbers, and must have 15",
        ),
        ("NumberOfPoints=\"4\"", "NumberOfPoints=\"3\"", "line 12: the array ``: it has more than 9 numbers"),
        ("NumberOfPoints=\"4\"", "", "line 3: the piece has no NumberOfPoints"),
        ("NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\"", "line 3: NumberOfPoints=\"-4\" is no count"),
        (
            "NumberOfPoints=\"4\"",
            "NumberOfPoints=\"18446744073709551615\"",
            "line 12: the array ``: it has 12 numbers",
        ),
        (
            "NumberOfCells=\"1\"",
            "NumberOfCells=\"2\"",
            "line 17: the array `types`: it has 1 numbers, and must have 2",
        ),
        (">1 0 0 0<", ">1 0 0<", "line 5: the array `heat`: it has 3 numbers, and must have 4"),
        (">1 0 0 0<", ">1 0 x 0<", "line 5: the array `heat`: number 2 is `x`"),
        (
            "0 0 0 1 0 0 0 1 0 0 0 1",
            "0 0 0 1 0 nan 0 1 0 0 0 1",
            "point 1 lies at [1.0, 0.0, NaN], which is no place",
        ),
        ("0 0 0 1 0 0 0 1 0 0 0 1", "0 0 0 1 0 1e40 0 1 0 0 0 1", "point 1 lies at [1.0, 0.0, inf]"),
        (">0 1 2 3<", ">0 1 2 4<", "cell 0: names point 4, and the points are 0 to 3"),
        (">0 1 2 3<", ">0 1 -2 3<", "cell 0: names point -2"),
        (">4</", ">3</", "line 15: the array `connectivity`: it has more than 3 numbers"),
        (">4</", ">-4</", "line 16: the array `offsets`: its last number is negative"),
        (">10<", ">12<", "cell 0: a hexahedron has 8 points, not 4"),
        (">10<", ">24<", "cell 0: is a quadratic tetrahedron (type 24). Tetrahedra, voxels"),
        (">10<", ">42<", "cell 0: is a polyhedron (type 42)"),
        ("\"UInt8\"", "\"Float32\"", "line 17: the array `types`: its numbers must be whole"),
        (
            "\"Float32\" Name=\"heat\"",
            "\"Bit\" Name=\"heat\"",
            "line 5: the array `heat`: the type `Bit` is none of Int8",
        ),
        (
            "format=\"ascii\">1 0 0 0",
            "format=\"binary\">EAAAAAAAgD8=",
            "line 5: the array `heat`: it ends after 4 of 16 bytes",
        ),
        (
            "format=\"ascii\">1 0 0 0",
            "format=\"binary\">EAAAA!AAgD8",
            "line 5: the array `heat`: `A!AA` is no base64",
        ),
        (
            "format=\"ascii\">1 0 0 0",
            "format=\"binary\">CAAAAA==",
            "line 5: the array `heat`: it has 8 bytes, and must have 16",
        ),
        (
            "format=\"ascii\">1 0 0 0",
            "format=\"appended\" offset=\"0\">",
            "line 5: the array `heat`: the file has no appended data",
        ),
        (
            "format=\"ascii\">1 0 0 0",
            "format=\"appended\">",
            "line 5: the appended array `heat` has no offset",
        ),
        (
            "format=\"ascii\">1 0 0 0",
            "format=\"new\">",
            "line 5: the array `heat`: its format is none of ascii, binary and appended",
        ),
        ("</PointData>", "</Points>", "line 7: this is no XML"),
    ] {
        let got = told("a.vtu", &vtu(from, to), "heat");
        assert!(got.starts_with(&format!("a.vtu: {want}")), "{from} to {to}: {got}");
    }
    let whole = vtu("", "");
    let cut = &whole[..whole.find("0 0 0 1 0 0 0 1").unwrap() + 5];
    assert_eq!(told("a.vtu", cut, "heat"), "a.vtu: line 12: the array ``: the file ends within it");
    assert_eq!(told("a.vtu", "", "heat"), "a.vtu: line 1: the file has no <VTKFile>");
    assert!(told("a.vtu", "no tags", "heat").contains("no <VTKFile>"));
}

#[test]
fn faults_of_a_legacy_file_are_told_with_their_place() {
    for (from, to, want) in [
        ("# vtk", "# VTK", "line 1: the file does not begin with `# vtk DataFile Version` and a number"),
        ("ASCII", "ASKII", "line 3: `ASKII` is neither ASCII nor BINARY"),
        ("UNSTRUCTURED_GRID", "POLYDATA", "line 4: DATASET POLYDATA is not supported"),
        ("DATASET UNSTRUCTURED_GRID\n", "", "line 4: `POINTS` is here, and DATASET must be"),
        ("POINTS 4", "POINTS 5", "line 5: the array `POINTS`: number 12 of 15 is `CELLS`"),
        ("POINTS 4", "POINTS 400", "line 5: the array `POINTS`: number 12 of 1200 is `CELLS`"),
        ("POINTS 4", "POINTS 3", "line 6: `0` is no keyword of a grid with values"),
        (
            "POINTS 4",
            "POINTS 18446744073709551615",
            "line 5: 18446744073709551615 times 3 numbers are more than can be counted",
        ),
        ("POINTS 4 float", "POINTS 4 half", "line 5: `half` is no type of numbers"),
        ("0 0 0 1 0 0 0 1", "0 0 0 1 0 0 0 one", "line 5: the array `POINTS`: number 7 of 12 is `one`"),
        ("CELLS 1 5", "CELLS 2 5", "line 9: there are 1 types for 2 cells"),
        ("CELLS 1 5\n4 0 1 2 3", "CELLS 1 4\n4 0 1 2", "cell 0: the list of CELLS ends before its points"),
        ("CELLS 1 5\n4 0 1 2 3", "CELLS 1 6\n4 0 1 2 3 4", "CELLS has 1 numbers more than its 1 cells"),
        ("4 0 1 2 3", "4 0 1 2 9", "cell 0: names point 9, and the points are 0 to 3"),
        ("4 0 1 2 3", "-4 0 1 2 3", "cell 0: the list of CELLS ends before its points"),
        ("\n10\n", "\n25\n", "cell 0: is a quadratic hexahedron (type 25)"),
        ("POINT_DATA 4", "POINT_DATA 3", "line 14: `0` is no keyword of a grid with values"),
        ("POINT_DATA 4", "CELL_DATA 4", "the array `heat` has its values on cells"),
        (
            "SCALARS heat float",
            "SCALARS heat float 4",
            "line 12: the array `heat`: the file ends after 4 of 16 numbers",
        ),
        ("CELLS 1 5\n4 0 1 2 3\n", "", "the file has no CELLS"),
    ] {
        let got = told("a.vtk", &legacy(from, to), "heat");
        assert!(got.starts_with(&format!("a.vtk: {want}")), "{from} to {to}: {got}");
    }
    let structured = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 4 float\n\
                      0 0 0 1 0 0 0 1 0 0 0 1\nPOINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n1 0 0 0\n";
    assert_eq!(told("a.vtk", structured, "heat"), "a.vtk: DIMENSIONS [2, 2, 2] do not go with 4 points");
}

#[test]
fn faults_of_tetgen_files_are_told_with_their_place() {
    let told = |nodes: &str, elements: &str| {
        let file = Written::new("a.node", nodes);
        file.beside("a.ele", elements);
        told_of(&file, "1")
    };
    for (from, to, want) in [
        ("4 3 1 0", "4 2 1 0", "line 1: the dimension must be 3"),
        ("4 3 1 0", "5 3 1 0", "the file ends after 4 of 5 points"),
        ("4 3 1 0", "3 3 1 0", "line 5: there is more than the 3 points that line 1 claims"),
        ("4 3 1 0", "four", "line 1: must be counts: points, dimension"),
        ("2 1 0 0 0", "2 1 0 0", "line 3: a point has 5 numbers here, not 4"),
        ("2 1 0 0 0", "3 1 0 0 0", "line 3: number 2 must be here, not 3"),
        ("2 1 0 0 0", "2 1 y 0 0", "line 3: `y` is no number"),
        ("1 0 0 0 1", "7 0 0 0 1", "line 2: the first point has number 7, neither 0 nor 1"),
    ] {
        assert!(NODES.contains(from));
        let got = told(&NODES.replacen(from, to, 1), ELEMENTS);
        assert!(got.starts_with(&format!("a.node: {want}")), "{from} to {to}: {got}");
    }
    for (from, to, want) in [
        ("1 4 0", "1 10 0", "line 1: tetrahedra of 10 points are not taken, those of 4 are"),
        ("1 4 0", "2 4 0", "the file ends after 1 of 2 tetrahedra"),
        ("1 4 0", "0 4 0", "line 2: there is more than the 0 tetrahedra that line 1 claims"),
        ("1 1 2 3 4", "1 1 2 3", "line 2: a tetrahedron has 5 numbers here, not 4"),
        ("1 1 2 3 4", "1 1 2 3 5", "line 2: names point 5, and the points are 1 to 4"),
        ("1 1 2 3 4", "1 0 2 3 4", "line 2: names point 0, and the points are 1 to 4"),
    ] {
        assert!(ELEMENTS.contains(from));
        let got = told(NODES, &ELEMENTS.replacen(from, to, 1));
        assert!(got.starts_with(&format!("a.ele: {want}")), "{from} to {to}: {got}");
    }
    let alone = Written::new("a.node", NODES);
    assert!(told_of(&alone, "1").starts_with("a.ele: No such file"), "{}", told_of(&alone, "1"));
}

#[test]
fn what_is_no_file_or_no_grid_or_too_large_is_refused() {
    let file = Written::new("a.vtp", "");
    assert_eq!(told_of(&file, "T"), "a.vtp: known endings are .vtu, .vts, .vtk, .node and .ele");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("a.vtu")).unwrap();
    let error = isostudy_grid::read(&folder.path().join("a.vtu"), None, LIMIT).unwrap_err();
    assert!(error.to_string().ends_with("a.vtu: not a file, but a folder"), "{error}");
    let path = vtk("few_Ascii_None_0_UInt32_Little.vtu");
    let size = std::fs::metadata(&path).unwrap().len();
    isostudy_grid::read(&path, Some("a value"), size).unwrap();
    let error = isostudy_grid::read(&path, Some("a value"), size - 1).unwrap_err();
    assert!(
        error.to_string().ends_with(&format!("larger than {} bytes, the limit for such a file", size - 1)),
        "{error}"
    );
    // Its 24 points of 32 bytes and 42 tetrahedra of 16 are larger than the file.
    let file = Written::new("a.vtk", legacy("", ""));
    let error = isostudy_grid::read(&file.path(), Some("heat"), 160);
    assert!(error.unwrap_err().to_string().contains("larger than 160 bytes"));
}

#[test]
fn compressed_numbers_are_no_more_than_they_must_be() {
    use flate2::{Compression, write::ZlibEncoder};
    use std::io::Write;
    // A megabyte of zeros where sixteen bytes must be.
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::best());
    packer.write_all(&vec![0; 1 << 20]).unwrap();
    let packed = packer.finish().unwrap();
    let with = |counts: [u32; 4]| {
        let mut bytes: Vec<u8> = counts.iter().flat_map(|count| count.to_le_bytes()).collect();
        bytes.extend(&packed);
        let text = vtu("format=\"ascii\">1 0 0 0", "format=\"appended\" offset=\"0\">");
        let text = text.replace("byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order");
        let end = text.find("</VTKFile>").unwrap();
        let appended = [&text.as_bytes()[..end], b"<AppendedData encoding=\"raw\">_", &bytes].concat();
        let file = Written::new("a.vtu", appended);
        told_of(&file, "heat")
    };
    let size = packed.len() as u32;
    assert!(with([1, 16, 0, size]).ends_with("`heat`: block 1 of 1 has 17 bytes or more, and must have 16"));
    assert!(
        with([1, 1 << 20, 0, size]).ends_with("`heat`: its 1 blocks have 1048576 bytes, and must have 16")
    );
    assert!(with([u32::MAX, u32::MAX, 3, size]).contains("`heat`: its 4294967295 blocks have"));
    assert!(with([2, 8, 0, size]).contains("`heat`: "), "the second block is beyond the end");
    assert!(with([1, 16, 0, u32::MAX]).contains("bytes"));
}
