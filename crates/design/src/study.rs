//! A study, read from its file, checked, and ready to work from.

use crate::check::{Checker, ConfigError, short};
use crate::code_names;
use crate::config::{FieldSection, ObjectSection, ResponsesSection, StudyFile, SweepSection};
use crate::forms::Questionnaire;
use crate::machine::CpuProfile;
use crate::method::{ConfigurationId, Method};
use crate::published::{BenchmarkRow, Claim, PreferenceCell};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// A study: its file, checked, with everything derived from it.
#[derive(Debug, Clone)]
pub struct Study {
    /// The file it was read from.
    pub path: PathBuf,
    /// What the file says, checked.
    pub file: StudyFile,
    /// Every object with every arrangement and clustering, in the file's order.
    pub configurations: Vec<Configuration>,
    /// The questions, in the file's order.
    pub comparisons: Vec<Comparison>,
    /// The comparison groups, in the file's order.
    pub groups: Vec<Group>,
    /// The CPU the benchmark is meant for.
    pub target: CpuProfile,
    /// The responses, resolved; the file is there.
    pub responses: Option<PathBuf>,
    /// Published numbers; empty for a new study.
    pub published: Published,
}

/// One object with one method.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configuration {
    /// Its id.
    pub id: ConfigurationId,
    /// Index of its object in `file.objects`.
    pub object: usize,
}

/// One question: two configurations of one object, side by side.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Comparison {
    /// The question's id.
    pub question: String,
    /// Index of the object in `file.objects`.
    pub object: usize,
    /// Index in `groups`; every comparison is in exactly one.
    pub group: usize,
    /// Shown on the left.
    pub left: ConfigurationId,
    /// Shown on the right.
    pub right: ConfigurationId,
}

/// A comparison group: the comparisons whose methods are both members.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Short id.
    pub id: String,
    /// Name in tables and figures.
    pub label: String,
    /// The methods compared.
    pub members: Vec<Method>,
    /// Indices into `comparisons`.
    pub comparisons: Vec<usize>,
}

/// Published numbers to compare with.
#[derive(Debug, Clone, Default)]
pub struct Published {
    /// Where they were published.
    pub source: String,
    /// Benchmark rows.
    pub benchmark: Vec<BenchmarkRow>,
    /// Preference factors.
    pub preferences: Vec<PreferenceCell>,
    /// Claims in the text.
    pub claims: Vec<Claim>,
}

const FETCH_HINT: &str = "; `make bunny` (scripts/fetch-bunny.sh) fetches the mesh";

impl Study {
    /// Reads and checks a study file and the tables it names.
    ///
    /// Relative paths in the file are taken from the file's own folder.
    ///
    /// # Errors
    /// The first thing that is wrong, naming the file, the key and what is allowed. Nothing has been written then.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ConfigError::Read { file: path.into(), source })?;
        Self::parse(&text, path)
    }

    /// As [`Study::load`], from text; `path` names it in errors and anchors relative paths.
    ///
    /// # Errors
    /// As for [`Study::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, ConfigError> {
        let file: StudyFile = parse_toml(text, path)?;
        let checker = Checker { file: path };
        check_sections(&checker, &file)?;
        check_objects(&checker, &file.objects)?;
        let configurations = cross(&file);
        let mut groups = groups(&checker, &file, &configurations)?;
        let comparisons = comparisons(&checker, &file, &configurations, &mut groups)?;
        check_stills(&checker, &file, &configurations)?;
        check_forms(&checker, &file, &configurations)?;

        let target_path = checker.existing("benchmark.target", &file.benchmark.target, "")?;
        let target = CpuProfile::load(&target_path)?;
        let responses = match &file.responses {
            Some(ResponsesSection { file: Some(written), .. }) => {
                Some(checker.existing("responses.file", written, "")?)
            }
            _ => None,
        };
        if file.responses.as_ref().is_some_and(|responses| !responses.pairs.is_empty()) {
            let limit = "the study's comparisons are its questions";
            return checker.refuse("responses.pairs", "[...]", limit);
        }
        let published = match &file.published {
            None => Published::default(),
            Some(section) => Published {
                source: section.source.clone(),
                benchmark: published_table(&checker, "published.benchmark", &section.benchmark)?,
                preferences: published_table(&checker, "published.preferences", &section.preferences)?,
                claims: published_table(&checker, "published.claims", &section.claims)?,
            },
        };
        Ok(Self {
            path: path.into(),
            configurations,
            comparisons,
            groups,
            target,
            responses,
            published,
            file,
        })
    }

    /// The object of a configuration.
    pub fn object(&self, configuration: &Configuration) -> &ObjectSection {
        &self.file.objects[configuration.object]
    }

    /// The methods of the study: arrangements crossed with clusterings, in the file's order.
    pub fn methods(&self) -> Vec<Method> {
        methods(&self.file)
    }

    /// A path written in the study file, resolved against the file's folder.
    pub fn resolve(&self, written: &str) -> PathBuf {
        Checker { file: &self.path }.resolve(written)
    }

    /// Every pair, left and right, that is shown to anybody: the comparisons as listed, then what else the forms need.
    pub(crate) fn pairs(&self) -> Vec<(ConfigurationId, ConfigurationId)> {
        let as_listed = || self.comparisons.iter().map(|c| (c.left.clone(), c.right.clone())).collect();
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

pub(crate) fn parse_toml<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| ConfigError::Syntax {
        file: path.into(),
        message: error.to_string().trim_end().to_owned(),
    })
}

