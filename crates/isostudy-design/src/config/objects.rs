//! `[[objects]]`: whose surfaces are extracted, and where.

use super::field::FieldSection;
use crate::check::{Checker, ConfigError, short};
use serde::{Deserialize, Serialize};

/// One object of the study.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "ObjectKeys")]
pub struct ObjectSection {
    /// Short id, the first half of a configuration's id.
    pub id: String,
    /// Name in tables and figures.
    pub name: String,
    /// The scalar field.
    pub field: FieldSection,
    /// Value at which the surface lies; inside is above it.
    pub isovalue: f64,
    /// Smallest corner of the sampled volume.
    pub min: [f64; 3],
    /// Largest corner of the sampled volume.
    pub max: [f64; 3],
    /// Cube edge in the benchmark.
    pub benchmark_spacing: f64,
    /// Cube edge of the meshes in the animations.
    pub stimulus_spacing: f64,
    /// The camera for this object.
    pub camera: CameraSection,
    /// The part of the surface that is judged; the whole of it if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionSection>,
}

/// The keys of an object, as they are written. One that is shown from files alone has none but its names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectKeys {
    id: String,
    name: String,
    field: Option<FieldSection>,
    isovalue: Option<f64>,
    min: Option<[f64; 3]>,
    max: Option<[f64; 3]>,
    benchmark_spacing: Option<f64>,
    stimulus_spacing: Option<f64>,
    camera: Option<CameraSection>,
    region: Option<RegionSection>,
}

impl TryFrom<ObjectKeys> for ObjectSection {
    type Error = String;

    fn try_from(keys: ObjectKeys) -> Result<Self, String> {
        let has_volume = keys.isovalue.is_some()
            || keys.min.is_some()
            || keys.max.is_some()
            || keys.benchmark_spacing.is_some()
            || keys.stimulus_spacing.is_some()
            || keys.camera.is_some()
            || keys.region.is_some();
        let ObjectKeys { id, name, field, region, .. } = keys;
        if field.is_none() && !has_volume {
            return Ok(Self::of_files(id, name));
        }
        let missing = |key: &str| format!("missing field `{key}`");
        Ok(Self {
            id,
            name,
            field: field.ok_or_else(|| missing("field"))?,
            isovalue: keys.isovalue.ok_or_else(|| missing("isovalue"))?,
            min: keys.min.ok_or_else(|| missing("min"))?,
            max: keys.max.ok_or_else(|| missing("max"))?,
            benchmark_spacing: keys.benchmark_spacing.ok_or_else(|| missing("benchmark_spacing"))?,
            stimulus_spacing: keys.stimulus_spacing.ok_or_else(|| missing("stimulus_spacing"))?,
            camera: keys.camera.ok_or_else(|| missing("camera"))?,
            region,
        })
    }
}

impl ObjectSection {
    /// One that is shown from files alone: a ball of radius 1 holds whatever is drawn of it.
    fn of_files(id: String, name: String) -> Self {
        Self {
            id,
            name,
            field: FieldSection::Files {},
            isovalue: 0.0,
            min: [-1.0; 3],
            max: [1.0; 3],
            benchmark_spacing: 1.0,
            stimulus_spacing: 1.0,
            camera: CameraSection { distance: 2.0, vertical_fov_rad: 0.8, middle_z: 0.0 },
            region: None,
        }
    }
}

/// A box in which an object's surface is judged: measures of meshes are given for it alone, beside those of the whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionSection {
    /// What it is called in headings and captions: `of the NAME alone`.
    pub name: String,
    /// Smallest corner.
    pub min: [f64; 3],
    /// Largest corner.
    pub max: [f64; 3],
}

/// The camera for one object.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraSection {
    /// The paper's distance parameter D; the eye is about 1.323 D from the middle of the picture.
    pub distance: f64,
    /// Vertical field of view in radians.
    pub vertical_fov_rad: f64,
    /// How high over the origin the middle of the picture lies. One that is left out is not written: digests stay as they are.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub middle_z: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// What may stand in the sections of objects.
