//! The short form of a study's methods: arrangements crossed with clusterings. Costen's (2026) letters live here.

use super::{FactorSpec, LevelSpec, Method, MethodId, Recipe, TETRAHEDRA};
use serde::{Deserialize, Serialize};

/// How sample points are laid out in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arrangement {
    /// Body-centred cubic: two interleaved cubic grids. Code `b`.
    BodyCentred,
    /// Simple cubic: one cubic grid. Code `s`.
    SimpleCubic,
    /// One cubic grid with five tetrahedra per cube, neighbours mirrored. Code `m`; not in the paper.
    FiveTetrahedra,
    /// Cube corners, face centres and cube centres, 24 tetrahedra per cube. Code `f`; not in the paper.
    FaceCentred,
}

/// How the vertices round a sample point are merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clustering {
    /// No merging: plain marching tetrahedra. Code `u`.
    None,
    /// Merging inside the vertex stage. Code `i`.
    Integrated,
    /// Short edges collapsed after extraction. Code `p`.
    EdgeCollapse,
    /// Merging inside the vertex stage, then short edges collapsed. Code `c`; not in the paper.
    IntegratedCollapse,
}

impl Arrangement {
    const ALL: [Self; 4] = [Self::BodyCentred, Self::SimpleCubic, Self::FiveTetrahedra, Self::FaceCentred];

    /// The paper's one-letter code, and two more.
    pub fn code(self) -> char {
        match self {
            Self::BodyCentred => 'b',
            Self::SimpleCubic => 's',
            Self::FiveTetrahedra => 'm',
            Self::FaceCentred => 'f',
        }
    }

    /// Whether there is such a clustering for it: integrated clustering is for the paper's two.
    pub fn supports(self, clustering: Clustering) -> bool {
        match (self, clustering) {
            (Self::BodyCentred | Self::SimpleCubic, _) => true,
            (Self::FiveTetrahedra | Self::FaceCentred, Clustering::None | Clustering::EdgeCollapse) => true,
            (
                Self::FiveTetrahedra | Self::FaceCentred,
                Clustering::Integrated | Clustering::IntegratedCollapse,
            ) => false,
        }
    }

    /// The name used in tables and figures.
    pub fn label(self) -> &'static str {
        match self {
            Self::BodyCentred => "body-centred",
            Self::SimpleCubic => "simple cubic",
            Self::FiveTetrahedra => "five tetrahedra",
            Self::FaceCentred => "face-centred",
        }
    }

    /// The name in study files.
    fn key(self) -> &'static str {
        match self {
            Self::BodyCentred => "body-centred",
            Self::SimpleCubic => "simple-cubic",
            Self::FiveTetrahedra => "five-tetrahedra",
            Self::FaceCentred => "face-centred",
        }
    }

    /// The name used in sentences.
    pub fn phrase(self) -> &'static str {
        match self {
            Self::BodyCentred => "the body-centred lattice",
            Self::SimpleCubic => "the simple cubic lattice",
            Self::FiveTetrahedra => "the lattice of five tetrahedra a cube",
            Self::FaceCentred => "the face-centred lattice",
        }
    }
}

impl Clustering {
    const ALL: [Self; 4] = [Self::None, Self::Integrated, Self::EdgeCollapse, Self::IntegratedCollapse];

    /// The paper's one-letter code, and one more.
    pub fn code(self) -> char {
        match self {
            Self::None => 'u',
            Self::Integrated => 'i',
            Self::EdgeCollapse => 'p',
            Self::IntegratedCollapse => 'c',
        }
    }

    /// The name used in tables and figures.
    pub fn label(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Integrated => "integrated",
            Self::EdgeCollapse => "edge collapse",
            Self::IntegratedCollapse => "integrated + collapse",
        }
    }

    /// The name in study files.
    fn key(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Integrated => "integrated",
            Self::EdgeCollapse => "edge-collapse",
            Self::IntegratedCollapse => "integrated-collapse",
        }
    }

    fn phrase(self) -> &'static str {
        match self {
            Self::None => "no clustering",
            Self::Integrated => "integrated clustering",
            Self::EdgeCollapse => "edge collapse",
            Self::IntegratedCollapse => "integrated clustering with collapse",
        }
    }
}

/// A method of the short form: an arrangement with a clustering, whose letters are its id.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Crossed {
    /// How sample points are laid out.
    pub arrangement: Arrangement,
    /// How vertices are merged.
    pub clustering: Clustering,
}