fn published_table<T: DeserializeOwned>(
    c: &Checker<'_>,
    key: &str,
    written: &Option<String>,
) -> Result<Vec<T>, ConfigError> {
    written.as_ref().map_or(Ok(Vec::new()), |written| read_table(&c.existing(key, written, "")?))
}

pub(crate) fn read_table<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, ConfigError> {
    let table_error =
        |error: csv::Error| ConfigError::Table { file: path.into(), message: error.to_string() };
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(table_error)?;
    reader.deserialize().collect::<Result<_, _>>().map_err(table_error)
}

/// Everything that does not need another section to judge.
fn check_sections(c: &Checker<'_>, file: &StudyFile) -> Result<(), ConfigError> {
    if file.schema != 1 {
        return c.refuse("schema", file.schema, "this version reads schema 1");
    }
    let id = &file.study.id;
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
    if id.is_empty() || id.len() > 64 || !id.bytes().all(plain) {
        return c.refuse("study.id", id, "must be 1 to 64 lower-case letters, digits or hyphens");
    }
    c.positive("limits.memory_gib", file.limits.memory_gib, 1024.0)?;
    c.count("extraction.accumulation_chunks", file.extraction.accumulation_chunks, 1, 4096)?;

    let t = &file.turntable;
    c.count("turntable.width", t.width, 16, 4096)?;
    c.count("turntable.height", t.height, 16, 4096)?;
    c.count("turntable.frames", t.frames, 1, 3600)?;
    c.number("turntable.duration_s", t.duration_s, 0.01, 600.0)?;
    let delay_cs = t.delay_cs();
    if !(1.0..=65535.0).contains(&delay_cs) {
        return c.refuse(
            "turntable.duration_s",
            short(t.duration_s),
            format!("gives {delay_cs} centiseconds a frame; a GIF holds 1 to 65535"),
        );
    }
    c.number("turntable.elevation_rad", t.elevation_rad, -1.5, 1.5)?;
    c.positive("turntable.near", t.near, 1e3)?;
    c.positive("turntable.far", t.far, 1e9)?;
    if t.far <= t.near {
        let limit = format!("must be above turntable.near = {}", short(t.near));
        return c.refuse("turntable.far", short(t.far), limit);
    }
    c.count("turntable.supersampling", t.supersampling, 1, 4)?;

    let s = &file.shading;
    c.numbers("shading.light", &s.light, -10.0, 10.0)?;
    for (key, colour) in [
        ("shading.lit", &s.lit),
        ("shading.shade", &s.shade),
        ("shading.highlight", &s.highlight),
        ("shading.background", &s.background),
    ] {
        c.numbers(key, colour, 0.0, 1.0)?;
    }
    c.count("stimuli.pair_scale", file.stimuli.pair_scale, 1, 4)?;

    let b = &file.benchmark;
    c.count("benchmark.warmup", b.warmup, 0, 10_000)?;
    c.count("benchmark.iterations", b.iterations, 1, 100_000)?;
    c.count("benchmark.short_iterations", b.short_iterations, 1, 100_000)?;
    c.count("benchmark.aa_iterations", b.aa_iterations, 0, 100_000)?;
    c.count("benchmark.threads", b.threads, 0, 1024)?;
    b.sweep.as_ref().map_or(Ok(()), |sweep| check_sweep(c, file, sweep))
}

