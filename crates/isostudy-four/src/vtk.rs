//! Tetrahedra as a legacy file of VTK.

use std::io::{self, Write};

/// Writes places with a number each, and tetrahedra on them, in ASCII.
pub(crate) fn write_tetrahedra(
    mut output: impl Write,
    title: &str,
    places: impl ExactSizeIterator<Item = ([f64; 3], f64)> + Clone,
    tetrahedra: &[[u32; 4]],
    name: &str,
) -> io::Result<()> {
    let (points, cells) = (places.len(), tetrahedra.len());
    writeln!(output, "# vtk DataFile Version 3.0\n{title}, isostudy\nASCII")?;
    writeln!(output, "DATASET UNSTRUCTURED_GRID\nPOINTS {points} double")?;
    places.clone().try_for_each(|([x, y, z], _)| writeln!(output, "{x} {y} {z}"))?;
    writeln!(output, "CELLS {cells} {}", 5 * cells)?;
    tetrahedra.iter().try_for_each(|[a, b, c, d]| writeln!(output, "4 {a} {b} {c} {d}"))?;
    writeln!(output, "CELL_TYPES {cells}")?;
    tetrahedra.iter().try_for_each(|_| writeln!(output, "10"))?;
    writeln!(output, "POINT_DATA {points}\nSCALARS {name} double 1\nLOOKUP_TABLE default")?;
    places.clone().try_for_each(|(_, number)| writeln!(output, "{number}"))
}
