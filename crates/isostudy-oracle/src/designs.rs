//! Studies of many shapes, made from text as people write it.

use isostudy_design::Study;
use isostudy_design::machine::CpuProfile;

/// A comparison group: its id, and the letters of its methods.
type Group = (&'static str, &'static [&'static str]);

/// The shape of a study.
#[derive(Debug, Clone, Copy)]
pub(super) struct Design {
    /// What it is called in the table.
    pub(super) name: &'static str,
    arrangements: &'static [&'static str],
    clusterings: &'static [&'static str],
    /// Ids and names of the objects, whose order is not that of their names.
    objects: &'static [&'static str],
    groups: &'static [Group],
    sides: &'static str,
    order: &'static str,
    controls: u32,
    repeats: u32,
    /// Most comparisons in a form.
    room: u32,
    /// Level of tests, where the file says one.
    level: Option<f64>,
}

const TWO: &[&str] = &["body-centred", "simple-cubic"];
const THREE: &[&str] = &["body-centred", "simple-cubic", "five-tetrahedra"];
const FOUR: &[&str] = &["body-centred", "simple-cubic", "five-tetrahedra", "face-centred"];
const OBJECTS: &[&str] = &["zz", "aa", "mm"];

const PAPER: [Group; 5] = [
    ("B", &["bu", "bi", "bp"]),
    ("S", &["su", "si", "sp"]),
    ("U", &["su", "bu"]),
    ("I", &["si", "bi"]),
    ("P", &["sp", "bp"]),
];

/// The paper's methods on three objects, 27 questions, sides balanced.
pub(super) const FULL: Design = Design {
    name: "balanced, Latin square",
    arrangements: TWO,
    clusterings: &["none", "integrated", "edge-collapse"],
    objects: OBJECTS,
    groups: &PAPER,
    sides: "balanced",
    order: "latin-square",
    controls: 0,
    repeats: 0,
    room: 27,
    level: None,
};

/// Three blocks of nine questions.
pub(super) const BLOCKS: Design = Design { name: "three blocks", room: 9, ..FULL };

/// Everything that a form can have.
pub(super) const CHECKED: Design = Design { name: "repeats and controls", controls: 2, repeats: 3, ..FULL };

/// Every shape that is tried.
pub(super) const ALL: [Design; 14] = [
    Design { name: "as listed", sides: "as-listed", order: "shuffled", ..FULL },
    FULL,
    Design { name: "balanced, shuffled", order: "shuffled", ..FULL },
    BLOCKS,
    CHECKED,
    Design {
        name: "one group",
        arrangements: &["simple-cubic"],
        groups: &[("S", &["su", "si", "sp"])],
        room: 9,
        ..FULL
    },
    Design { name: "two methods, two objects", objects: &["zz", "aa"], ..PAIR },
    PAIR,
    Design {
        name: "clusterings only",
        groups: &[("B", &["bu", "bi", "bp"]), ("S", &["su", "si", "sp"])],
        controls: 1,
        repeats: 2,
        room: 18,
        ..FULL
    },
    Design {
        name: "three lattices",
        arrangements: THREE,
        clusterings: &["none"],
        groups: &[("U", &["bu", "su", "mu"])],
        room: 9,
        ..FULL
    },
    Design {
        name: "four lattices, two clusterings",
        arrangements: FOUR,
        clusterings: &["none", "edge-collapse"],
        objects: &["zz", "aa"],
        groups: &[("U", &["bu", "su", "mu", "fu"]), ("P", &["bp", "sp", "mp", "fp"])],
        room: 24,
        ..FULL
    },
    Design {
        name: "groups of 2, 3 and 4",
        clusterings: &["none", "integrated", "edge-collapse", "integrated-collapse"],
        groups: &[("B", &["bu", "bi", "bp", "bc"]), ("S", &["su", "si", "sp"]), ("U", &["su", "bu"])],
        room: 30,
        ..FULL
    },
    Design {
        name: "three lattices, two clusterings",
        arrangements: THREE,
        clusterings: &["none", "edge-collapse"],
        groups: &[("U", &["bu", "su", "mu"]), ("P", &["bp", "sp", "mp"]), ("B", &["bu", "bp"])],
        room: 21,
        ..FULL
    },
    Design {
        name: "methods that differ in everything",
        clusterings: &["none", "integrated"],
        groups: &[("X", &["bu", "si"]), ("Y", &["bi", "su"]), ("I", &["bi", "si"]), ("B", &["bu", "bi"])],
        room: 12,
        ..FULL
    },
];