fn check_sweep(c: &Checker<'_>, file: &StudyFile, sweep: &SweepSection) -> Result<(), ConfigError> {
    let known: Vec<&str> = file.objects.iter().map(|object| object.id.as_str()).collect();
    if sweep.objects.is_empty() {
        return c.refuse("benchmark.sweep.objects", "[]", "must list at least one object");
    }
    for (i, object) in sweep.objects.iter().enumerate() {
        if !known.contains(&object.as_str()) {
            let limit = format!("must be an object of this study: {}", known.join(", "));
            return c.refuse(format!("benchmark.sweep.objects[{i}]"), object, limit);
        }
    }
    c.distinct(|i| format!("benchmark.sweep.objects[{i}]"), &sweep.objects)?;
    for (name, values, low, high) in [("cells", &sweep.cells, 4, 2048), ("threads", &sweep.threads, 1, 1024)]
    {
        let key = |i: usize| format!("benchmark.sweep.{name}[{i}]");
        if values.is_empty() {
            return c.refuse(format!("benchmark.sweep.{name}"), "[]", "must list at least one");
        }
        for (i, &value) in values.iter().enumerate() {
            c.count(&key(i), value, low, high)?;
            if i > 0 && value <= values[i - 1] {
                return c.refuse(key(i), value, format!("must be above {} = {}", key(i - 1), values[i - 1]));
            }
        }
    }
    c.count("benchmark.sweep.iterations", sweep.iterations, 1, 100_000)
}

fn check_objects(c: &Checker<'_>, objects: &[ObjectSection]) -> Result<(), ConfigError> {
    if objects.is_empty() {
        return c.refuse("objects", "[]", "must list at least one object");
    }
    let ids: Vec<String> = objects.iter().map(|o| o.id.clone()).collect();
    c.distinct(|i| format!("objects[{i}].id"), &ids)?;
    for (i, object) in objects.iter().enumerate() {
        let key = |name: &str| format!("objects[{i}].{name}");
        if object.id.is_empty() || !object.id.bytes().all(|b| b.is_ascii_alphanumeric()) {
            return c.refuse(key("id"), &object.id, "must be letters and digits");
        }
        c.number(&key("isovalue"), object.isovalue, -1e9, 1e9)?;
        c.numbers(&key("min"), &object.min, -1e6, 1e6)?;
        c.numbers(&key("max"), &object.max, -1e6, 1e6)?;
        for axis in 0..3 {
            let (min, max) = (object.min[axis], object.max[axis]);
            // Volumes are single precision.
            if max as f32 <= min as f32 {
                let by = if max > min { " by more than single precision loses" } else { "" };
                let limit = format!("must be above {} = {}{by}", key("min"), short(min));
                return c.refuse(format!("{}[{axis}]", key("max")), short(max), limit);
            }
        }
        c.length(&key("benchmark_spacing"), object.benchmark_spacing, 1e6)?;
        c.length(&key("stimulus_spacing"), object.stimulus_spacing, 1e6)?;
        c.positive(&key("camera.distance"), object.camera.distance, 1e6)?;
        c.number(&key("camera.vertical_fov_rad"), object.camera.vertical_fov_rad, 0.01, 3.1)?;
        check_field(c, &key("field"), &object.field)?;
    }
    Ok(())
}

