//! What can go wrong, one enum a stage.

/// Why nothing could be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RasterError {
    /// A setting of the turntable, camera or viewport is outside its range.
    #[error("{setting} is {value}, allowed is {allowed}")]
    Setting {
        /// The field's name.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// The range that would do.
        allowed: &'static str,
    },
    /// A used vertex has a position or normal that is NaN or infinite.
    #[error("vertex {vertex} has a {part} that is not finite")]
    NotFinite {
        /// Index into the mesh's positions.
        vertex: usize,
        /// `"position"` or `"normal"`.
        part: &'static str,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {vertex} of {vertices}")]
    NoSuchVertex {
        /// Index into the mesh's triangles.
        triangle: usize,
        /// The index it holds.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A smooth look needs one normal a vertex.
    #[error("the mesh has {normals} normals for {vertices} vertices")]
    Normals {
        /// Number of normals.
        normals: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// Numbers that colour a mesh are not one for each of its parts.
    #[error("{values} numbers to colour the mesh, one for each {of} are {count}")]
    Values {
        /// Numbers that were given.
        values: usize,
        /// `"triangle"` or `"vertex"`.
        of: &'static str,
        /// How many the mesh has.
        count: usize,
    },
    /// A number that colours a mesh is NaN.
    #[error("{of} {index} has no number to colour it")]
    NoNumber {
        /// `"triangle"` or `"vertex"`.
        of: &'static str,
        /// Which of them.
        index: usize,
    },
}

/// Why an animation could not be put together, read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// Two halves of a pair do not fit.
    #[error("the halves differ in {what}: {left} against {right}")]
    Mismatch {
        /// What differs: a side, the number of frames, the delay, the palette.
        what: &'static str,
        /// The left half's value.
        left: u64,
        /// The right half's value.
        right: u64,
    },
    /// More pixels on a side than a GIF can say.
    #[error("{pixels} pixels on a side, a GIF allows 1 to 65535")]
    Size {
        /// Offending width or height.
        pixels: u64,
    },
    /// The file is a GIF, yet not one that [`Animation::write_gif`](crate::Animation::write_gif) writes.
    #[error("not a turntable of ours: {reason}{}", frame.map_or(String::new(), |f| format!(" (frame {f})")))]
    Foreign {
        /// What is unlike our files.
        reason: &'static str,
        /// Where, when it concerns one frame.
        frame: Option<usize>,
    },
    /// Reading failed.
    #[error("cannot read the GIF")]
    Decode(#[from] gif::DecodingError),
    /// Writing failed.
    #[error("cannot write the GIF")]
    Encode(#[from] gif::EncodingError),
}

/// Why a picture or film from elsewhere could not be read, put beside another or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// There is no frame.
    #[error("has no picture")]
    Empty,
    /// It is larger than it may be.
    #[error("is larger than {most}")]
    Large {
        /// The limit, in bytes or pixels.
        most: u64,
    },
    /// Two do not go side by side.
    #[error("{what}: {own} and {other}")]
    Mismatch {
        /// What differs.
        what: &'static str,
        /// The first one's.
        own: usize,
        /// The other's.
        other: usize,
    },
    /// The file is none of its kind, or is damaged.
    #[error("cannot be read")]
    Image(#[from] image::ImageError),
    /// Writing failed.
    #[error("cannot write the GIF")]
    Encode(#[from] gif::EncodingError),
}

/// Why a sheet or picture file could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PanelError {
    /// There is nothing to put on the sheet, or no column to put it in.
    #[error("{panels} panels in {columns} columns")]
    Empty {
        /// Number of panels.
        panels: usize,
        /// Number of columns.
        columns: usize,
    },
    /// The sheet would be larger than a picture can be.
    #[error("a sheet of {width} x {height} pixels is too large")]
    TooLarge {
        /// Pixels.
        width: u64,
        /// Pixels.
        height: u64,
    },
    /// The PNG coder refused.
    #[error("PNG")]
    Png(#[from] image::ImageError),
}
