//! What can be done to a finished mesh, as plain data: read from a study file or a command line, checked, applied.

use crate::decimate::Decimate;
use crate::error::{FinishError, SettingError};
use crate::outcome::{Extent, Finished};
use crate::retile::{Density, Retile};
use crate::{coplanar, merge};
use isostudy_mesh::normals::area_weighted_normals;
use isostudy_mesh::{TriangleMesh, used_vertices};
use serde::{Deserialize, Serialize};

/// The most points that re-tile spreads.
pub const MOST_POINTS: u32 = 20_000_000;

/// One finishing step and its settings. Lengths are in the unit of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "step", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Step {
    /// Vertices close to each other are made one.
    MergeByDistance {
        /// How far a vertex moves at most; 0 makes those one that are at one point.
        tolerance: f64,
    },
    /// Flat regions are triangulated anew by their outlines alone.
    Coplanar {
        /// How far a vertex of a region may lie from its plane, and one of its outline from the new outline. 0 takes what single
        /// precision cannot tell from flat.
        #[serde(default)]
        tolerance: f64,
    },
    /// Edges are collapsed, those first that change the surface least.
    Decimate {
        /// Triangles to be left at most.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        triangles: Option<u64>,
        /// The same as a share of those that there are.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        ratio: Option<f64>,
        /// How far a vertex may lie from the planes that it stands for, as a root of the mean square over their area.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        error: Option<f64>,
        /// Whether vertices of borders stay where they are. Those of chunks always do.
        #[serde(default)]
        lock_borders: bool,
    },
    /// Points are spread over the surface and become its vertices.
    ReTile {
        /// How many vertices the mesh shall have.
        points: u64,
        /// Where they lie closer.
        #[serde(default)]
        by: Density,
        /// Seed of the first places.
        #[serde(default)]
        seed: u64,
    },
}

impl Step {
    /// The names of all steps.
    pub const NAMES: [&'static str; 4] = ["merge-by-distance", "coplanar", "decimate", "re-tile"];

    /// What `step = ...` calls it.
    pub fn name(&self) -> &'static str {
        let place = match self {
            Self::MergeByDistance { .. } => 0,
            Self::Coplanar { .. } => 1,
            Self::Decimate { .. } => 2,
            Self::ReTile { .. } => 3,
        };
        Self::NAMES[place]
    }

    /// Checks the settings.
    ///
    /// # Errors
    /// The first that is out of its range, with its key.
    pub fn check(&self) -> Result<(), SettingError> {
        match *self {
            Self::MergeByDistance { tolerance } | Self::Coplanar { tolerance } => {
                length("tolerance", tolerance)
            }
            Self::Decimate { triangles, ratio, error, .. } => {
                if triangles.is_none() && ratio.is_none() && error.is_none() {
                    return Err(SettingError::NoGoal);
                }
                if triangles.is_some() && ratio.is_some() {
                    return Err(SettingError::TwoGoals);
                }
                if let Some(value) = triangles.filter(|count| *count == 0) {
                    return Err(SettingError::Count {
                        key: "triangles",
                        value,
                        allowed: "at least 1".into(),
                    });
                }
                if let Some(value) = ratio.filter(|ratio| !(*ratio > 0.0 && *ratio <= 1.0)) {
                    return Err(SettingError::Range {
                        key: "ratio",
                        value,
                        allowed: "above 0 and at most 1",
                    });
                }
                error.map_or(Ok(()), |error| length("error", error))
            }
            Self::ReTile { points, .. } => {
                if (1..=u64::from(MOST_POINTS)).contains(&points) {
                    return Ok(());
                }
                let allowed = format!("from 1 to {MOST_POINTS}");
                Err(SettingError::Count { key: "points", value: points, allowed })
            }
        }
    }

    /// Checks that the step works on meshes of this extent.
    ///
    /// # Errors
    /// [`FinishError::Chunk`] if it does not.
    pub fn check_extent(&self, extent: Extent) -> Result<(), FinishError> {
        match (extent, self) {
            (Extent::Whole, _) | (_, Self::Decimate { .. }) => Ok(()),
            (Extent::Chunk, _) => Err(FinishError::Chunk { step: self.name() }),
        }
    }

