//! What the researcher asks, token in hand. Nothing here tells what was chosen by method while the study runs, but the
//! download, which is the researcher's to open, and what a stopping rule says that the study declared.

use super::addresses::Peer;
use super::api::Failure;
use super::stopping::{self, Standing};
use super::{SHORTEST_TOKEN, Settings, Shared, Site};
use crate::export;
use crate::journal::{Journal, OptionCount, Summary};
use crate::{people, shown};
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use isostudy_design::forms::FormFile;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

pub(super) const PAGE: &str = include_str!("../../page/researcher.html");
pub(super) const SCRIPT: &str = include_str!("../../page/researcher.js");
pub(super) const REPLAY: &str = include_str!("../../page/replay.html");
pub(super) const REPLAY_SCRIPT: &str = include_str!("../../page/replay.js");

/// Wrong tokens of a client that may wait, half a second each, before one more is refused at once.
const AHEAD: u32 = 10;

/// The right token is accepted at once, whatever others of the same address try: it cannot be guessed
/// ([`SHORTEST_TOKEN`](super::SHORTEST_TOKEN)), so that nothing is gained by delaying it. Wrong ones are counted by client. After ten,
/// the reply to one more waits for half a second, and of many at a time most are refused at once.
async fn authorised(site: &Shared, peer: Peer, headers: &HeaderMap) -> Result<(), Failure> {
    let given = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let given = given.and_then(|text| text.strip_prefix("Bearer ")).unwrap_or_default();
    if is_token(given.as_bytes(), site.settings.admin_token.as_bytes()) {
        return Ok(());
    }
    let wrong = site.wrong_tokens.fetch_add(1, Ordering::Relaxed) + 1;
    // At 1, 2, 4, 8 and so on: whoever tries without end fills no disk.
    if wrong.is_power_of_two() {
        site.machine.note(format!(
            "somebody asked for the researcher's numbers with a wrong token ({wrong} since the start)"
        ));
    }
    let wait = site.tries.take(site.client(peer, headers), AHEAD, Instant::now());
    let wait = wait.map_err(|wait| Failure::TooMany("too many wrong tokens came from this address", wait))?;
    tokio::time::sleep(wait).await;
    Err(Failure::Unauthorised)
}

/// Takes as long for a wrong token as for the right one.
fn is_token(given: &[u8], token: &[u8]) -> bool {
    let different = given.iter().chain(std::iter::repeat(&0)).zip(token).fold(0, |all, (a, b)| all | (a ^ b));
    different == 0 && given.len() == token.len() && token.len() >= SHORTEST_TOKEN
}

/// How the study stands, for the page.
#[derive(Debug, Serialize)]
pub(super) struct Stand {
    title: String,
    /// By question about the person and option, in the order of [`Summary::options`]: the words that people read.
    words: Vec<[String; 2]>,
    #[serde(flatten)]
    summary: Summary,
    /// What a declared stopping rule says.
    stopping: Option<Standing>,
}

/// `GET /api/admin/summary`.
pub(super) async fn summary(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Json<Stand>, Failure> {
    authorised(&site, peer, &headers).await?;
    let of = Arc::clone(&site);
    let read = move |journal: &Journal| {
        let summary = journal.summary(of.machine.now_ms(), &of.settings.key)?;
        Ok((summary, journal.finished()?))
    };
    let (summary, finished) = site.journal.read(read).await?;
    let stopping = match &site.settings.rule {
        Some(rule) => Some(stopping::standing(&site, rule, finished).await?),
        None => None,
    };
    let file = &site.settings.file;
    let words = words(file, &summary.options);
    Ok(Json(Stand { title: file.title.clone(), words, summary, stopping }))
}

/// A question about the person and one of its options, in the study's first language.
fn words(file: &FormFile, options: &[OptionCount]) -> Vec<[String; 2]> {
    let spoken = file.spoken();
    let say = |key: &str| spoken.first().and_then(|first| first.texts.get(key)).cloned().unwrap_or_default();
    let of = |option: &OptionCount| {
        let text = file.about.iter().find(|about| about.id == option.question).map(|about| &about.text);
        let text = text.map_or("", String::as_str);
        [say(text), say(&format!("{text}_{}", option.option))]
    };
    options.iter().map(of).collect()
}

/// `GET /api/admin/answers.csv`: the long format.
pub(super) async fn answers(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    authorised(&site, peer, &headers).await?;
    let given = site.journal.read(|journal| journal.given()).await?;
    let lines = export::lines(&given, &site.settings.key).map_err(Failure::Key)?;
    Ok(csv(export::csv(&lines, &export::header(site.settings.file.way))))
}

/// `GET /api/admin/identities.csv`: what a panel says of participants.
pub(super) async fn identities(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    authorised(&site, peer, &headers).await?;
    let all = site.journal.read(|journal| journal.identities()).await?;
    let rows: Vec<_> =
        all.iter().map(|(name, of)| (name, &of.prolific_pid, &of.study_id, &of.session_id)).collect();
    // A panel that has one code for the person and the session fills both columns with it.
    let [person, study, session] = site.settings.panel.names();
    let unused = |name: Option<&'static str>| name.unwrap_or("unused");
    let again = if person == session { "session" } else { unused(session) };
    Ok(csv(export::csv(&rows, &["participant", unused(person), unused(study), again])))
}

/// `GET /api/admin/about.csv`: what people said about themselves.
pub(super) async fn about(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    authorised(&site, peer, &headers).await?;
    let all = site.journal.read(|journal| journal.all_about()).await?;
    Ok(csv(people::about_csv(&site.settings.file, &site.settings.attention, &all)))
}

/// `GET /api/admin/cameras.csv`: from where people looked at models.
pub(super) async fn cameras(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    authorised(&site, peer, &headers).await?;
    let all = site.journal.read(|journal| journal.cameras()).await?;
    Ok(csv(crate::cameras::csv(&all, &site.settings.key)))
}

/// `GET /api/admin/shown.json`: what was shown to whom.
pub(super) async fn shown(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    authorised(&site, peer, &headers).await?;
    let read = |journal: &Journal| Ok((journal.given()?, journal.languages()?, journal.departures()?));
    let (given, languages, departures) = site.journal.read(read).await?;
    let Settings { file, digest, key, .. } = &site.settings;
    let text = shown::json(file, digest, &given, key, &languages, departures);
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

fn csv(text: String) -> Response {
    ([(header::CONTENT_TYPE, "text/csv; charset=utf-8")], text).into_response()
}
