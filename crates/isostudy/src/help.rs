//! What `isostudy help` prints: the commands by what they are for, with an example each.

use clap::Command;

/// What commands are for, and those that are: each with an example that works in the project's folder.
const GROUPS: [(&str, &[(&str, &str)]); 4] = [
    (
        "Make: meshes, animations, whole studies",
        &[
            ("new", "isostudy new my-study"),
            ("validate", "isostudy validate configs/paper.toml"),
            ("study", "isostudy study configs/quick.toml"),
            ("plan", "isostudy plan configs/quick.toml"),
            ("job", "isostudy job configs/quick.toml mesh/benchmark/ss_bi"),
            ("methods", "isostudy methods"),
            ("extract", "isostudy extract --volume head.nrrd --isovalue 300.5 -o head.glb"),
            ("turntable", "isostudy turntable cache/bunny.ply -o bunny.gif"),
        ],
    ),
    (
        "Ask: a questionnaire, and the people who answer it",
        &[
            ("design", "isostudy design check configs/balanced.toml"),
            ("pairs", "isostudy pairs configs/paper.toml"),
            ("bundle", "isostudy bundle configs/balanced.toml"),
            ("serve", "isostudy serve configs/balanced.toml"),
            ("collect", "isostudy collect configs/balanced.toml downloads -o answers.csv"),
            ("deidentify", "isostudy deidentify configs/balanced.toml -o public"),
        ],
    ),
    (
        "Read: answers, tables, figures, the report",
        &[
            ("convert", "isostudy convert export.csv --to long -o answers.csv"),
            ("analyse", "isostudy analyse configs/paper.toml"),
            ("report", "isostudy report configs/paper.toml"),
        ],
    ),
    (
        "Measure: times, distances, topology",
        &[
            ("bench", "isostudy bench configs/paper.toml"),
            ("inspect", "isostudy inspect ss_bi --study configs/paper.toml"),
            ("distance", "isostudy distance coarse.ply fine.ply"),
            ("verify", "isostudy verify head.ply --volume head.nrrd --isovalue 300.5"),
            ("table", "isostudy table mc --groups"),
            ("barometer", "isostudy barometer rank results/barometer"),
        ],
    ),
];

const COLUMNS: usize = 80;
/// Columns of a name and the spaces round it.
const INDENT: usize = 13;

/// Every command's name and its example.
pub(crate) fn examples() -> impl Iterator<Item = (&'static str, &'static str)> {
    GROUPS.iter().flat_map(|(_, commands)| commands.iter().copied())
}

/// The command with its subcommands in groups, and an example in the help of each that has none of its own.
pub(crate) fn grouped(command: Command) -> Command {
    let mut groups = String::new();
    for (heading, commands) in GROUPS {
        groups.push_str(&format!("{heading}\n"));
        for (name, example) in commands {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            for (line, text) in wrapped(&about).iter().enumerate() {
                groups.push_str(&format!("  {:<11}{text}\n", if line == 0 { *name } else { "" }));
            }
            groups.push_str(&format!("{:INDENT$}$ {example}\n", ""));
        }
        groups.push('\n');
    }
    let template = format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{groups}`isostudy help COMMAND` says more of a command.\n\n\
         Options:\n{{options}}\n\n{{after-help}}\n"
    );
    examples().fold(command.help_template(template), |command, (name, example)| {
        command.mut_subcommand(name, |own| match own.get_after_help() {
            Some(_) => own,
            None => own.after_help(format!("Example:\n  {example}")),
        })
    })
}

/// Lines that fit beside the names.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is a first line");
        if line.chars().count() + word.chars().count() < COLUMNS - INDENT {
            line.push_str(if line.is_empty() { "" } else { " " });
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}