fn check_field(c: &Checker<'_>, key: &str, field: &FieldSection) -> Result<(), ConfigError> {
    match field {
        FieldSection::Sphere { radius } => c.length(&format!("{key}.radius"), *radius, 1e6),
        FieldSection::Asteroid => Ok(()),
        FieldSection::Mesh { sources } => {
            for (i, source) in sources.iter().enumerate() {
                let key = |name: &str| format!("{key}.sources[{i}].{name}");
                let mut letters: Vec<&str> =
                    source.axes.iter().map(|axis| axis.strip_prefix('-').unwrap_or(axis)).collect();
                letters.sort_unstable();
                if letters != ["x", "y", "z"] {
                    let limit = "must name x, y and z once each, with an optional minus";
                    return c.refuse(key("axes"), format!("{:?}", source.axes), limit);
                }
                if source.sha256.len() != 64 || !source.sha256.bytes().all(|b| b.is_ascii_hexdigit()) {
                    return c.refuse(key("sha256"), &source.sha256, "must be 64 hexadecimal digits");
                }
                c.positive(&key("scale"), source.scale, 1e6)?;
                c.numbers(&key("offset"), &source.offset, -1e6, 1e6)?;
            }
            let there = |file: &str| c.resolve(file).is_file();
            match sources.first() {
                None => c.refuse(format!("{key}.sources"), "[]", "must list at least one file"),
                Some(_) if sources.iter().any(|source| there(&source.file)) => Ok(()),
                Some(first) => {
                    c.existing(&format!("{key}.sources[0].file"), &first.file, FETCH_HINT).map(|_| ())
                }
            }
        }
    }
}

fn methods(file: &StudyFile) -> Vec<Method> {
    let with =
        |arrangement| file.clusterings.iter().map(move |&clustering| Method { arrangement, clustering });
    file.arrangements.iter().copied().flat_map(with).collect()
}

fn cross(file: &StudyFile) -> Vec<Configuration> {
    let mut configurations = Vec::new();
    for (object, section) in file.objects.iter().enumerate() {
        for method in methods(file) {
            let id = ConfigurationId { object: section.id.clone(), method };
            configurations.push(Configuration { id, object });
        }
    }
    configurations
}

fn groups(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
) -> Result<Vec<Group>, ConfigError> {
    let arrangements: Vec<String> = file.arrangements.iter().map(|a| a.label().into()).collect();
    c.distinct(|i| format!("arrangements[{i}]"), &arrangements)?;
    let clusterings: Vec<String> = file.clusterings.iter().map(|a| a.label().into()).collect();
    c.distinct(|i| format!("clusterings[{i}]"), &clusterings)?;
    if configurations.is_empty() {
        let limit = "arrangements and clusterings must list at least one each";
        return c.refuse("arrangements", "[]", limit);
    }
    let ids: Vec<String> = file.groups.iter().map(|g| g.id.clone()).collect();
    c.distinct(|i| format!("groups[{i}].id"), &ids)?;
    let known = methods(file);
    for (i, group) in file.groups.iter().enumerate() {
        let members: Vec<String> = group.members.iter().map(ToString::to_string).collect();
        c.distinct(|j| format!("groups[{i}].members[{j}]"), &members)?;
        if members.len() < 2 {
            return c.refuse(format!("groups[{i}].members"), members.join(", "), "must list at least two");
        }
        if let Some(j) = group.members.iter().position(|member| !known.contains(member)) {
            let limit = "is not among the arrangements and clusterings of this study";
            return c.refuse(format!("groups[{i}].members[{j}]"), group.members[j], limit);
        }
    }
    let group = |section: &crate::config::GroupSection| Group {
        id: section.id.clone(),
        label: section.label.clone(),
        members: section.members.clone(),
        comparisons: Vec::new(),
    };
    Ok(file.groups.iter().map(group).collect())
}

