//! Which of a file's arrays is asked for.

use crate::error::{Problem, shortened};

/// An array of values, on points or on cells, by what a file says of it.
pub(crate) struct Named<T> {
    pub(crate) name: String,
    pub(crate) components: usize,
    /// Where its numbers are.
    pub(crate) data: T,
}

/// Chooses an array on points: the one that is named, or the only one with a number per point.
///
/// # Errors
/// If there is none of the name, with those that there are; if it is on cells, or has several numbers per point.
pub(crate) fn choose<'a, T>(
    asked: Option<&str>,
    on_points: &'a [Named<T>],
    on_cells: &[String],
) -> Result<&'a Named<T>, Problem> {
    let arrays = || on_points.iter().map(|array| array.name.clone()).collect::<Vec<_>>();
    let Some(asked) = asked else {
        let mut scalars = on_points.iter().filter(|array| array.components == 1);
        return match (scalars.next(), scalars.next()) {
            (Some(only), None) => Ok(only),
            _ => Err(Problem::NotNamed { arrays: arrays() }),
        };
    };
    match on_points.iter().find(|array| array.name == asked) {
        Some(found) if found.components == 1 => Ok(found),
        Some(found) => Err(Problem::NotScalar { name: shortened(&found.name), components: found.components }),
        None if on_cells.iter().any(|name| name == asked) => {
            Err(Problem::OnCells { name: shortened(asked), arrays: arrays() })
        }
        None => Err(Problem::NoArray { asked: shortened(asked), arrays: arrays() }),
    }
}
