//! What a file is expected to hold: the questions and the items that they compare.

use crate::value::Question;
use crate::words::normalise;
use design::Study;
use std::collections::HashMap;

/// The questions that were asked. Files whose columns are questions cannot be read without.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    items: Vec<String>,
    /// Other names, such as a configuration's method; one an item.
    short_names: Vec<String>,
    questions: Vec<Question>,
    by_id: HashMap<String, u32>,
    /// By the id without regard to case and space; none where that is two questions.
    by_folded_id: HashMap<String, Option<u32>>,
}

/// One declared pair, for answers without a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlannedPair {
    /// The question's id, unique.
    pub question: String,
    /// Item on the left.
    pub left: String,
    /// Item on the right.
    pub right: String,
    /// What both are of, or empty.
    pub object: String,
    /// The group of items compared, or empty.
    pub group: String,
}

impl Plan {
    /// A study's questions in its order; items are its configurations.
    pub fn of_study(study: &Study) -> Self {
        let item = |id: &design::ConfigurationId| {
            study.configurations.iter().position(|c| c.id == *id).expect("checked on load") as u32
        };
        let question = |comparison: &design::Comparison| Question {
            id: comparison.question.clone(),
            object: study.file.objects[comparison.object].id.clone(),
            group: study.groups[comparison.group].id.clone(),
            left: item(&comparison.left),
            right: item(&comparison.right),
        };
        Self::new(
            study.configurations.iter().map(|c| c.id.to_string()).collect(),
            study.configurations.iter().map(|c| c.id.method.to_string()).collect(),
            study.comparisons.iter().map(question).collect(),
        )
    }

    /// Declared pairs; items are numbered as they come.
    ///
    /// # Errors
    /// The id that two pairs have.
    pub fn of_pairs(pairs: &[PlannedPair]) -> Result<Self, String> {
        let mut items: Vec<String> = Vec::new();
        let mut item = |name: &String| {
            let known = items.iter().position(|item| item == name);
            known.unwrap_or_else(|| {
                items.push(name.clone());
                items.len() - 1
            }) as u32
        };
        let mut questions = Vec::new();
        for pair in pairs {
            let (left, right) = (item(&pair.left), item(&pair.right));
            let (id, object, group) = (pair.question.clone(), pair.object.clone(), pair.group.clone());
            questions.push(Question { id, object, group, left, right });
        }
        let plan = Self::new(items.clone(), items, questions);
        if plan.by_id.len() < plan.questions.len() {
            let twice = |(i, question): &(usize, &Question)| plan.question(&question.id) != Some(*i as u32);
            let id = plan.questions.iter().enumerate().find(twice).map(|(_, question)| question.id.clone());
            return Err(id.unwrap_or_default());
        }
        Ok(plan)
    }

    fn new(items: Vec<String>, short_names: Vec<String>, questions: Vec<Question>) -> Self {
        let (mut by_id, mut by_folded_id) = (HashMap::new(), HashMap::new());
        for (i, question) in questions.iter().enumerate() {
            by_id.insert(question.id.clone(), i as u32);
            let one = by_folded_id.entry(normalise(&question.id)).or_insert(Some(i as u32));
            *one = one.filter(|&first| first == i as u32);
        }
        Self { items, short_names, questions, by_id, by_folded_id }
    }

    /// The items.
    pub fn items(&self) -> &[String] {
        &self.items
    }

    /// Names of the items within their object: a study's methods. One an item.
    pub fn short_names(&self) -> &[String] {
        &self.short_names
    }

    /// The questions.
    pub fn questions(&self) -> &[Question] {
        &self.questions
    }

    /// Every name that answers are stored and shown with.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        let questions = self.questions.iter().flat_map(|q| [&q.id, &q.object, &q.group]);
        questions.chain(&self.items).chain(&self.short_names).map(String::as_str)
    }

    /// The question with this id; case and space do not matter where they tell no two questions apart.
    pub(crate) fn question(&self, id: &str) -> Option<u32> {
        let exact = self.by_id.get(id).copied();
        exact.or_else(|| self.by_folded_id.get(&normalise(id)).copied().flatten())
    }

    /// The item with this name among those of a question, or among all where there is none.
    pub(crate) fn item(&self, name: &str, question: Option<u32>) -> Option<u32> {
        let named = |item: u32| {
            let item = item as usize;
            self.items[item] == name || self.short_names[item] == name
        };
        match question.map(|q| &self.questions[q as usize]) {
            Some(question) => [question.left, question.right].into_iter().find(|&item| named(item)),
            None => self.items.iter().position(|item| item == name).map(|item| item as u32),
        }
    }

    /// A question's pair as messages show it.
    pub(crate) fn pair(&self, question: u32) -> String {
        let question = &self.questions[question as usize];
        let [left, right] = [question.left, question.right].map(|item| &self.items[item as usize]);
        format!("{left} and {right}")
    }
}