fn comparisons(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
    groups: &mut [Group],
) -> Result<Vec<Comparison>, ConfigError> {
    let questions: Vec<String> = file.comparisons.iter().map(|q| q.question.clone()).collect();
    c.distinct(|i| format!("comparisons[{i}].question"), &questions)?;
    let mut comparisons = Vec::new();
    for (i, section) in file.comparisons.iter().enumerate() {
        let key = |name: &str| format!("comparisons[{i}].{name}");
        let find = |name: &str, id: &ConfigurationId| match configurations
            .iter()
            .find(|configuration| configuration.id == *id)
        {
            Some(configuration) => Ok(configuration.object),
            None => c.refuse(key(name), id, "is not a configuration of this study"),
        };
        let object = find("left", &section.left)?;
        if find("right", &section.right)? != object {
            let limit = format!("must show the same object as the left side, {}", section.left);
            return c.refuse(key("right"), &section.right, limit);
        }
        if section.left == section.right {
            return c.refuse(key("right"), &section.right, "must differ from the left side");
        }
        let holds = |group: &Group| {
            group.members.contains(&section.left.method) && group.members.contains(&section.right.method)
        };
        let mut held_by = (0..groups.len()).filter(|&g| holds(&groups[g]));
        let (group, second) = (held_by.next(), held_by.next());
        let pair = format!("{} against {}", section.left.method, section.right.method);
        let group = match (group, second) {
            (Some(group), None) => group,
            (None, _) => return c.refuse(key("question"), &section.question, format!("no group has {pair}")),
            (Some(first), Some(second)) => {
                let limit = format!(
                    "{pair} is in groups {} and {}; it may be in one",
                    groups[first].id, groups[second].id
                );
                return c.refuse(key("question"), &section.question, limit);
            }
        };
        groups[group].comparisons.push(i);
        comparisons.push(Comparison {
            question: section.question.clone(),
            object,
            group,
            left: section.left.clone(),
            right: section.right.clone(),
        });
    }
    // Each may be shown both ways round and has a code name; so has each configuration, with itself as a control.
    if 2 * (configurations.len() + comparisons.len()) > code_names::LIMIT {
        let limit = format!("configurations and comparisons: at most {}", code_names::LIMIT / 2);
        return c.refuse("comparisons", comparisons.len(), limit);
    }
    Ok(comparisons)
}

fn check_stills(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
) -> Result<(), ConfigError> {
    let ids: Vec<String> = file.stills.iter().map(|still| still.id.clone()).collect();
    c.distinct(|i| format!("stills[{i}].id"), &ids)?;
    for (i, still) in file.stills.iter().enumerate() {
        let key = |name: &str| format!("stills[{i}].{name}");
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
        if still.id.is_empty() || !still.id.bytes().all(plain) {
            return c.refuse(key("id"), &still.id, "must be lower-case letters, digits or underscores");
        }
        if !configurations.iter().any(|configuration| configuration.id == still.configuration) {
            return c.refuse(
                key("configuration"),
                &still.configuration,
                "is not a configuration of this study",
            );
        }
        c.length(&key("spacing"), still.spacing, 1e6)?;
        if still.looks.is_empty() {
            return c.refuse(key("looks"), "[]", "must list at least one look");
        }
    }
    Ok(())
}