/// One question.
pub(super) const PAIR: Design = Design {
    name: "two methods, one object",
    arrangements: &["body-centred"],
    clusterings: &["none", "integrated"],
    objects: &["mm"],
    groups: &[("B", &["bu", "bi"])],
    controls: 2,
    repeats: 1,
    room: 2,
    ..FULL
};

impl Design {
    /// The study, planned for so many participants.
    ///
    /// # Panics
    /// If the text is not that of a study.
    pub(super) fn study(&self, participants: usize) -> Study {
        let text = self.text(participants);
        let any = CpuProfile::parse("name = \"any\"\nmodel = \"\"\n", "any.toml".as_ref());
        let study = any.and_then(|any| Study::in_memory(&text, any));
        study.unwrap_or_else(|error| panic!("{}: {error}\n{text}", self.name))
    }

    /// What the study file says.
    fn text(&self, participants: usize) -> String {
        let list = |of: &[&str]| {
            let quoted: Vec<String> = of.iter().map(|one| format!("\"{one}\"")).collect();
            format!("[{}]", quoted.join(", "))
        };
        let Self { sides, order, controls, repeats, .. } = self;
        let mut text = format!(
            "schema = 1\narrangements = {}\nclusterings = {}\ncomparisons = [\n{}]\n{REST}",
            list(self.arrangements),
            list(self.clusterings),
            self.comparisons()
        );
        for (place, object) in self.objects.iter().enumerate() {
            let radius = 0.4 + 0.1 * place as f64;
            text += &format!(
                "[[objects]]\nid = \"{object}\"\nname = \"{object}\"\nfield = {{ kind = \"sphere\", radius = {radius:.1} }}\n{OBJECT}"
            );
        }
        for (id, members) in self.groups {
            text +=
                &format!("[[groups]]\nid = \"{id}\"\nlabel = \"group {id}\"\nmembers = {}\n", list(members));
        }
        let (most, first) = (self.room + controls + repeats, self.objects[0]);
        let [one, other] = [self.groups[0].1[0], self.groups[0].1[1]];
        if let Some(level) = self.level {
            text += &format!("[analysis]\nlevel = {level}\n");
        }
        text + &format!(
            "[forms]\nprompt = \"Which?\"\nchoices = [\"Left\", \"No preference\", \"Right\"]\nparticipants = {participants}\n\
             sides = \"{sides}\"\norder = \"{order}\"\nnames = \"code-names\"\ncontrols = {controls}\nrepeats = {repeats}\n\
             max_questions = {most}\ntraining = [{{ left = \"{first}_{one}\", right = \"{first}_{other}\" }}]\n"
        )
    }

    /// Every pair of every group on every object; now the one, now the other is listed on the left.
    fn comparisons(&self) -> String {
        let (mut text, mut number) = (String::new(), 0);
        for object in self.objects {
            for (_, members) in self.groups {
                for (i, first) in members.iter().enumerate() {
                    for second in &members[i + 1..] {
                        number += 1;
                        let [left, right] = if number % 3 == 0 { [second, first] } else { [first, second] };
                        text += &format!(
                            "  {{ question = \"Q{number}\", left = \"{object}_{left}\", right = \"{object}_{right}\" }},\n"
                        );
                    }
                }
            }
        }
        text
    }
}

/// What is the same in every study, since nothing is made of it.
const REST: &str = r#"
[study]
id = "truths"
title = "Planted truths"
seed = 5
[limits]
memory_gib = 1.0
[extraction]
positions = "indexed"
[turntable]
width = 64
height = 64
frames = 10
duration_s = 2.0
elevation_rad = 0.5
near = 1e-4
far = 100.0
supersampling = 1
[shading]
light = [-0.6, 0.2, -0.8]
lit = [0.9, 0.5, 0.0]
shade = [0.2, 0.0, 0.3]
highlight = [1.0, 0.9, 0.8]
background = [0.0, 0.5, 0.5]
[stimuli]
pair_scale = 1
[benchmark]
warmup = 1
iterations = 2
short_iterations = 1
threads = 1
target = "any.toml"
"#;

const OBJECT: &str = "isovalue = 0.0\nmin = [-1.0, -1.0, -1.0]\nmax = [1.0, 1.0, 1.0]\nbenchmark_spacing = 0.2\n\
    stimulus_spacing = 0.2\ncamera = { distance = 1.2, vertical_fov_rad = 1.0 }\n";

#[cfg(test)]
impl Design {
    /// The same, with tests at another level.
    pub(super) fn at_level(self, name: &'static str, level: f64) -> Self {
        Self { name, level: Some(level), ..self }
    }

    /// Whether its groups are the paper's.
    pub(super) fn has_papers_methods(&self) -> bool {
        self.groups.len() == PAPER.len()
    }
}