    /// The mesh after this step. Triangles without area may be in it; vertices that no triangle uses are not, and triangles that repeat
    /// an index are left out of it. Each step says what else it keeps. If the mesh has normals, they are computed anew from the
    /// areas of triangles. A mesh without triangles stays as it is.
    ///
    /// # Errors
    /// If the settings are none, the mesh is not sound, or the step does not go with it.
    pub fn apply(&self, mesh: &TriangleMesh, extent: Extent) -> Result<Finished, FinishError> {
        self.check()?;
        self.check_extent(extent)?;
        if mesh.triangles.is_empty() {
            return Ok(Finished { mesh: mesh.clone(), stopped: Vec::new() });
        }
        used_vertices(mesh)?;
        let whole = |mesh| Finished { mesh, stopped: Vec::new() };
        let mut finished = match *self {
            Self::MergeByDistance { tolerance } => whole(merge::merge_by_distance(mesh, tolerance)),
            Self::Coplanar { tolerance } => whole(coplanar::coplanar(mesh, tolerance)),
            Self::Decimate { triangles, ratio, error, lock_borders } => {
                let count = mesh.triangles.len();
                // A chunk may have a triangle or two of a surface that is large elsewhere.
                let least = u64::from(extent == Extent::Chunk);
                let share = |ratio: f64| ((ratio * count as f64).floor() as u64).max(least);
                if let Some(ratio) = ratio.filter(|ratio| share(*ratio) == 0) {
                    return Err(FinishError::Nothing { ratio, triangles: count });
                }
                let triangles = triangles.or(ratio.map(share)).map(|count| count as usize);
                Decimate { triangles, error, lock_borders: lock_borders || extent == Extent::Chunk }.run(mesh)
            }
            Self::ReTile { points, by, seed } => Retile { points: points as usize, by, seed }.run(mesh)?,
        };
        if !mesh.normals.is_empty() {
            let TriangleMesh { positions, triangles, .. } = &finished.mesh;
            finished.mesh.normals = area_weighted_normals(positions, triangles);
        }
        Ok(finished)
    }
}

fn length(key: &'static str, value: f64) -> Result<(), SettingError> {
    if value >= 0.0 && value <= f64::from(isostudy_mesh::COORDINATE_LIMIT) {
        return Ok(());
    }
    Err(SettingError::Range { key, value, allowed: "a length from 0" })
}

