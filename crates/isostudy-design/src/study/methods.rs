//! Looking up methods, factors and levels.

use super::Study;
use crate::method::{Factor, FactorSpec, Level, LevelSpec, Method, MethodId};

/// The name of the factor that every study has: what a method is as a whole.
pub const METHOD: &str = "method";

impl Study {
    /// A method's place among the study's; its order decides every other.
    ///
    /// # Panics
    /// If the study has no such method: ids of a study that was loaded are checked.
    pub fn place(&self, method: MethodId) -> usize {
        self.methods.iter().position(|of| of.id == method).expect("a method of this study")
    }

    /// A method.
    ///
    /// # Panics
    /// As [`Study::place`].
    pub fn method(&self, method: MethodId) -> &Method {
        &self.methods[self.place(method)]
    }

    /// What a factor is called.
    pub fn factor(&self, factor: Factor) -> &FactorSpec {
        &self.factors[factor.0]
    }

    /// What a level is called.
    pub fn level(&self, level: Level) -> &LevelSpec {
        &self.factors[level.factor.0].levels[level.index]
    }

    /// The level with a code, of the declared factor with a name: how groups of answers about levels call both.
    pub fn level_named(&self, factor: &str, code: &str) -> Option<&LevelSpec> {
        let mut factors = self.declared_factors().map(|factor| self.factor(factor));
        factors.find(|own| own.name == factor)?.levels.iter().find(|level| level.code == code)
    }

    /// The factor that every study has: what a method is as a whole.
    pub fn method_factor(&self) -> Factor {
        Factor(self.factors.len() - 1)
    }

    /// The factors that the study says its methods differ in; none but [`Study::method_factor`] if it says nothing.
    pub fn declared_factors(&self) -> impl DoubleEndedIterator<Item = Factor> + use<> {
        (0..self.factors.len() - 1).map(Factor)
    }

    /// The levels of a factor, in the study's order.
    pub fn levels(&self, factor: Factor) -> Vec<Level> {
        (0..self.factor(factor).levels.len()).map(|index| Level { factor, index }).collect()
    }

    /// Of which level of a factor a method is an example, if of any.
    ///
    /// # Panics
    /// As [`Study::place`].
    pub fn level_of(&self, method: MethodId, factor: Factor) -> Option<Level> {
        let place = self.place(method);
        let declared = &self.methods[place].levels;
        let index = declared.get(factor.0).copied().unwrap_or(Some(place));
        index.map(|index| Level { factor, index })
    }

    /// The one factor in which two methods differ, everything else equal: a declared one if there is just one in which they do,
    /// and both are examples of a level; else the factor `method`.
    pub fn difference(&self, one: MethodId, other: MethodId) -> Factor {
        let differ = |factor: &Factor| self.level_of(one, *factor) != self.level_of(other, *factor);
        let mut factors = self.declared_factors().filter(differ);
        match (factors.next(), factors.next()) {
            (Some(factor), None)
                if self.level_of(one, factor).is_some() && self.level_of(other, factor).is_some() =>
            {
                factor
            }
            _ => self.method_factor(),
        }
    }
}
