//! Factors: what the methods of a study differ in.

/// A factor of a study, by its place among [`Study::factors`](crate::Study::factors).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Factor(pub usize);

/// A value of a factor; what it is called, the study knows: [`Study::level`](crate::Study::level).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Level {
    /// Whose value it is.
    pub factor: Factor,
    /// Its place among the factor's levels.
    pub index: usize,
}

/// What a factor is called, and its levels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FactorSpec {
    /// The name in files and sentences, such as `clustering`.
    pub name: String,
    /// What its levels are called together in a sentence, such as `lattices`.
    pub plural: String,
    /// What the names of the families of its contrasts by object end in, such as `-clustering`.
    pub suffix: String,
    /// Its levels, in the order in which the study names them; of the factor `method`, the methods.
    pub levels: Vec<LevelSpec>,
}

/// What a value of a factor is called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LevelSpec {
    /// Short, in names of contrasts, such as `U`.
    pub code: String,
    /// In tables and figures, such as `none`.
    pub label: String,
    /// As a noun in a sentence, such as `no clustering`.
    pub phrase: String,
    /// Where something holds, such as `without clustering`.
    pub within: String,
}

impl FactorSpec {
    /// The name in headings: the first letter a capital.
    pub fn heading(&self) -> String {
        let mut letters = self.name.chars();
        letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
    }
}
