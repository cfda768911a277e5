//! `isostudy serve`: the questionnaire on the web, for as long as it runs.

use super::adaptive;
use super::bundle::{self, Made, stimuli, videos};
use super::checked_study;
use super::stopping;
use super::study_forms::{forms, no_forms};
use super::study_run::Run;
use crate::kept_answers;
use crate::outcome::Outcome;
use crate::pipeline::Videos;
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_design::forms::Questionnaire;
use isostudy_serve::journal::Loss;
use isostudy_serve::page::MediaFormat;
use isostudy_serve::{Completions, Limits, SHORTEST_TOKEN, Settings};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
    /// Folder of the answers, which are never among the results [default: answers/<study id>]
    #[arg(long, value_name = "DIR")]
    answers: Option<PathBuf>,
    /// Go on where `design check` finds faults
    #[arg(long)]
    with_faults: bool,
    /// Address to listen on; 0.0.0.0 lets others in
    #[arg(long, value_name = "IP", default_value = "127.0.0.1")]
    address: std::net::IpAddr,
    /// Port to listen on; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 8080)]
    port: u16,
    /// Where participants reach the server, behind a web server on this machine or under a name, such as https://study.example.org
    #[arg(long, value_name = "URL")]
    public_url: Option<isostudy_serve::PublicUrl>,
    /// People of one address that may begin at once, and in each further 100 seconds; 0 for any number
    #[arg(long, value_name = "N", default_value_t = isostudy_serve::Limits::default().sessions_per_address)]
    sessions_per_address: u32,
    /// Start although the folder holds fewer answers than it did
    #[arg(long)]
    accept_loss: bool,
    /// What the researcher's page asks for, at least 16 characters [default: a new one, printed]
    #[arg(long, value_name = "TOKEN", env = "ISOSTUDY_ADMIN_TOKEN", hide_env_values = true)]
    admin_token: Option<String>,
}

/// Makes the bundle and serves it until told to stop.
///
/// # Errors
/// If the bundle cannot be made, or the server cannot run.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = checked_study::load(&arguments.run.study)?;
    let (file, key, digest) = forms(&study)?;
    let wanted = |out: &Path| {
        Ok(match () {
            () if videos(out, MediaFormat::Mp4)? > 0 => Videos::Made(MediaFormat::Mp4),
            () if videos(out, MediaFormat::WebM)? > 0 => Videos::Made(MediaFormat::WebM),
            () => Videos::Needed,
        })
    };
    let Some(Made { out, media, library }) = bundle::make(&arguments.run, wanted, arguments.with_faults)?
    else {
        return Ok(Outcome::CheckFailed);
    };
    let admin_token = match &arguments.admin_token {
        Some(token) if token.len() < SHORTEST_TOKEN => {
            bail!("--admin-token: at least {SHORTEST_TOKEN} characters")
        }
        Some(token) => token.clone(),
        None => isostudy_serve::random_hex(16),
    };
    let section = study.file.forms.as_ref().with_context(|| no_forms(&study.path))?;
    let questionnaire = Questionnaire::of(&study).with_context(|| no_forms(&study.path))?;
    let settings = Settings {
        completions: Completions {
            finished: section.completion.clone(),
            screened: section.completion_screened.clone(),
            withdrawn: section.completion_withdrawn.clone(),
            full: section.completion_full.clone(),
        },
        panel: section.panel,
        quotas: questionnaire.quotas(),
        attention: questionnaire.attention(),
        chooser: adaptive::chooser(&study),
        rule: stopping::rule(&study, &file, &key),
        media,
        library,
        stimuli: stimuli(&out),
        answers: kept_answers::folder(&study, arguments.answers.as_ref()),
        address: SocketAddr::new(arguments.address, arguments.port),
        admin_token: admin_token.clone(),
        file,
        key,
        digest,
        public_url: arguments.public_url.clone(),
        limits: Limits { sessions_per_address: arguments.sessions_per_address, ..Limits::default() },
        loss: if arguments.accept_loss { Loss::Accept } else { Loss::Refuse },
    };
    let answers = settings.answers.clone();
    // It has an end of its own, at which answers are on disk.
    isostudy_foreign::leave_signals_to_others();
    isostudy_serve::serve(settings, |address, held| {
        let reached = arguments.public_url.as_ref().map_or(format!("http://{address}"), ToString::to_string);
        tell!("questionnaire   {reached}/");
        tell!("researcher      {reached}/researcher");
        if arguments.public_url.is_some() {
            tell!("listens on      http://{address}/");
        }
        if arguments.admin_token.is_none() {
            tell!("token           {admin_token}");
        }
        tell!("answers         {}", answers.display());
        tell!("holds           {held}");
        tell!("Ctrl-C stops it; what was acknowledged is on disk.");
    })?;
    Ok(Outcome::Done)
}
