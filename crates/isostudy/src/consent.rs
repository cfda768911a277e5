//! Consent to run the programs that a study names: asked for with what runs, and remembered by what it was given to.
//!
//! What is remembered belongs to the user, not to a folder of results, which could come from the stranger that the study is from. It is
//! bound to absolute paths: the same script beside other modules is another program.

use crate::digests::Digests;
use crate::recipe::{self, Recipe};
use crate::store::write_whole;
use anyhow::{Context, Result, bail};
use isostudy_design::Study;
use isostudy_design::record::Purpose;
use isostudy_foreign::shown_in_a_line;
use isostudy_program::Program;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

/// The largest record of what was allowed.
const RECORD_LIMIT: u64 = 16 << 20;
/// The longest answer to a question.
const ANSWER_LIMIT: u64 = 100;

/// A program that was allowed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Allowed {
    /// The words that are started.
    words: Vec<String>,
    /// Whether it was allowed in a sandbox alone.
    sandbox: bool,
    /// The files that the words name, with their SHA-256.
    files: BTreeMap<String, String>,
}

/// What was allowed by this user.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Record {
    schema: u32,
    allowed: Vec<Allowed>,
}

/// What a study would run: what is to be allowed, and how it is told.
struct Wanted {
    allowed: Allowed,
    told: String,
}

/// Asks for what is not allowed yet. `given` says that the command line allows it; then nothing is asked, and what runs is told.
///
/// # Errors
/// If it is not allowed, with what would run and the command that allows it; if a program cannot be found.
pub(crate) fn ask(study: &Study, given: bool, sandbox: bool) -> Result<()> {
    recipe::use_sandbox(sandbox);
    ask_for(&study.path, &programs(study)?, given, sandbox)
}

/// The same for programs that a file names, each with what it is called there.
///
/// # Errors
/// As [`ask`].
pub(crate) fn ask_for(file: &Path, programs: &[(String, Program)], given: bool, sandbox: bool) -> Result<()> {
    let path = record_file();
    let mut record = path.as_deref().map_or_else(Record::default, read);
    let wanted = wanted(programs, sandbox, &record)?;
    let is_new = |wanted: &&Wanted| !record.allowed.iter().any(|known| covers(known, &wanted.allowed));
    let new: Vec<&Wanted> = wanted.iter().filter(is_new).collect();
    if new.is_empty() && !given {
        return Ok(());
    }
    let name = file.display();
    let power = if sandbox { "in a sandbox" } else { "which may do whatever you may do" };
    let list = |of: &[&Wanted]| of.iter().map(|wanted| wanted.told.as_str()).collect::<Vec<_>>().join("\n");
    if given {
        if !wanted.is_empty() {
            tell!("{name} runs programs, {power}:\n{}", list(&wanted.iter().collect::<Vec<_>>()));
        }
    } else if std::io::stdin().is_terminal() && std::io::stderr().is_terminal() {
        tell!("{name} runs programs, {power}:\n{}\nRun them? Type yes to allow it:", list(&new));
        let mut answer = String::new();
        let mut letter = [0];
        let mut input = std::io::stdin().lock().take(ANSWER_LIMIT);
        while input.read(&mut letter)? == 1 && letter != *b"\n" {
            answer.push(letter[0].into());
        }
        if answer.trim() != "yes" {
            bail!("{name}: its programs are not allowed to run");
        }
    } else {
        bail!(
            "{name} runs programs, {power}:\n{}\n--allow-programs runs them, and remembers that until a file changes:\n  {}",
            list(&new),
            command_line()
        );
    }
    let new: Vec<Allowed> = new.into_iter().map(|wanted| wanted.allowed.clone()).collect();
    if let (Some(path), false) = (path, new.is_empty()) {
        for allowed in new {
            record.allowed.retain(|known| known.words != allowed.words);
            record.allowed.push(allowed);
        }
        record.schema = 1;
        if let Err(error) = write_whole(&path, &serde_json::to_vec_pretty(&record)?) {
            tell!("what was allowed is not remembered: {error:#}");
        }
    }
    Ok(())
}