fn check_forms(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
) -> Result<(), ConfigError> {
    let Some(forms) = &file.forms else { return Ok(()) };
    if file.comparisons.is_empty() {
        return c.refuse("comparisons", "[]", "[forms] needs something to ask: must list at least one");
    }
    let comparisons = u32::try_from(file.comparisons.len()).unwrap_or(u32::MAX);
    c.count("forms.participants", forms.participants, 1, 100_000)?;
    c.count("forms.controls", forms.controls, 0, configurations.len() as u32)?;
    c.count("forms.max_questions", forms.max_questions, forms.controls + 1, 10_000)?;
    // The smallest block must hold what is repeated in it.
    let holds = |repeats: u32| match (forms.max_questions - forms.controls).checked_sub(repeats) {
        None | Some(0) => false,
        Some(room) => comparisons / comparisons.div_ceil(room).max(1) >= repeats,
    };
    if !holds(forms.repeats) {
        let most = (0..forms.repeats).rev().find(|&repeats| holds(repeats)).unwrap_or(0);
        let limit = format!("with forms.max_questions = {} at most {most} fit", forms.max_questions);
        return c.refuse("forms.repeats", forms.repeats, limit);
    }
    if forms.prompt.trim().is_empty() {
        return c.refuse("forms.prompt", "\"\"", "must say what is asked about each pair");
    }
    if let Some(i) = forms.choices.iter().position(|choice| choice.trim().is_empty()) {
        return c.refuse(format!("forms.choices[{i}]"), "\"\"", "must be a text");
    }
    c.distinct(|i| format!("forms.choices[{i}]"), &forms.choices)?;
    for (key, text) in [("forms.consent", &forms.consent), ("forms.instructions", &forms.instructions)] {
        if text.trim().is_empty() {
            return c.refuse(key, "\"\"", "must be a text");
        }
    }
    c.count("forms.page_scale", forms.page_scale, 1, 4)?;
    if let Some(completion) = &forms.completion {
        let code = completion.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '-');
        if completion.is_empty() || completion.len() > 500 || !(code || completion.starts_with("https://")) {
            return c.refuse(
                "forms.completion",
                completion,
                "letters, digits and hyphens, or an https:// address; up to 500",
            );
        }
    }
    c.count("forms.training", forms.training.len() as u32, 0, 100)?;
    for (i, pair) in file.forms.iter().flat_map(|forms| &forms.training).enumerate() {
        for (name, id) in [("left", &pair.left), ("right", &pair.right)] {
            if !configurations.iter().any(|configuration| configuration.id == *id) {
                let key = format!("forms.training[{i}].{name}");
                return c.refuse(key, id, "is not a configuration of this study");
            }
        }
        if pair.left.object != pair.right.object {
            let limit = format!("must show the same object as the left side, {}", pair.left);
            return c.refuse(format!("forms.training[{i}].right"), &pair.right, limit);
        }
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A study file of this project, its mesh source pointing at a file that is always there.
    pub(crate) fn load(name: &str) -> Study {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        Study::parse(&text.replace("../cache/bunny.ply", name), &path).unwrap()
    }

    /// The paper's file with one passage replaced, its mesh source pointing at a file that is always there.
    pub(crate) fn paper_with(from: &str, to: &str) -> Result<Study, ConfigError> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{from} is not in {}", path.display());
        let text = text.replacen(from, to, 1).replace("../cache/bunny.ply", "paper.toml");
        Study::parse(&text, &path)
    }

    fn error_with(from: &str, to: &str) -> String {
        paper_with(from, to).map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn the_papers_design_is_whole() {
        let study = paper_with("schema = 1", "schema = 1").unwrap();
        assert_eq!(study.configurations.len(), 18);
        let ids: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
        assert_eq!(ids[..6], ["ss_bu", "ss_bi", "ss_bp", "ss_su", "ss_si", "ss_sp"]);
        assert_eq!(ids[17], "bs_sp");
        assert_eq!(study.comparisons.len(), 27);
        let sizes: Vec<usize> = study.groups.iter().map(|g| g.comparisons.len()).collect();
        assert_eq!(sizes, [9, 9, 3, 3, 3]);
        assert_eq!(study.published.benchmark.len(), 18);
        assert_eq!(study.published.preferences.len(), 12 + 6 + 5);
        let (turntables, pairs) = study.code_names();
        assert_eq!((turntables.len(), pairs.len()), (18, 27));
    }

    #[test]
    fn an_error_names_file_key_and_limit() {
        let error = error_with("isovalue = 0.0", "isovalue = nan");
        assert!(error.contains("paper.toml: objects[0].isovalue = NaN: must be a finite number"), "{error}");
        let error = error_with("benchmark_spacing = 0.04", "benchmark_spacing = -0.04");
        assert!(error.contains("objects[0].benchmark_spacing = -0.04: must be above 0"), "{error}");
        let error = error_with("supersampling = 2", "supersampling = 9");
        assert!(error.contains("turntable.supersampling = 9: must lie between 1 and 4"), "{error}");
        let error = error_with("max = [1.0, 1.0, 1.0]", "max = [1.0, -2.0, 1.0]");
        assert!(error.contains("objects[0].max[1] = -2: must be above objects[0].min = -1"), "{error}");
    }

    #[test]
    fn extreme_numbers_are_told_in_few_letters() {
        let key = "benchmark_spacing = 0.04";
        let error = error_with(key, "benchmark_spacing = 1e300");
        assert!(error.contains("benchmark_spacing = 1e300: must be above 0 and at most 1000000"), "{error}");
        let error = error_with(key, "benchmark_spacing = 1e-300");
        assert!(error.contains("benchmark_spacing = 1e-300: is 0 in single precision"), "{error}");
        let error = error_with("radius = 1.0", "radius = 1e-60");
        assert!(error.contains("field.radius = 1e-60: is 0 in single precision"), "{error}");
        let error = error_with("isovalue = 0.0", "isovalue = -1e300");
        assert!(error.contains("isovalue = -1e300: must lie between -1000000000 and"), "{error}");
        let error = error_with("max = [1.0, 1.0, 1.0]", "max = [1.0, 1.0, -0.99999999999]");
        let told = "max[2] = -0.99999999999: must be above objects[0].min = -1 by more than single precision";
        assert!(error.contains(told), "{error}");
    }

    #[test]
    fn unknown_keys_and_missing_files_are_named() {
        let error = error_with("memory_gib = 8.0", "memory_gib = 8.0\nmemory_gb = 1");
        assert!(error.contains("memory_gb") && error.contains("paper.toml"), "{error}");
        let error = error_with("radius = 1.0", "radius = 1.0, diameter = 2.0");
        assert!(error.contains("diameter"), "{error}");
        let error = error_with("../study/paper/responses.csv", "../study/paper/nobody.csv");
        assert!(error.contains("responses.file") && error.contains("nobody.csv"), "{error}");
        let path = Path::new("/nowhere/study.toml");
        assert!(Study::load(path).unwrap_err().to_string().contains("/nowhere/study.toml"));
    }

    #[test]
    fn topology_is_guarded_unless_said_otherwise() {
        let topology = |to| paper_with("topology = \"published\"", to).unwrap().file.extraction.topology;
        assert_eq!(topology("topology = \"published\""), crate::config::Topology::Published);
        assert_eq!(topology(""), crate::config::Topology::Guarded);
    }

    #[test]
    fn chunks_of_layers_may_be_left_out() {
        let chunks =
            |to| paper_with("accumulation_chunks = 16", to).unwrap().file.extraction.accumulation_chunks;
        assert_eq!((chunks("accumulation_chunks = 16"), chunks("")), (16, 1));
        let error = error_with("accumulation_chunks = 16", "accumulation_chunks = 0");
        assert!(error.contains("accumulation_chunks = 0: must lie between 1 and 4096"), "{error}");
    }

    #[test]
    fn unknown_placements_are_told_what_there_is() {
        let key = "placement = \"mean-of-crossings\"";
        let error = error_with(key, "placement = \"nearest\"");
        for part in
            ["paper.toml", "placement = ", "nearest", "mean-of-crossings", "curvature-weighted", "relaxed"]
        {
            assert!(error.contains(part), "{error}");
        }
        let error = error_with("refine_crossings = false", "refine_crossings = 4");
        assert!(error.contains("refine_crossings = 4") && error.contains("boolean"), "{error}");
        let placement = |to| paper_with(key, to).unwrap().file.extraction.placement;
        assert_eq!(placement(""), crate::config::Placement::MeanOfCrossings);
        assert_eq!(placement("placement = \"relaxed\""), crate::config::Placement::Relaxed);
    }

    #[test]
    fn forms_need_something_to_ask() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let (before, rest) = text.split_once("comparisons = [").unwrap();
        let (_, after) = rest.split_once("\n]\n").unwrap();
        let text = format!("{before}comparisons = []\n{after}");
        let error = Study::parse(&text, &path).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.contains("two-methods.toml: comparisons = []: [forms] needs something to ask"),
            "{error}"
        );
        let (asks_nobody, _) = text.split_once("[forms]").unwrap();
        assert!(Study::parse(asks_nobody, &path).is_ok());
    }

    #[test]
    fn comparisons_must_make_sense() {
        let error = error_with("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"as_bi\"");
        assert!(error.contains("comparisons[0].right = as_bi: must show the same object"), "{error}");
        let error = error_with("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"ss_si\"");
        assert!(error.contains("no group has bu against si"), "{error}");
        let error = error_with("question = \"Q2\"", "question = \"Q1\"");
        assert!(
            error.contains("comparisons[1].question = Q1: already used by comparisons[0].question"),
            "{error}"
        );
        let error = error_with("members = [\"si\", \"bi\"]", "members = [\"su\", \"bu\"]");
        assert!(error.contains("is in groups U and I"), "{error}");
    }
}
