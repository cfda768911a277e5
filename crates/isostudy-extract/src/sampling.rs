//! Which samples are needed, which side of the isovalue they are on, and the field's own surface between them.

pub(crate) mod bits;
pub(crate) mod bracket;
pub(crate) mod in_sight;
pub(crate) mod level;
pub(crate) mod line;
pub(crate) mod rows;
pub(crate) mod tiles;
