//! People of whom it is known what they prefer, and what they answer to the forms that they are dealt.

use isostudy_design::Study;
use isostudy_design::forms::{KeyEntry, Questionnaire, Role};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// What is true of the people of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Truth {
    /// Nobody prefers anything.
    Nothing,
    /// All have one ranking of the methods.
    Unanimous,
    /// The same, turned round on one object.
    ButForOneObject,
    /// All press the left button, whatever is there.
    AlwaysLeft,
    /// All press the right button.
    AlwaysRight,
    /// Methods have worths, about which people differ by half a logit; some answers are ties.
    Worths,
    /// Nobody ever prefers.
    TiesOnly,
    /// Every third person presses buttons without looking, at equals too.
    Careless,
    /// Every third person says the opposite when asked again.
    Inconsistent,
    /// One person has the opposite ranking.
    OneOutlying,
    /// As with worths, and a third of the answers is not given.
    ThirdMissing,
    /// As with worths, and people stop early, each at another place.
    Unequal,
    /// As with worths, and there is one person.
    OnePerson,
    /// As with worths, and there are thousands.
    Thousands,
}

impl Truth {
    pub(super) const ALL: [Self; 14] = [
        Self::Nothing,
        Self::Unanimous,
        Self::ButForOneObject,
        Self::AlwaysLeft,
        Self::AlwaysRight,
        Self::Worths,
        Self::TiesOnly,
        Self::Careless,
        Self::Inconsistent,
        Self::OneOutlying,
        Self::ThirdMissing,
        Self::Unequal,
        Self::OnePerson,
        Self::Thousands,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nothing => "no preference",
            Self::Unanimous => "unanimous",
            Self::ButForOneObject => "unanimous but for one object",
            Self::AlwaysLeft => "always left",
            Self::AlwaysRight => "always right",
            Self::Worths => "planted worths",
            Self::TiesOnly => "ties only",
            Self::Careless => "careless on controls",
            Self::Inconsistent => "inconsistent on repeats",
            Self::OneOutlying => "one outlying",
            Self::ThirdMissing => "a third missing",
            Self::Unequal => "unequal numbers",
            Self::OnePerson => "one person",
            Self::Thousands => "thousands",
        }
    }

    /// How many people there are, where a study has so many unless its truth is about that.
    pub(super) fn people(self, usual: usize) -> usize {
        match self {
            Self::OnePerson => 1,
            Self::Thousands => 2000,
            _ => usual,
        }
    }
}

/// What was pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pressed {
    Left,
    Neither,
    Right,
}

/// One answer: what a form showed at a place, and what was pressed.
#[derive(Debug, Clone)]
pub(super) struct Given {
    /// The participant, from 0.
    pub(super) person: usize,
    pub(super) shown: KeyEntry,
    pub(super) pressed: Pressed,
    pub(super) rt_ms: u32,
}

impl Given {
    /// The letters of the method on the left.
    pub(super) fn left(&self) -> &str {
        method(&self.shown.left)
    }

    /// The letters of the method on the right.
    pub(super) fn right(&self) -> &str {
        method(&self.shown.right)
    }

    /// The letters of the method that was chosen; `None` for no preference.
    pub(super) fn chosen(&self) -> Option<&str> {
        match self.pressed {
            Pressed::Left => Some(self.left()),
            Pressed::Neither => None,
            Pressed::Right => Some(self.right()),
        }
    }
}

/// The method in the id of a configuration.
pub(super) fn method(id: &str) -> &str {
    id.split('_').nth(1).expect("an object, an underscore, a method")
}

/// What so many people answer, person n on form n, in the order of their forms.
pub(super) fn answers(study: &Study, truth: Truth, people: usize) -> Vec<Given> {
    let key = Questionnaire::of(study).expect("it plans forms").key();
    let mut given = Vec::new();
    for form in key.chunk_by(|a, b| a.form == b.form).take(people) {
        let asked: Vec<&KeyEntry> = form.iter().filter(|entry| entry.role != Role::Training).collect();
        let mut person =
            Person { truth, number: form[0].form - 1, random: stream(truth, form[0].form as u64, 0) };
        for (place, entry) in asked.iter().enumerate() {
            // Of seven people in a row each stops at another place, the first at the end.
            let stopped =
                truth == Truth::Unequal && place > 0 && place >= asked.len() * (7 - person.number % 7) / 7;
            if stopped || (truth == Truth::ThirdMissing && person.random.random_bool(1.0 / 3.0)) {
                continue;
            }
            let pressed = person.presses(entry);
            let rt_ms = person.takes(entry.order);
            given.push(Given { person: person.number, shown: (*entry).clone(), pressed, rt_ms });
        }
    }
    given
}

