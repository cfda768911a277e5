//! What things are called in a sentence.

use crate::statistics::contrast::{Level, Over};
use design::{Arrangement, Clustering, Study};

/// A level as a noun: `edge collapse`, `the body-centred lattice`.
pub(super) fn level(level: Level) -> &'static str {
    match level {
        Level::Arrangement(Arrangement::BodyCentred) => "the body-centred lattice",
        Level::Arrangement(Arrangement::SimpleCubic) => "the simple cubic lattice",
        Level::Arrangement(Arrangement::FiveTetrahedra) => "the lattice of five tetrahedra a cube",
        Level::Arrangement(Arrangement::FaceCentred) => "the face-centred lattice",
        Level::Clustering(Clustering::None) => "no clustering",
        Level::Clustering(Clustering::Integrated) => "integrated clustering",
        Level::Clustering(Clustering::EdgeCollapse) => "edge collapse",
        Level::Clustering(Clustering::IntegratedCollapse) => "integrated clustering with collapse",
    }
}

/// Where, with a space before it: ` on the body-centred lattice`, ` without clustering`.
pub(super) fn within(level: Level) -> String {
    match level {
        Level::Clustering(Clustering::None) => " without clustering".into(),
        Level::Clustering(_) => format!(" with {}", self::level(level)),
        Level::Arrangement(_) => format!(" on {}", self::level(level)),
    }
}

/// The answers that a contrast goes over, with a space before it; nothing for all of them.
pub(super) fn over(study: &Study, over: Over) -> String {
    match over {
        Over::All => String::new(),
        Over::Within(level) => within(level),
        Over::Object(object) => format!(" on the {}", study.file.objects[object].name),
        Over::Difference(a, b) => format!(",{} rather than{}", within(a), within(b)),
        Over::AgainstOthers(object) => {
            format!(", on the {} rather than elsewhere", study.file.objects[object].name)
        }
    }
}
