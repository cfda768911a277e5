//! What probes saw: numbers, and names of questions, items and groups. Sentences about it are made where results are printed.
//!
//! Participants are by index.

/// What a probe saw, or why it can see nothing.
#[derive(Debug, Clone, PartialEq)]
pub enum Evidence {
    /// Of a side.
    Side(Pulls),
    /// Of somebody who answers against the others.
    OutlyingRespondent(Agreement),
    /// Of answers that are in twice.
    CopiedRows(Copies),
    /// Of sides that were mixed up in the key.
    SwappedKey(Key),
    /// Of preferences that depend on the object.
    ObjectInteraction(Differences),
    /// Of items that never win against the others.
    Separation(Separations),
    /// Of nothing.
    NotAnswerable(Reason),
}

/// Why the design or the answers cannot tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reason {
    /// Sides are not recorded.
    NoSides,
    /// Pairs tell too little, and there are no controls.
    FewInBothOrders(BothOrders),
    /// Pairs tell too little, and of these answers to controls (left, none, right) there are too few people's.
    FewControls([u64; 3], BothOrders),
    /// Too few people decided enough questions on which the others have a majority.
    FewDeciders,
    /// Too few people answered the same questions on the same sides, and no times are recorded.
    FewRowsAlike,
    /// Too few pairs were seen in both orders of sides.
    FewPairsInBothOrders {
        /// What else is to be said of labels.
        remarks: Vec<Remark>,
        /// Pairs of items that were seen in both orders, each order on an object of its own.
        apart: usize,
    },
    /// No two people were shown the same pair of items on more than one object.
    NoPairOnTwoObjects {
        /// Who is left out, because they press one side throughout.
        pressing: usize,
    },
    /// Nothing was compared.
    NothingCompared,
    /// Nobody ever decided between two items.
    NothingDecided,
}

/// What was seen in both orders of sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BothOrders {
    /// Pairs of items that were, on one object.
    pub pairs: usize,
    /// Who answered about those.
    pub people: usize,
    /// Pairs of items that were, but each order on an object of its own. Where no object is named, each question is one.
    pub apart: usize,
}

/// How far answers go to one side, whatever it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulls {
    /// Over pairs seen in both orders of sides.
    pub pairs: Option<Pull>,
    /// Answers to controls: left, none, right.
    pub controls: Option<[u64; 3]>,
}

/// How far pairs pull to one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// Number of pairs.
    pub pairs: usize,
    /// From -1 to 1; above zero it is to the left.
    pub mean: f64,
}

/// How people agree with the others' majority.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Who agrees less than chance lets them, and their share of agreement; the least likely first.
    pub outlying: Vec<(usize, f64)>,
    /// The lowest share of everybody else.
    pub low: f64,
    /// The highest.
    pub high: f64,
}

/// What rows have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct Copies {
    /// Times; `None` if there are too few.
    pub times: Option<SameTimes>,
    /// Answers; `None` if too few people's can be compared.
    pub answers: Option<SameAnswers>,
}

/// Who took the same times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SameTimes {
    /// People whose times were compared.
    pub people: usize,
    /// People with too few times to be compared.
    pub untimed: usize,
    /// Who has times in common beyond chance.
    pub copies: Vec<TimeTwins>,
}

/// Two people with times in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeTwins {
    /// Who.
    pub people: [usize; 2],
    /// Times in common.
    pub common: usize,
    /// Answers that both timed.
    pub timed: usize,
}

/// Who gave the same answers.
#[derive(Debug, Clone, PartialEq)]
pub struct SameAnswers {
    /// People who were compared with others.
    pub people: usize,
    /// Pairs with the same answers.
    pub same: u64,
    /// How many chance makes.
    pub expected: f64,
    /// How many pairs would give the least probable of these rows by chance.
    pub least_expected: f64,
    /// Who gave the same answers.
    pub copies: Vec<Vec<usize>>,
}

/// What labels and the two orders of pairs say of the key.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// How labels contradict what was shown.
    pub contradictions: Vec<Contradiction>,
    /// What agrees, and what cannot be said.
    pub remarks: Vec<Remark>,
    /// Whether answers were turned.
    pub orders: Orders,
}

/// How labels contradict what was shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Contradiction {
    /// What code names show.
    Codes {
        /// Files whose answers were looked at.
        files: usize,
        /// Those of which answers contradict, each with its code name.
        wrong: Vec<(WrongFile, String)>,
    },
    /// What forms show.
    Forms(Vec<WrongFile>),
    /// Sides are those of another form than the file names, for these participants.
    OtherForm(Vec<usize>),
}

/// A file whose answers are labelled otherwise than it shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrongFile {
    /// The questions that show it.
    pub questions: Vec<String>,
    /// Answers that contradict.
    pub contradicting: u64,
    /// All answers to it.
    pub answers: u64,
}

/// What else is to be said of labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remark {
    /// Code names agree with the sides.
    CodesAgree {
        /// Of so many files.
        files: usize,
    },
    /// Sides are those of the forms.
    FormsAgree,
    /// Sides are not those of the forms that the study deals.
    OtherStudysForms,
    /// Single answers contradict the forms.
    Stray {
        /// So many.
        answers: u64,
    },
}

/// What the two orders of pairs say.
#[derive(Debug, Clone, PartialEq)]
pub enum Orders {
    /// They agree.
    Agree {
        /// In so many pairs.
        pairs: usize,
    },
    /// They contradict each other in these pairs.
    Contradict(Vec<TurnedPair>),
    /// Too few pairs were seen in both.
    Few,
}

/// A pair whose two orders contradict each other.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnedPair {
    /// The questions that show it.
    pub questions: Vec<String>,
    /// Mean for the same item, where it stands on the left and where it stands on the right.
    pub means: [f64; 2],
}

/// How preferences differ between objects.
#[derive(Debug, Clone, PartialEq)]
pub struct Differences {
    /// Comparisons made.
    pub compared: usize,
    /// Those that differ beyond chance, the least likely first.
    pub found: Vec<Difference>,
    /// The largest, if any differs.
    pub largest: Option<Difference>,
    /// Who is left out, because they press one side throughout.
    pub pressing: usize,
}

/// One pair of items in one group, on one object against the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The pair.
    pub items: [String; 2],
    /// The group.
    pub group: String,
    /// The object.
    pub object: String,
    /// Mean over participants for the first item, on the object and on the others.
    pub means: [f64; 2],
}

/// How answers leave the worths of groups, by the groups' names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Separations {
    /// Some items never won against the others.
    pub separated: Vec<String>,
    /// Some items were never compared with the others.
    pub disconnected: Vec<String>,
    /// Ties alone keep worths finite.
    pub held_by_ties: Vec<String>,
    /// Groups in which somebody decided.
    pub judged: usize,
    /// Groups in which nobody ever did.
    pub undecided: usize,
}
