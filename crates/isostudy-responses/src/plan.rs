//! What a file is expected to hold: the questions, the items that they compare, and who was shown what on which side.

use crate::shown::{Sheet, Shown};
use crate::value::Question;
use crate::words::normalise;
use isostudy_design::Study;
use isostudy_design::config::Way;
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
    shown: Shown,
    /// How a study asks; none where nobody says it.
    way: Option<Way>,
}

/// What the id of a repeat has behind that of its question, and that of training before its number, in a study's forms.
pub(crate) const REPEAT: &str = "-r";
const TRAINING: &str = "training-";

/// Whether the id is that of a pair that is shown to learn how it works, and not analysed.
pub(crate) fn is_training(id: &str) -> bool {
    id.strip_prefix(TRAINING).is_some_and(|number| number.parse::<u32>().is_ok())
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
    /// A study's questions in its order; items are its configurations. Where the study's forms show different sides, the plan knows
    /// what each of them shows.
    pub fn of_study(study: &Study) -> Self {
        let item = |id: &isostudy_design::ConfigurationId| {
            study.configurations.iter().position(|c| c.id == *id).expect("checked on load") as u32
        };
        let question = |comparison: &isostudy_design::Comparison| {
            let object = &study.file.objects[comparison.object].id;
            let group = &study.groups[comparison.group].id;
            let sides = [item(&comparison.left), item(&comparison.right)];
            Question::new(&comparison.question, object, group, sides)
        };
        let questions: Vec<Question> = study.comparisons.iter().map(question).collect();
        let shown = Shown::of_study(study, &questions);
        let plan = Self::new(
            study.configurations.iter().map(|c| c.id.to_string()).collect(),
            study.configurations.iter().map(|c| c.id.method.to_string()).collect(),
            questions,
            shown,
        );
        Self { way: study.file.forms.as_ref().map(|forms| forms.way), ..plan }
    }

    /// Declared pairs; items are numbered as they come. Everybody was shown them with these sides.
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
            let sides = [item(&pair.left), item(&pair.right)];
            questions.push(Question::new(&pair.question, &pair.object, &pair.group, sides));
        }
        let plan = Self::new(items.clone(), items, questions, Shown::as_declared());
        if plan.by_id.len() < plan.questions.len() {
            let twice = |(i, question): &(usize, &Question)| plan.question(&question.id) != Some(*i as u32);
            let id = plan.questions.iter().enumerate().find(twice).map(|(_, question)| question.id.clone());
            return Err(id.unwrap_or_default());
        }
        Ok(plan)
    }

    fn new(items: Vec<String>, short_names: Vec<String>, questions: Vec<Question>, shown: Shown) -> Self {
        let (mut by_id, mut by_folded_id) = (HashMap::new(), HashMap::new());
        for (i, question) in questions.iter().enumerate() {
            by_id.insert(question.id.clone(), i as u32);
            let one = by_folded_id.entry(normalise(&question.id)).or_insert(Some(i as u32));
            *one = one.filter(|&first| first == i as u32);
        }
        Self { items, short_names, questions, by_id, by_folded_id, shown, way: None }
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

    /// How the study's forms ask, if it has any.
    pub(crate) fn way(&self) -> Option<Way> {
        self.way
    }

    /// Whether everybody is shown the listed sides, so that a file may leave them out.
    pub fn shows_listed_sides(&self) -> bool {
        self.shown.as_listed
    }

    /// How many forms are known by their number, from 1.
    pub(crate) fn forms(&self) -> usize {
        self.shown.forms()
    }

    /// What the form with this number asks; `None` if there is no such form. To be asked with numbers of [`Plan::asked`].
    pub(crate) fn sheet(&self, form: &str) -> Option<&Sheet> {
        self.shown.sheet(form)
    }

    /// The number of a repeat or control of the study's forms; questions have smaller ones.
    pub(crate) fn beside(&self, id: &str) -> Option<u32> {
        self.shown.beside(id)
    }

    /// Every repeat and control of the study's forms, with its number.
    pub(crate) fn all_beside(&self) -> impl Iterator<Item = (u32, &Question)> {
        (self.questions.len() as u32..).zip(&self.shown.beside)
    }

    /// A question by its number; repeats and controls follow the questions.
    pub(crate) fn asked(&self, number: u32) -> &Question {
        let number = number as usize;
        self.questions.get(number).unwrap_or_else(|| &self.shown.beside[number - self.questions.len()])
    }

    /// The sides of what has this number, where everybody is shown the listed ones; `None` where nobody knows.
    pub(crate) fn listed(&self, number: u32) -> Option<[u32; 2]> {
        let question = self.questions.get(number as usize).map(|question| [question.left, question.right]);
        question.or_else(|| self.shown.same_for_all(number))
    }

    /// The sides of a pair by its code name.
    pub(crate) fn code(&self, name: &str) -> Option<[u32; 2]> {
        self.shown.code(name)
    }

    /// Whether pairs have code names.
    pub(crate) fn has_codes(&self) -> bool {
        self.shown.has_codes()
    }

    /// The question that compares two items, named in either order, on an object or in a group; `None` if there is none, or
    /// several.
    pub(crate) fn comparing(&self, scene: &str, names: [&str; 2]) -> Option<u32> {
        let fits = |&number: &u32| {
            let question = &self.questions[number as usize];
            let own = if question.object.is_empty() { &question.group } else { &question.object };
            let items = names.map(|name| self.item(name, Some(number)));
            (own.is_empty() || own == scene)
                && items[0].is_some()
                && items[1].is_some()
                && items[0] != items[1]
        };
        let mut fitting = (0..self.questions.len() as u32).filter(fits);
        fitting.next().filter(|_| fitting.next().is_none())
    }

    /// Whether a question's items are these, on whatever sides.
    pub(crate) fn compares(&self, question: u32, [a, b]: [u32; 2]) -> bool {
        let Question { left, right, .. } = self.questions[question as usize];
        [a, b] == [left, right] || [b, a] == [left, right]
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
        self.names_of([question.left, question.right])
    }

    /// Two items as messages show them.
    pub(crate) fn names_of(&self, items: [u32; 2]) -> String {
        let [left, right] = items.map(|item| &self.items[item as usize]);
        format!("{left} and {right}")
    }
}
