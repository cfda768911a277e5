//! The formats that are read.

/// A layout of answers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Format {
    /// A study's own table: one row a participant, one column a question named by its id.
    Table,
    /// One row an answer: `participant, question, left, right, choice` and more; also what the study server exports.
    Long,
    /// Google Forms: the downloaded CSV, the zip round it, or a linked sheet.
    GoogleForms,
    /// Microsoft Forms: the workbook, or a CSV saved from it.
    MicrosoftForms,
    /// Qualtrics, three or two header rows.
    Qualtrics,
    /// LimeSurvey's CSV.
    LimeSurvey,
    /// SurveyMonkey, two header rows.
    SurveyMonkey,
    /// jsPsych's CSV or JSON: one row a trial.
    JsPsych,
    /// JATOS result text: one JSON array a line, one line a participant.
    Jatos,
    /// webMUSHRA's paired comparisons.
    WebMushra,
    /// REDCap's flat CSV.
    RedCap,
    /// arenakit's battles: `model_a, model_b, winner`, of which the first model was shown first, here on the left.
    Arenakit,
    /// pwcmp's comparisons: `observer, scene, condition_A, condition_B, is_A_selected`, which are no sides.
    Pwcmp,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 13] = [
        Self::Table,
        Self::Long,
        Self::GoogleForms,
        Self::MicrosoftForms,
        Self::Qualtrics,
        Self::LimeSurvey,
        Self::SurveyMonkey,
        Self::JsPsych,
        Self::Jatos,
        Self::WebMushra,
        Self::RedCap,
        Self::Arenakit,
        Self::Pwcmp,
    ];

    /// The name in study files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::Long => "long",
            Self::GoogleForms => "google-forms",
            Self::MicrosoftForms => "microsoft-forms",
            Self::Qualtrics => "qualtrics",
            Self::LimeSurvey => "limesurvey",
            Self::SurveyMonkey => "surveymonkey",
            Self::JsPsych => "jspsych",
            Self::Jatos => "jatos",
            Self::WebMushra => "webmushra",
            Self::RedCap => "redcap",
            Self::Arenakit => "arenakit",
            Self::Pwcmp => "pwcmp",
        }
    }

    /// The format with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }

    /// All names, for messages.
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}
