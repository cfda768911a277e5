//! What forms show of a study's methods: pairs, and the names that tell nothing.

use super::Questionnaire;
use crate::method::ConfigurationId;
use crate::study::Study;

impl Study {
    /// Everything that is shown to anybody at once, left to right: of pairs the comparisons as listed, then what else the forms need.
    pub(crate) fn pairs(&self) -> Vec<Vec<ConfigurationId>> {
        let as_listed = || self.comparisons.iter().map(|c| vec![c.left.clone(), c.right.clone()]).collect();
        Questionnaire::of(self).map_or_else(as_listed, |questionnaire| questionnaire.pairs())
    }

    /// Code names: one a configuration, then one a pair, in the order of [`Study::stimuli`].
    pub fn code_names(&self) -> (Vec<String>, Vec<String>) {
        let count = self.configurations.len() + self.pairs().len();
        let mut names = crate::code_names::draw(self.file.study.seed, count);
        let pairs = names.split_off(self.configurations.len());
        (names, pairs)
    }
}
