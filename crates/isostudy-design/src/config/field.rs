//! `field`: what an object's surface is taken from.

use serde::{Deserialize, Serialize};

use super::whole;

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
    /// A spline through points with normals, as of a scan: 0 at the points, positive inside.
    Points {
        /// PLY, XYZ or OBJ.
        file: String,
        /// Where normals come from.
        #[serde(default, skip_serializing_if = "is_default")]
        normals: PointNormals,
        /// How a centre of the spline acts at a distance.
        #[serde(default, skip_serializing_if = "is_default")]
        kernel: PointKernel,
        /// How far beside the surface values are given, in the unit of coordinates; twice the median distance between neighbours unless
        /// given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        offset: Option<f64>,
        /// Above 0 the surface passes by the points and is smoother. In the unit of the kernel.
        #[serde(default, skip_serializing_if = "is_default")]
        smoothing: f64,
        /// The most centres: of more places with a value, those are chosen where the error is largest.
        #[serde(default = "usual_centres", skip_serializing_if = "is_usual", deserialize_with = "whole")]
        centres: u32,
        /// Which side is solid; above unless given, where no normal points.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
        /// Whether the object's volume has walls, so that a surface that would leave it is closed.
        #[serde(default, skip_serializing_if = "is_false")]
        close: bool,
    },
    /// The mean of signed distances to the planes of triangles, which need not hang together, by nearness: positive inside.
    Soup {
        /// OBJ, PLY or STL.
        file: String,
        /// The distance that the weight is rounded off by, in the unit of coordinates; 1 % of the diagonal of the triangles' box unless
        /// given. With 0 the surface goes through the triangles.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        epsilon: Option<f64>,
        /// Which side is solid; above unless given, behind the triangles.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
        /// Whether the object's volume has walls, so that a surface that would leave it is closed.
        #[serde(default, skip_serializing_if = "is_false")]
        close: bool,
    },
    /// None: the object is shown from the files of `[[stimuli.files]]`. Nobody writes it; it is what an object without a field has.
    #[serde(skip_deserializing)]
    Files {},
    /// Ground with hills, cliffs or caves: `character`, `seed` and what differs from the character. Whoever makes the field
    /// reads the keys.
    Terrain(toml::Table),
}

fn is_false(flag: &bool) -> bool {
    !flag
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn usual_centres() -> u32 {
    3000
}

fn is_usual(centres: &u32) -> bool {
    *centres == usual_centres()
}

/// Where the normals of points come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointNormals {
    /// From the file.
    #[default]
    Given,
    /// From the planes of neighbours.
    Estimated,
}

/// How a centre of a spline acts at a distance `r`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointKernel {
    /// As `-r`.
    #[default]
    Biharmonic,
    /// As `r^3`.
    Triharmonic,
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
