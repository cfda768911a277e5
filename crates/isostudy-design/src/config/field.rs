//! `field`: what an object's surface is taken from.

use serde::{Deserialize, Serialize};

/// A scalar field, and on which side of its isovalue the solid is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FieldSection {
    /// Radius minus distance from the origin.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// The paper's fractal-noise asteroid; it has no parameters.
    Asteroid {},
    /// Signed distance to a closed triangle mesh, positive inside: the file, or the first of the sources that is there.
    Mesh {
        /// One file, as it stands. OBJ, PLY or STL.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<String>,
        /// Files to try in turn.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        sources: Vec<MeshSourceSection>,
        /// Whether a mesh with holes is taken: inside is then what is seen from behind in most directions.
        #[serde(default, skip_serializing_if = "is_false")]
        allow_open: bool,
    },
    /// A formula in x, y and z.
    Formula {
        /// Such as `sqrt(x^2 + y^2 + z^2) - 1`.
        text: String,
        /// Which side of the isovalue is solid; below unless given, as of signed distances.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
        /// Whether the object's volume has walls, so that a surface that would leave it is closed.
        #[serde(default, skip_serializing_if = "is_false")]
        close: bool,
    },
    /// Samples of a regular grid.
    Volume {
        /// NRRD, MetaImage, or the TOML file that describes raw data.
        file: String,
        /// Which side of the isovalue is solid; above unless given, as of densities.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
        /// Whether the surface is closed where it leaves the samples, and the object's volume has walls.
        #[serde(default, skip_serializing_if = "is_false")]
        close: bool,
    },
    /// Values on the points of tetrahedra or other cells.
    Grid {
        /// VTK's `.vtu`, `.vts` or `.vtk`; TetGen's `.node` or `.ele`.
        file: String,
        /// The array of values, by its name; the only one unless given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        array: Option<String>,
        /// Which side of the isovalue is solid; above unless given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
    },
    /// Ground with hills, cliffs or caves: `character`, `seed` and what differs from the character. Whoever makes the field
    /// reads the keys.
    Terrain(toml::Table),
}

fn is_false(flag: &bool) -> bool {
    !flag
}

/// Which side of an isovalue is solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Inside {
    /// Values above it.
    Above,
    /// Values below it.
    Below,
}

/// A mesh file and how it is placed in the scene: `scale * axes(p) + offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshSourceSection {
    /// OBJ, PLY or STL file.
    pub file: String,
    /// The file's SHA-256 in hexadecimal; any other content is refused. Without it any content is taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// Which file axis becomes x, y and z, with sign: `["x", "-z", "y"]`.
    #[serde(default = "as_they_are")]
    pub axes: [String; 3],
    /// Scale factor.
    #[serde(default = "one")]
    pub scale: f64,
    /// Added after scaling.
    #[serde(default)]
    pub offset: [f64; 3],
}

impl MeshSourceSection {
    /// A file as it stands.
    pub fn plain(file: &str) -> Self {
        Self { file: file.into(), sha256: None, axes: as_they_are(), scale: one(), offset: [0.0; 3] }
    }
}

fn as_they_are() -> [String; 3] {
    ["x", "y", "z"].map(str::to_owned)
}

fn one() -> f64 {
    1.0
}

impl FieldSection {
    /// The files that a mesh is taken from, the first that is there; none for other fields.
    pub fn mesh_sources(&self) -> Vec<MeshSourceSection> {
        match self {
            Self::Mesh { file, sources, .. } => file
                .iter()
                .map(|file| MeshSourceSection::plain(file))
                .chain(sources.iter().cloned())
                .collect(),
            _ => Vec::new(),
        }
    }
}