/// Whether what was allowed is what is wanted, or more.
fn covers(known: &Allowed, wanted: &Allowed) -> bool {
    known.words == wanted.words && known.files == wanted.files && (!known.sandbox || wanted.sandbox)
}

/// The programs of a study.
fn programs(study: &Study) -> Result<Vec<(String, Program)>> {
    let mut all = Vec::new();
    // Files are shown, and nothing is run.
    if study.shown_files().is_some() {
        return Ok(all);
    }
    for method in &study.methods {
        if let Recipe::Program(program) = recipe::recipe(study, method.id, Purpose::Benchmark)? {
            program.words().with_context(|| recipe::key(study, method.id))?;
            all.push((method.id.to_string(), program));
        }
    }
    Ok(all)
}

fn wanted(programs: &[(String, Program)], sandbox: bool, record: &Record) -> Result<Vec<Wanted>> {
    let (mut all, mut digests) = (Vec::new(), Digests::default());
    for (name, program) in programs {
        let words = program.words()?;
        let mut files = BTreeMap::new();
        for path in words.iter().map(Path::new).filter(|path| path.is_absolute() && path.is_file()) {
            files.insert(path.display().to_string(), digests.of(path)?);
        }
        let words: Vec<String> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
        let before = record.allowed.iter().find(|known| known.words == words).map(|known| &known.files);
        let quoted: Vec<String> = program.command.iter().map(|word| format!("{word:?}")).collect();
        let mut told = format!("  {name}: {}", quoted.join(" "));
        for (file, digest) in &files {
            let changed = before.is_some_and(|before| before.get(file) != Some(digest));
            let note = if changed { ", changed since you allowed it" } else { "" };
            told.push_str(&format!("\n    {digest} {}{note}", shown_in_a_line(file)));
        }
        all.push(Wanted { allowed: Allowed { words, sandbox, files }, told });
    }
    Ok(all)
}

/// Where the user's state is kept (XDG Base Directory Specification 0.8); nowhere without a home.
fn record_file() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let state = absolute("XDG_STATE_HOME").or_else(|| Some(absolute("HOME")?.join(".local/state")))?;
    Some(state.join("isostudy/programs.json"))
}

/// What cannot be read was not allowed.
fn read(path: &Path) -> Record {
    let bytes = isostudy_foreign::bytes(path, RECORD_LIMIT).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

/// The command as it was typed, for a shell, and with the option. No secret is repeated.
fn command_line() -> String {
    let mut words = vec!["isostudy".to_owned()];
    let mut is_secret = false;
    for word in std::env::args().skip(1) {
        let option = word.starts_with("--admin-token");
        words.push(match () {
            () if is_secret => "TOKEN".into(),
            () if option && word.contains('=') => "--admin-token=TOKEN".into(),
            () => for_shell(&word),
        });
        is_secret = option && !word.contains('=');
    }
    words.push("--allow-programs".into());
    words.join(" ")
}

fn for_shell(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_allowed_covers_the_same_and_less() {
        let allowed = |sandbox, digest: &str| Allowed {
            words: vec!["/bin/x".into(), "-v".into()],
            sandbox,
            files: [("/bin/x".to_owned(), digest.to_owned())].into(),
        };
        assert!(covers(&allowed(false, "1"), &allowed(false, "1")));
        assert!(covers(&allowed(false, "1"), &allowed(true, "1")));
        assert!(!covers(&allowed(true, "1"), &allowed(false, "1")), "it was for a sandbox");
        assert!(!covers(&allowed(false, "1"), &allowed(false, "2")), "the file changed");
        let other = Allowed { words: vec!["/bin/x".into()], ..allowed(false, "1") };
        assert!(!covers(&other, &allowed(false, "1")));
    }

    #[test]
    fn words_survive_a_shell() {
        for (word, quoted) in
            [("a.toml", "a.toml"), ("", "''"), ("a b", "'a b'"), ("it's;$x", "'it'\\''s;$x'")]
        {
            assert_eq!(for_shell(word), quoted);
        }
    }
}