impl Crossed {
    /// Two letters: `bi` is body-centred, integrated.
    pub fn id(self) -> MethodId {
        let letters = [self.arrangement.code(), self.clustering.code()];
        letters.iter().collect::<String>().parse().expect("two letters are an id")
    }

    /// The method that these two letters are the id of; `None` of any other id.
    pub fn of(id: MethodId) -> Option<Self> {
        let mut letters = id.as_str().chars();
        let (first, second) = (letters.next()?, letters.next()?);
        let arrangement = Arrangement::ALL.into_iter().find(|of| of.code() == first)?;
        let clustering = Clustering::ALL.into_iter().find(|of| of.code() == second)?;
        letters.next().is_none().then_some(Self { arrangement, clustering })
    }

    /// The name used in tables and figures, such as `body-centred, integrated`.
    pub fn label(self) -> String {
        format!("{}, {}", self.arrangement.label(), self.clustering.label())
    }

    fn phrase(self) -> String {
        format!("{} on {}", self.clustering.phrase(), self.arrangement.phrase())
    }

    /// What the extractor is told: the crossing's two keys, and what `[extraction]` says for all.
    fn recipe(self, section: &toml::Table) -> Recipe {
        let mut settings = section.clone();
        // With positions that follow from indices there is nothing that it could say.
        if !is_summed(section) {
            settings.remove("accumulation_chunks");
        }
        settings.insert("arrangement".into(), self.arrangement.key().into());
        settings.insert("clustering".into(), self.clustering.key().into());
        Recipe { kind: TETRAHEDRA.into(), settings }
    }
}

/// Whether lattice positions are summed up, as the original program does.
pub(crate) fn is_summed(section: &toml::Table) -> bool {
    section.get("positions").and_then(toml::Value::as_str) == Some("accumulated")
}

/// Arrangements crossed with clusterings, in the file's order, as two factors and their methods.
pub(crate) fn expand(
    arrangements: &[Arrangement],
    clusterings: &[Clustering],
    section: &toml::Table,
) -> (Vec<FactorSpec>, Vec<Method>) {
    let lattice = |of: &Arrangement| LevelSpec {
        code: of.code().to_ascii_uppercase().into(),
        label: of.label().into(),
        phrase: of.phrase().into(),
        within: format!("on {}", of.phrase()),
    };
    let merging = |of: &Clustering| LevelSpec {
        code: of.code().to_ascii_uppercase().into(),
        label: of.label().into(),
        phrase: of.phrase().into(),
        within: match of {
            Clustering::None => "without clustering".into(),
            _ => format!("with {}", of.phrase()),
        },
    };
    let factors = vec![
        // Its contrasts by object are the published ones, and their family has the plain name.
        FactorSpec {
            name: "arrangement".into(),
            plural: "lattices".into(),
            suffix: String::new(),
            levels: arrangements.iter().map(lattice).collect(),
        },
        FactorSpec {
            name: "clustering".into(),
            plural: "clusterings".into(),
            suffix: "-clustering".into(),
            levels: clusterings.iter().map(merging).collect(),
        },
    ];
    let mut methods = Vec::new();
    for (a, &arrangement) in arrangements.iter().enumerate() {
        for (c, &clustering) in clusterings.iter().enumerate() {
            let crossed = Crossed { arrangement, clustering };
            methods.push(Method {
                id: crossed.id(),
                label: crossed.label(),
                phrase: crossed.phrase(),
                recipe: crossed.recipe(section),
                budget: None,
                look: None,
                apart: None,
                levels: vec![Some(a), Some(c)],
            });
        }
    }
    (factors, methods)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_the_papers() {
        for arrangement in Arrangement::ALL {
            for clustering in Clustering::ALL {
                let crossed = Crossed { arrangement, clustering };
                assert_eq!(Crossed::of(crossed.id()), Some(crossed));
            }
        }
        let sp = Crossed::of("sp".parse().unwrap()).unwrap();
        assert_eq!(sp.arrangement, Arrangement::SimpleCubic);
        assert_eq!(sp.clustering, Clustering::EdgeCollapse);
        for other in ["b", "bix", "xi", "bx"] {
            assert_eq!(Crossed::of(other.parse().unwrap()), None);
        }
    }
}
