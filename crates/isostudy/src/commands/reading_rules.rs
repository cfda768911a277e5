//! How the commands that read answers are told to.

use crate::input;
use anyhow::Result;
use clap::Args;
use clap::builder::PossibleValuesParser;
use isostudy_design::Study;
use isostudy_design::config::ResponsesSection;
use std::path::PathBuf;

/// How a file of answers is read, where that differs from what the study declares.
#[derive(Debug, Clone, Args)]
pub(crate) struct ReadingRules {
    /// Format of the answers [default: detected]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(isostudy_responses::Format::ALL.map(isostudy_responses::Format::name)))]
    format: Option<String>,
    /// TOML file with the keys of a study's [responses]: question columns, synonyms, pairs
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
}

impl ReadingRules {
    /// What the command line declares on top of what the study does.
    ///
    /// # Errors
    /// If the mapping cannot be read.
    pub(super) fn section(&self, study: Option<&Study>) -> Result<ResponsesSection> {
        let declared = || study.and_then(|study| study.file.responses.clone()).unwrap_or_default();
        self.mapping.as_deref().map_or(Ok(()), input::regular)?;
        let mut section = self.mapping.as_deref().map_or_else(|| Ok(declared()), ResponsesSection::load)?;
        if self.format.is_some() {
            section.format.clone_from(&self.format);
        }
        Ok(section)
    }
}