/// The mesh after all of these steps, one after another, and what each could not do.
///
/// # Errors
/// As [`Step::apply`], of the first that cannot be applied.
pub fn finish(mesh: TriangleMesh, steps: &[Step], extent: Extent) -> Result<Finished, FinishError> {
    let mut whole = Finished { mesh, stopped: Vec::new() };
    for step in steps {
        let Finished { mesh, stopped } = step.apply(&whole.mesh, extent)?;
        whole.mesh = mesh;
        whole.stopped.extend(stopped);
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, icosphere, sheet};
    use isostudy_mesh::glam::Vec3;
    use isostudy_mesh::topology::topology;

    fn step(text: &str) -> Result<Step, String> {
        toml::from_str(text).map_err(|error| error.message().to_owned())
    }

    #[test]
    fn steps_are_read_from_a_file_and_written_back() {
        let decimate =
            |triangles, ratio, error, lock_borders| Step::Decimate { triangles, ratio, error, lock_borders };
        for (text, want) in [
            ("step = 'merge-by-distance'\ntolerance = 0.5", Step::MergeByDistance { tolerance: 0.5 }),
            ("step = 'coplanar'", Step::Coplanar { tolerance: 0.0 }),
            ("step = 'decimate'\nratio = 0.5", decimate(None, Some(0.5), None, false)),
            (
                "step = 'decimate'\ntriangles = 9\nerror = 1.0\nlock_borders = true",
                decimate(Some(9), None, Some(1.0), true),
            ),
            (
                "step = 're-tile'\npoints = 10\nby = 'curvature'",
                Step::ReTile { points: 10, by: Density::Curvature, seed: 0 },
            ),
        ] {
            let found = step(text).unwrap();
            assert_eq!(found, want);
            assert!(text.contains(found.name()));
            assert_eq!(step(&toml::to_string(&found).unwrap()), Ok(found));
            assert_eq!(found.check(), Ok(()));
        }
    }

    #[test]
    fn unknown_words_are_refused_with_those_that_are_known() {
        for (text, parts) in [
            ("step = 'decimat'\nratio = 0.5", vec!["decimat", "`decimate`", "`re-tile`", "`coplanar`"]),
            ("step = 'decimate'\nratios = 0.5", vec!["ratios", "`ratio`"]),
            ("step = 'merge-by-distance'", vec!["tolerance"]),
            ("step = 're-tile'\npoints = 5\nby = 'volume'", vec!["volume", "`area`", "`curvature`"]),
            ("tolerance = 0.1", vec!["step"]),
        ] {
            let error = step(text).unwrap_err();
            assert!(parts.iter().all(|part| error.contains(part)), "{error}");
        }
    }

    #[test]
    fn settings_out_of_their_range_are_named() {
        for (text, want) in [
            ("step = 'merge-by-distance'\ntolerance = -0.5", "tolerance = -0.5: must be a length from 0"),
            ("step = 'coplanar'\ntolerance = nan", "tolerance = NaN: must be a length from 0"),
            ("step = 'coplanar'\ntolerance = inf", "tolerance = inf: must be a length from 0"),
            ("step = 'decimate'\ntriangles = 0", "triangles = 0: must be at least 1"),
            ("step = 'decimate'\nratio = 0.0", "ratio = 0.0: must be above 0 and at most 1"),
            ("step = 'decimate'\nratio = 1.5", "ratio = 1.5: must be above 0 and at most 1"),
            ("step = 'decimate'\nratio = nan", "ratio = NaN: must be above 0 and at most 1"),
            ("step = 'decimate'\nerror = -1.0", "error = -1.0: must be a length from 0"),
            ("step = 'decimate'", "decimate needs one of triangles, ratio and error"),
            ("step = 'decimate'\ntriangles = 9\nratio = 0.5", "decimate takes triangles or ratio, not both"),
            ("step = 're-tile'\npoints = 0", "points = 0: must be from 1 to 20000000"),
            ("step = 're-tile'\npoints = 20000001", "points = 20000001: must be from 1 to 20000000"),
        ] {
            let found = step(text).unwrap();
            assert_eq!(found.check().unwrap_err().to_string(), want);
            assert!(matches!(found.apply(&cube(1), Extent::Whole), Err(FinishError::Setting(_))));
        }
    }

    #[test]
    fn a_share_is_of_the_triangles_that_are_there() {
        let mesh = icosphere(3);
        let half = Step::Decimate { triangles: None, ratio: Some(0.5), error: None, lock_borders: false };
        let found = half.apply(&mesh, Extent::Whole).unwrap();
        assert_eq!(found.mesh.triangles.len(), mesh.triangles.len() / 2);
        let least = Step::Decimate { triangles: None, ratio: Some(1e-9), error: None, lock_borders: false };
        let error = least.apply(&mesh, Extent::Whole).unwrap_err();
        assert_eq!(error.to_string(), "ratio = 1e-9 of 512 triangles is less than one triangle");
        // A chunk keeps what little it has.
        let mut corner = sheet(1);
        corner.triangles.truncate(1);
        assert_eq!(half.apply(&corner, Extent::Chunk).unwrap().mesh.triangles.len(), 1);
    }

    #[test]
    fn what_cannot_be_computed_with_is_refused_and_nothing_stays_nothing() {
        let coplanar = Step::Coplanar { tolerance: 0.0 };
        let mut mesh = cube(2);
        mesh.positions[3].y = f32::NAN;
        let error = coplanar.apply(&mesh, Extent::Whole).unwrap_err();
        assert!(error.to_string().contains("vertex 3"), "{error}");
        mesh.triangles.push([0, 1, 99]);
        let error = coplanar.apply(&mesh, Extent::Whole).unwrap_err();
        assert!(error.to_string().contains("triangle 48 refers to vertex 99"), "{error}");
        let nothing = TriangleMesh::default();
        assert_eq!(coplanar.apply(&nothing, Extent::Whole).unwrap().mesh, nothing);
    }

    #[test]
    fn only_decimate_works_on_chunks_and_keeps_their_borders() {
        let mesh = sheet(8);
        let border = |mesh: &TriangleMesh| topology(mesh).boundary_edges;
        let half = Step::Decimate { triangles: Some(40), ratio: None, error: None, lock_borders: false };
        assert_eq!(border(&half.apply(&mesh, Extent::Chunk).unwrap().mesh), 32);
        assert!(border(&half.apply(&mesh, Extent::Whole).unwrap().mesh) < 32);
        for other in [
            Step::MergeByDistance { tolerance: 0.0 },
            Step::Coplanar { tolerance: 0.0 },
            Step::ReTile { points: 90, by: Density::Area, seed: 0 },
        ] {
            assert_eq!(other.apply(&mesh, Extent::Chunk), Err(FinishError::Chunk { step: other.name() }));
        }
    }

    #[test]
    fn steps_follow_each_other_and_normals_are_made_anew() {
        let mut mesh = cube(4);
        mesh.normals = vec![Vec3::X; mesh.positions.len()];
        let too_few = Step::Decimate { triangles: Some(2), ratio: None, error: None, lock_borders: false };
        let steps = [Step::Coplanar { tolerance: 0.0 }, too_few];
        let Finished { mesh: found, stopped } = finish(mesh, &steps, Extent::Whole).unwrap();
        assert_eq!((found.triangles.len(), found.normals.len()), (4, 4));
        assert_eq!(found.normals, area_weighted_normals(&found.positions, &found.triangles));
        let [at] = stopped[..] else { panic!("{stopped:?}") };
        assert_eq!((at.step, at.left), ("decimate", 2));
        assert!(at.to_string().starts_with("decimate: stopped with 2 triangles too many"), "{at}");
    }
}
