//! The meshes of one purpose, in the study's order.

use crate::inputs::Inputs;
use isostudy_design::record::{Distribution, MeshRecord, Purpose, TetrahedraCounts};
use isostudy_design::{Configuration, ConfigurationId, MethodId, Study};

/// The records of one purpose, found by configuration.
#[derive(Debug, Clone)]
pub struct MeshSet<'a> {
    study: &'a Study,
    records: Vec<&'a MeshRecord>,
}

impl<'a> MeshSet<'a> {
    /// The meshes of a purpose.
    pub fn of(inputs: &Inputs<'a>, purpose: Purpose) -> Self {
        let records = inputs.meshes.iter().filter(|mesh| mesh.purpose == purpose).collect();
        Self { study: inputs.study, records }
    }

    /// The record of a configuration.
    pub fn get(&self, id: &ConfigurationId) -> Option<&'a MeshRecord> {
        self.records.iter().copied().find(|mesh| mesh.id == *id)
    }

    /// The record of an object, by index, and a method.
    pub fn at(&self, object: usize, method: MethodId) -> Option<&'a MeshRecord> {
        self.get(&ConfigurationId { object: self.study.file.objects[object].id.clone(), method })
    }

    /// Configurations that have a record, in the study's order.
    pub fn in_order(&self) -> impl Iterator<Item = (&'a Configuration, &'a MeshRecord)> {
        self.study.configurations.iter().filter_map(|c| self.get(&c.id).map(|mesh| (c, mesh)))
    }

    /// Whether no configuration has a record.
    pub fn is_empty(&self) -> bool {
        self.in_order().next().is_none()
    }
}

/// A statistic of a distribution; `None` of nothing, whose statistics are written as 0.
pub fn known(of: &Distribution, statistic: fn(&Distribution) -> f64) -> Option<f64> {
    (of.count > 0).then(|| statistic(of))
}

/// The share of triangles that merging discarded, `discarded / (discarded + kept)`, in 0..=1; 0 of none.
pub fn discard_fraction(discarded: u64, kept: u64) -> f64 {
    if discarded == 0 { 0.0 } else { discarded as f64 / (discarded + kept) as f64 }
}

/// A count that only tetrahedra have; not a number of another method.
pub fn of_tetrahedra(mesh: &MeshRecord, count: fn(&TetrahedraCounts) -> u64) -> f64 {
    mesh.counts.of_tetrahedra(count).map_or(f64::NAN, |count| count as f64)
}

/// The true share of triangles that merging took away; not a number where it is not known.
pub fn discarded(mesh: &MeshRecord) -> f64 {
    let count = mesh.counts.discarded_triangles;
    count.map_or(f64::NAN, |count| discard_fraction(count, mesh.counts.triangles))
}

/// The same as the published count comes to.
pub fn discarded_as_published(mesh: &MeshRecord) -> f64 {
    let count = mesh.counts.of_tetrahedra(|t| t.discarded_as_published);
    count.map_or(f64::NAN, |count| discard_fraction(count, mesh.counts.triangles))
}
