//! From bytes to rows of cells: encodings, separators, archives, workbooks.

pub(crate) mod archive;
pub(crate) mod records;
pub(crate) mod source;
pub(crate) mod text;
pub(crate) mod workbook;
