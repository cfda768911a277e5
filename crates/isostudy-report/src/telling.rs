//! Where methods differ most: the object and the pair of methods that pages show first.

use isostudy_design::record::{MeshRecord, Purpose};
use isostudy_design::{ConfigurationId, Study};

/// An object and two methods on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Telling {
    /// The object's place among the study's.
    pub object: usize,
    /// The mesh that lies nearest to the isosurface, and the one that lies farthest from it.
    pub pair: [ConfigurationId; 2],
}

/// The object whose meshes differ most in their mean distance to the isosurface, and the two between which they do. Distances are
/// in the spacing of the object's animations, so that a large object does not win by its size, nor one method by a finer mesh. The
/// rule needs no answers, so a study opens on the same pair before people answer and after. Meshes of the animations alone count,
/// since they are what is looked at, and of them those of methods that are not set apart. `None` of fewer than two meshes that differ.
pub fn telling(study: &Study, meshes: &[MeshRecord]) -> Option<Telling> {
    let of_object = |(place, object): (usize, &isostudy_design::config::ObjectSection)| {
        // What no choice names would win by what sets it apart.
        let is_compared = |id: &ConfigurationId| study.method(id.method).apart.is_none();
        let own = |mesh: &&MeshRecord| {
            mesh.purpose == Purpose::Stimulus && mesh.id.object == object.id && is_compared(&mesh.id)
        };
        let mut own: Vec<(f64, &ConfigurationId)> = meshes
            .iter()
            .filter(own)
            .map(|mesh| (mesh.judged().accuracy.distance.mean / object.stimulus_spacing, &mesh.id))
            .filter(|(distance, _)| distance.is_finite())
            .collect();
        // The earlier one of the study's of two that are equal.
        let rank = |id: &ConfigurationId| study.place(id.method);
        own.sort_by(|a, b| a.0.total_cmp(&b.0).then(rank(a.1).cmp(&rank(b.1))));
        let (near, far) = (*own.first()?, *own.iter().find(|of| of.0 == own[own.len() - 1].0)?);
        let telling = Telling { object: place, pair: [near.1.clone(), far.1.clone()] };
        (far.0 > near.0).then_some((far.0 - near.0, telling))
    };
    let all = study.file.objects.iter().enumerate().filter_map(of_object);
    let most = all.reduce(|most, other| if other.0 > most.0 { other } else { most });
    most.map(|(_, telling)| telling)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{self, Everything};

    fn with_distances(distances: &[(&str, f64)]) -> Option<Telling> {
        with_distances_in(&fixture::study(), distances)
    }

    fn with_distances_in(study: &Study, distances: &[(&str, f64)]) -> Option<Telling> {
        let all = Everything::of(fixture::study());
        let mut meshes = all.meshes.clone();
        for mesh in meshes.iter_mut().filter(|mesh| mesh.purpose == Purpose::Stimulus) {
            let known = distances.iter().find(|(id, _)| mesh.id.to_string() == *id);
            mesh.accuracy.distance.mean = known.map_or(0.01, |(_, distance)| *distance);
        }
        telling(study, &meshes)
    }

    #[test]
    fn it_is_the_nearest_and_the_farthest_of_the_object_where_they_are_farthest_apart() {
        let spacing = |place: usize| fixture::study().file.objects[place].stimulus_spacing;
        let object = |place: usize| fixture::study().file.objects[place].id.clone();
        let id = |place: usize, method: &str| format!("{}_{method}", object(place));
        let found = with_distances(&[
            (&id(1, "su"), 0.01 + 0.5 * spacing(1)),
            (&id(2, "bp"), 0.01 + 0.4 * spacing(2)),
        ]);
        let found = found.expect("meshes differ");
        assert_eq!(found.object, 1);
        // Of those that are equally near, the study's first.
        assert_eq!(found.pair.map(|id| id.to_string()), [id(1, "bu"), id(1, "su")]);
    }

    #[test]
    fn a_method_that_is_set_apart_is_not_shown_first() {
        let mut study = fixture::study();
        let object = study.file.objects[1].id.clone();
        let [far, next] = ["su", "bp"].map(|method| format!("{object}_{method}"));
        let distances = [(&far[..], 0.9), (&next[..], 0.5)];
        let farthest = |study: &Study| with_distances_in(study, &distances).map(|of| of.pair[1].to_string());
        assert_eq!(farthest(&study), Some(far.clone()));
        let apart = study.methods.iter_mut().find(|method| method.id.to_string() == "su");
        apart.expect("the paper's").apart = Some("it is given labels alone".into());
        assert_eq!(farthest(&study), Some(next));
    }

    #[test]
    fn where_all_are_alike_none_is_telling() {
        assert_eq!(with_distances(&[]), None);
    }
}