pub(crate) fn check_objects(c: &Checker<'_>, objects: &[ObjectSection]) -> Result<(), ConfigError> {
    if objects.is_empty() {
        return c.refuse("objects", "[]", "must list at least one object");
    }
    let ids: Vec<String> = objects.iter().map(|o| o.id.clone()).collect();
    c.distinct(|i| format!("objects[{i}].id"), &ids)?;
    for (i, object) in objects.iter().enumerate() {
        let key = |name: &str| format!("objects[{i}].{name}");
        if object.id.is_empty() || !object.id.bytes().all(|b| b.is_ascii_alphanumeric()) {
            return c.refuse(key("id"), &object.id, "must be letters and digits");
        }
        c.number(&key("isovalue"), object.isovalue, -1e9, 1e9)?;
        c.numbers(&key("min"), &object.min, -1e6, 1e6)?;
        c.numbers(&key("max"), &object.max, -1e6, 1e6)?;
        for axis in 0..3 {
            let (min, max) = (object.min[axis], object.max[axis]);
            // Volumes are single precision.
            if max as f32 <= min as f32 {
                let by = if max > min { " by more than single precision loses" } else { "" };
                let limit = format!("must be above {} = {}{by}", key("min"), short(min));
                return c.refuse(format!("{}[{axis}]", key("max")), short(max), limit);
            }
        }
        c.length(&key("benchmark_spacing"), object.benchmark_spacing, 1e6)?;
        c.length(&key("stimulus_spacing"), object.stimulus_spacing, 1e6)?;
        c.positive(&key("camera.distance"), object.camera.distance, 1e6)?;
        c.number(&key("camera.middle_z"), object.camera.middle_z, -1e6, 1e6)?;
        c.number(&key("camera.vertical_fov_rad"), object.camera.vertical_fov_rad, 0.01, 3.1)?;
        if let Some(region) = &object.region {
            check_region(c, &key("region"), object, region)?;
        }
        check_field(c, &key("field"), &object.field)?;
    }
    Ok(())
}

/// A region is a box that meets the object's volume.
fn check_region(
    c: &Checker<'_>,
    key: &str,
    object: &ObjectSection,
    region: &RegionSection,
) -> Result<(), ConfigError> {
    if region.name.trim().is_empty() {
        return c.refuse(format!("{key}.name"), &region.name, "must be a name");
    }
    c.numbers(&format!("{key}.min"), &region.min, -1e6, 1e6)?;
    c.numbers(&format!("{key}.max"), &region.max, -1e6, 1e6)?;
    for axis in 0..3 {
        let (min, max) = (region.min[axis], region.max[axis]);
        if max as f32 <= min as f32 {
            let limit = format!("must be above {key}.min = {}", short(min));
            return c.refuse(format!("{key}.max[{axis}]"), short(max), limit);
        }
        let volume = [object.min[axis], object.max[axis]];
        if max <= volume[0] || min >= volume[1] {
            let limit =
                format!("must meet the object's volume, {} to {}", short(volume[0]), short(volume[1]));
            return c.refuse(format!("{key}.max[{axis}]"), short(max), limit);
        }
    }
    Ok(())
}

fn check_field(c: &Checker<'_>, key: &str, field: &FieldSection) -> Result<(), ConfigError> {
    match field {
        FieldSection::Sphere { radius } => c.length(&format!("{key}.radius"), *radius, 1e6),
        FieldSection::Asteroid {} => Ok(()),
        FieldSection::Mesh { file, sources, .. } => {
            for (i, source) in sources.iter().enumerate() {
                let key = |name: &str| format!("{key}.sources[{i}].{name}");
                let mut letters: Vec<&str> =
                    source.axes.iter().map(|axis| axis.strip_prefix('-').unwrap_or(axis)).collect();
                letters.sort_unstable();
                if letters != ["x", "y", "z"] {
                    let limit = "must name x, y and z once each, with an optional minus";
                    return c.refuse(key("axes"), format!("{:?}", source.axes), limit);
                }
                if let Some(digest) = &source.sha256
                    && (digest.len() != 64 || !digest.bytes().all(|b| b.is_ascii_hexdigit()))
                {
                    return c.refuse(key("sha256"), digest, "must be 64 hexadecimal digits");
                }
                c.positive(&key("scale"), source.scale, 1e6)?;
                c.numbers(&key("offset"), &source.offset, -1e6, 1e6)?;
            }
            // Whether one is there matters only to those who make meshes: a design is judged without.
            match (file, sources.is_empty()) {
                (None, true) => {
                    c.refuse(format!("{key}.file"), "nothing", "must name a file, or list sources")
                }
                (Some(file), false) => c.refuse(format!("{key}.file"), file, "goes without sources"),
                _ => Ok(()),
            }
        }
        FieldSection::Formula { text, .. } => {
            c.text(&format!("{key}.text"), text, "must be a formula in x, y and z")
        }
        FieldSection::Volume { file, .. } | FieldSection::Grid { file, .. } => {
            c.text(&format!("{key}.file"), file, "must name a file")
        }
        FieldSection::Points { file, offset, smoothing, centres, .. } => {
            c.text(&format!("{key}.file"), file, "must name a file")?;
            if let Some(offset) = offset {
                c.length(&format!("{key}.offset"), *offset, 1e6)?;
            }
            c.number(&format!("{key}.smoothing"), *smoothing, 0.0, 1e6)?;
            c.count(&format!("{key}.centres"), *centres, 4, 10_000)
        }
        FieldSection::Soup { file, epsilon, .. } => {
            c.text(&format!("{key}.file"), file, "must name a file")?;
            epsilon.map_or(Ok(()), |epsilon| c.number(&format!("{key}.epsilon"), epsilon, 0.0, 1e6))
        }
        FieldSection::Terrain(_) | FieldSection::Files {} => Ok(()),
    }
}
