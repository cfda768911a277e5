//! Instructions of two builds, counted one after the other: is the new one dearer?

use super::brief::{change, listed};
use isostudy_design::ConfigurationId;
use isostudy_design::record::AbProgram;
use isostudy_table::digits::counted;
use isostudy_table::{Cell, Columns, Table};
use serde::{Deserialize, Serialize};

/// What was counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CountRun {
    /// Version of this layout; [`CountRun::SCHEMA`].
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// The program that the other is compared with.
    pub old: AbProgram,
    /// The program that is judged.
    pub new: AbProgram,
    /// By configuration, in the study's order.
    pub rows: Vec<CountRow>,
}

/// Instructions of one extraction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CountRow {
    /// Of which configuration.
    pub id: ConfigurationId,
    /// By the old program.
    pub old: u64,
    /// By the new one.
    pub new: u64,
}

impl CountRow {
    /// New over old.
    pub fn ratio(&self) -> f64 {
        self.new as f64 / self.old as f64
    }
}

impl CountRun {
    /// The version of the layout that is written and read here.
    pub const SCHEMA: u32 = 1;

    /// The geometric mean over all configurations of new over old.
    pub fn together(&self) -> f64 {
        let logs: f64 = self.rows.iter().map(|row| row.ratio().ln()).sum();
        (logs / self.rows.len() as f64).exp()
    }

    /// Configurations that take more instructions by more than a share.
    pub fn dearer(&self, relative: f64) -> Vec<&CountRow> {
        self.rows.iter().filter(|row| row.ratio() > 1.0 + relative).collect()
    }

    /// What was found, in two lines.
    pub fn brief(&self, relative: f64) -> Vec<String> {
        let configurations = counted(self.rows.len(), "configuration");
        let together = change(self.together());
        let named =
            self.dearer(relative).into_iter().map(|row| format!("{} {}", row.id, change(row.ratio())));
        let named: Vec<String> = named.collect();
        let second = match named.is_empty() {
            true => format!("No configuration takes {} more.", change(1.0 + relative)),
            false => format!("Dearer: {}.", listed(named)),
        };
        vec![format!("Instructions of NEW against OLD, {configurations}: {together} together."), second]
    }

    /// Every row.
    pub fn table(&self) -> Table {
        let table = Columns::over(&self.rows)
            .column("id", "Id", |row| Cell::text(&row.id))
            .column("old", "Old", |row| Cell::count(row.old))
            .column("new", "New", |row| Cell::count(row.new))
            .column("ratio", "New / old", |row| Cell::Number(row.ratio(), 4))
            .into_table("bench_count", "Instructions of an extraction, new against old");
        table.with_note(
            "Counted by valgrind on one thread, in a process that has extracted before. Instructions say nothing of memory, of branches \
             or of threads that wait.",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dearer_is_named() {
        let program = |sha256: &str| AbProgram { path: "isostudy".into(), sha256: sha256.into(), links: 1 };
        let row = |id: &str, old, new| CountRow { id: id.parse().unwrap(), old, new };
        let run = CountRun {
            schema: CountRun::SCHEMA,
            study: "made up".into(),
            old: program("a"),
            new: program("b"),
            rows: vec![row("ss_bi", 1000, 1100), row("ss_su", 1000, 1000), row("ss_bu", 2000, 1990)],
        };
        assert!((run.together() - (1.1_f64 * 0.995).cbrt()).abs() < 1e-12);
        assert_eq!(run.dearer(0.01).iter().map(|row| row.id.to_string()).collect::<Vec<_>>(), ["ss_bi"]);
        let lines = run.brief(0.01);
        assert!(lines[1].starts_with("Dearer: ss_bi +10.0 %"), "{lines:?}");
        assert!(run.dearer(0.1).is_empty() && run.brief(0.1)[1].contains("No configuration"));
        assert_eq!(run.table().rows.len(), 3);
    }
}
