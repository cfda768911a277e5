//! Grids in files, as somebody names them.

use crate::memory::Limit;
use crate::terminal::{counted, grouped, tell_once};
use anyhow::{Error, Result};
use isostudy_design::wording::did_you_mean;
use isostudy_grid::{Grid, GridError, Problem};
use std::path::Path;

/// A grid with one of its arrays. What is odd in it is said on standard error.
///
/// # Errors
/// If it cannot be read, or has no such array; then with the one that was meant.
pub(crate) fn read(path: &Path, array: Option<&str>, limit: Limit) -> Result<Grid> {
    let grid = isostudy_grid::read(path, array, limit.bytes).map_err(with_the_meant)?;
    let (cells, odd, name) = (grid.cells(), grid.oddities(), path.display());
    for (count, what, so) in [
        (cells.turned, "cell wound against the others", "turned round"),
        (cells.without_volume, "cell without volume", "wound as its neighbours are"),
        (odd.folded, "tetrahedron inside out, of a cell that is not convex", "the surface may fold there"),
        (odd.without_value, "tetrahedron with a value that is not finite", "no surface goes through it"),
        (odd.twice, "point at the place of an earlier one", "cells on different points do not hang together"),
    ] {
        if count > 0 {
            tell_once(&format!("{name}: {}: {so}", several(count, what)));
        }
    }
    Ok(grid)
}

/// A number of things, whose first word is one that has a plural.
fn several(count: u64, what: &str) -> String {
    let (noun, rest) = what.split_once(' ').unwrap_or((what, ""));
    let noun = match (noun, count) {
        ("tetrahedron", 2..) => format!("{} tetrahedra", grouped(count)),
        _ => counted(count, noun),
    };
    format!("{noun} {rest}")
}

/// The error, with the name of the array that was meant.
fn with_the_meant(error: GridError) -> Error {
    let meant = match &*error.problem {
        Problem::NoArray { asked, arrays } => did_you_mean(asked, arrays.iter().map(String::as_str)),
        _ => String::new(),
    };
    match meant.as_str() {
        "" => error.into(),
        meant => Error::msg(format!("{error}{meant}")),
    }
}