struct Person {
    truth: Truth,
    number: usize,
    random: Pcg64,
}

impl Person {
    fn presses(&mut self, entry: &KeyEntry) -> Pressed {
        let every_third = self.number % 3 == 2;
        match self.truth {
            Truth::AlwaysLeft => return Pressed::Left,
            Truth::AlwaysRight => return Pressed::Right,
            Truth::Nothing => return self.at_random(),
            Truth::Careless if every_third => {
                let pressed = self.at_random();
                // Whoever does not look is not told equals from others.
                return if entry.role == Role::Control { Pressed::Left } else { pressed };
            }
            _ if entry.role == Role::Control => return Pressed::Neither,
            Truth::TiesOnly => return Pressed::Neither,
            _ => {}
        }
        let [left, right] = [&entry.left, &entry.right].map(|id| method(id));
        let better = if worth(left) > worth(right) { Pressed::Left } else { Pressed::Right };
        let reversed = match self.truth {
            Truth::ButForOneObject => entry.object == "aa",
            Truth::Inconsistent => every_third && entry.role == Role::Repeat,
            Truth::OneOutlying => self.number == 4,
            _ => false,
        };
        match self.truth {
            Truth::Worths | Truth::ThirdMissing | Truth::Unequal | Truth::OnePerson | Truth::Thousands => {
                self.by_worth(left, right)
            }
            // One answer in ten is anything, so that agreeing is no certainty.
            Truth::OneOutlying if self.random.random_bool(0.1) => self.at_random(),
            _ if !reversed => better,
            _ if better == Pressed::Left => Pressed::Right,
            _ => Pressed::Left,
        }
    }

    fn at_random(&mut self) -> Pressed {
        [Pressed::Left, Pressed::Neither, Pressed::Right][self.random.random_range(0..3)]
    }

    /// Davidson's model, with a tie in about five of equals.
    fn by_worth(&mut self, left: &str, right: &str) -> Pressed {
        let own = |method: &str| {
            let which = method.bytes().fold(0, |sum, letter| 256 * sum + u64::from(letter));
            worth(method) + 0.5 * normal(&mut stream(self.truth, self.number as u64, which))
        };
        let half = (0.5 * (own(left) - own(right))).exp();
        let weights = [half, 0.5, 1.0 / half];
        let at = self.random.random::<f64>() * weights.iter().sum::<f64>();
        match at {
            at if at < weights[0] => Pressed::Left,
            at if at < weights[0] + weights[1] => Pressed::Neither,
            _ => Pressed::Right,
        }
    }

    /// Longer than a turn of two seconds, but for those who do not look.
    fn takes(&self, order: usize) -> u32 {
        match self.truth {
            Truth::Careless if self.number % 3 == 2 => 150 + order as u32,
            _ => 2500 + (977 * (self.number + 1) * order % 4001) as u32,
        }
    }
}

/// Worths in logits: clusterings u, p, i, c from worst to best, then lattices s, b, f, m. No two methods have one.
fn worth(method: &str) -> f64 {
    let place = |letters: &str, at: usize| {
        let letter = &method[at..=at];
        letters.find(letter).unwrap_or_else(|| panic!("{method} is no method")) as f64
    };
    0.6 * place("upic", 1) + 0.25 * place("sbfm", 0)
}

pub(super) fn normal(random: &mut Pcg64) -> f64 {
    // The sum of twelve is close enough, and as easy to see.
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

fn stream(truth: Truth, person: u64, which: u64) -> Pcg64 {
    Pcg64::seed_from_u64((truth as u64) << 48 | person << 20 | which)
}
