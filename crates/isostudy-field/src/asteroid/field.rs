//! The asteroid as a field: by its formula, or by its tables where there are many samples.

use glam::Vec3;

use super::Asteroid;
use super::table::AsteroidTable;
use crate::{FieldCache, StudyField};

impl StudyField for Asteroid {
    fn sample(&self, p: Vec3) -> f32 {
        self.value(p)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        self.gradient_at(p)
    }

    /// With the hashes in tables, and bounds.
    fn prepared<'a>(&self, kept: &'a mut FieldCache) -> Option<&'a dyn StudyField> {
        let table =
            kept.get_or_make(|table: &AsteroidTable| table.is_of(self), || AsteroidTable::new(self))?;
        Some(table)
    }
}
