//! Tables and figures as files, each in the formats that people go on with.

use crate::store::Writer;
use anyhow::Result;
use isostudy_report::Figure;
use isostudy_table::Table;

/// Writes a table as CSV, Markdown and LaTeX into a folder.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn write_table(writer: &mut Writer<'_>, folder: &str, table: &Table) -> Result<()> {
    let path = format!("{folder}/{}", table.name);
    writer.write(&format!("{path}.csv"), table.to_csv().as_bytes())?;
    writer.write(&format!("{path}.md"), table.to_markdown().as_bytes())?;
    writer.write(&format!("{path}.tex"), table.to_latex().as_bytes())
}

/// Writes a figure as SVG and PNG into a folder, and as SVG for narrow screens where it is drawn for them.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn write_figure(writer: &mut Writer<'_>, folder: &str, figure: &Figure) -> Result<()> {
    let path = format!("{folder}/{}", figure.name);
    writer.write(&format!("{path}.svg"), figure.svg.as_bytes())?;
    if let Some(narrow) = &figure.narrow {
        writer.write(&format!("{path}-narrow.svg"), narrow.as_bytes())?;
    }
    writer.write(&format!("{path}.png"), &figure.png)
}
