//! What the page asks.

use super::Site;
use super::addresses::Peer;
use crate::cameras::Track;
use crate::journal::{Dealt, Taken, Unsaved};
use crate::record::{Answer, Identifiers, Refusal};
use crate::screen::Screen;
use axum::extract::rejection::JsonRejection;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Why a request was not done; nothing has changed.
pub(super) enum Failure {
    Refused(Refusal),
    Unsaved(Unsaved),
    Malformed(JsonRejection),
    /// The researcher's token is missing or wrong.
    Unauthorised,
    /// The key does not fit the answers.
    Key(crate::export::OtherStudy),
    /// What there is too much of, and when to try again.
    TooMany(&'static str, Duration),
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        let (status, text) = match self {
            // The page tells by the header what the server will never take from what may pass, such as a proxy's 404.
            Self::Refused(refusal) => {
                let status = match refusal {
                    Refusal::UnknownToken => StatusCode::NOT_FOUND,
                    Refusal::OutOfOrder { .. } | Refusal::Answered(_) | Refusal::Unfinished(_) => {
                        StatusCode::CONFLICT
                    }
                    Refusal::Full => StatusCode::FORBIDDEN,
                    Refusal::Crowded => StatusCode::SERVICE_UNAVAILABLE,
                    _ => StatusCode::UNPROCESSABLE_ENTITY,
                };
                return (status, [("isostudy-refusal", refusal.id())], refusal.to_string()).into_response();
            }
            Self::TooMany(what, wait) => {
                let seconds = wait.as_secs_f64().ceil().max(1.0) as u64;
                let text = format!("{what}; try again in {seconds} s");
                let headers = [(header::RETRY_AFTER, seconds.to_string())];
                return (StatusCode::TOO_MANY_REQUESTS, headers, text).into_response();
            }
            Self::Unsaved(unsaved) => (StatusCode::SERVICE_UNAVAILABLE, unsaved.to_string()),
            Self::Malformed(rejection) => (rejection.status(), rejection.body_text()),
            Self::Unauthorised => (StatusCode::UNAUTHORIZED, "the token is missing or wrong".into()),
            Self::Key(other) => (StatusCode::INTERNAL_SERVER_ERROR, other.to_string()),
        };
        (status, text).into_response()
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

impl From<Unsaved> for Failure {
    fn from(unsaved: Unsaved) -> Self {
        Self::Unsaved(unsaved)
    }
}

impl From<JsonRejection> for Failure {
    fn from(rejection: JsonRejection) -> Self {
        Self::Malformed(rejection)
    }
}

type Asked<T> = Result<Json<T>, JsonRejection>;

/// Who begins, and in which language.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Beginning {
    lang: Option<String>,
    prolific_pid: Option<String>,
    study_id: Option<String>,
    session_id: Option<String>,
}

/// `POST /api/sessions`: a form for somebody.
pub(super) async fn begin(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
    asked: Asked<Beginning>,
) -> Result<Json<Dealt>, Failure> {
    let Json(Beginning { lang, prolific_pid, study_id, session_id }) = asked?;
    let identifiers = Identifiers { prolific_pid, study_id, session_id };
    if let Some(sessions) = &site.sessions {
        let taken = sessions.take(site.client(peer, &headers), 0, Instant::now());
        let many = "too many people begin from this address at once";
        taken.map_err(|wait| Failure::TooMany(many, wait))?;
    }
    let machine = Arc::clone(&site.machine);
    Ok(Json(
        site.journal
            .change(move |journal| Ok(journal.begin_in(lang, identifiers, machine.now_ms())))
            .await??,
    ))
}

/// `POST /api/state`: where somebody stands.
pub(super) async fn state(site: Site, asked: Asked<Token>) -> Result<Json<Dealt>, Failure> {
    let Json(Token { token }) = asked?;
    Ok(Json(site.journal.change(move |journal| Ok(journal.state(&token))).await??))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Answered {
    token: String,
    order: u32,
    stimulus: String,
    choice: crate::record::Choice,
    rt_ms: u32,
    /// Pages of an earlier version do not say it.
    #[serde(default)]
    screen: serde_json::Value,
    /// How often it was changed.
    #[serde(default)]
    change: u32,
}

#[derive(Serialize)]
pub(super) struct Saved {
    saved: bool,
}

/// `POST /api/answers`: one answer, acknowledged when it is on disk.
pub(super) async fn answer(site: Site, asked: Asked<Answered>) -> Result<Json<Saved>, Failure> {
    let Json(Answered { token, order, stimulus, choice, rt_ms, screen, change }) = asked?;
    // An answer is worth more than what it was given on: no browser's odd word loses one.
    let screen = serde_json::from_value(screen).ok().filter(Screen::is_sound);
    let answer = Answer { order, stimulus, choice, rt_ms, screen, change };
    let machine = Arc::clone(&site.machine);
    site.journal.change(move |journal| journal.answer(&token, &answer, machine.now_ms())).await??;
    Ok(Json(Saved { saved: true }))
}

/// From where somebody looked at models before an answer.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Looked {
    token: String,
    order: u32,
    #[serde(default)]
    change: u32,
    track: serde_json::Value,
}

/// `POST /api/cameras`: after the answer, acknowledged when it is on disk. What no page can have sent is not kept, and nobody is
/// kept waiting for it.
pub(super) async fn cameras(site: Site, asked: Asked<Looked>) -> Result<Json<Saved>, Failure> {
    let Json(Looked { token, order, change, track }) = asked?;
    let track = serde_json::from_value(track).ok().filter(Track::is_sound);
    if let Some(track) = track {
        site.journal.change(move |journal| journal.track(&token, order, change, &track)).await??;
    }
    Ok(Json(Saved { saved: true }))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Token {
    token: String,
}

/// An answer about the person.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Said {
    token: String,
    id: String,
    value: String,
}

/// What became of it, and what somebody gets who is not asked any further.
#[derive(Serialize)]
pub(super) struct Heard {
    taken: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    completion: Option<String>,
}

/// `POST /api/about`: an answer about the person. It is on disk when somebody's first answer to a pair is.
pub(super) async fn about(site: Site, asked: Asked<Said>) -> Result<Json<Heard>, Failure> {
    let Json(Said { token, id, value }) = asked?;
    let machine = Arc::clone(&site.machine);
    let taken =
        site.journal.change(move |journal| journal.about(&token, &id, &value, machine.now_ms())).await??;
    let completions = &site.settings.completions;
    Ok(Json(match taken {
        Taken::Kept => Heard { taken: "kept", completion: None },
        Taken::ScreenedOut => Heard { taken: "screened", completion: completions.screened.clone() },
        Taken::Full => Heard { taken: "full", completion: completions.full.clone() },
    }))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Receipt {
    receipt: String,
}

#[derive(Serialize)]
pub(super) struct Withdrawn {
    withdrawn: bool,
}

/// `POST /api/withdraw`: deletes all that is kept of whoever has this receipt.
pub(super) async fn withdraw(site: Site, asked: Asked<Receipt>) -> Result<Json<Withdrawn>, Failure> {
    let Json(Receipt { receipt }) = asked?;
    site.journal.change(move |journal| journal.withdraw(&receipt)).await??;
    Ok(Json(Withdrawn { withdrawn: true }))
}

#[derive(Serialize)]
pub(super) struct Completion {
    completion: Option<String>,
}

/// `POST /api/finish`: the end, which is told only to those all of whose answers are on disk.
pub(super) async fn finish(site: Site, asked: Asked<Token>) -> Result<Json<Completion>, Failure> {
    let Json(Token { token }) = asked?;
    let machine = Arc::clone(&site.machine);
    site.journal.change(move |journal| journal.finish(&token, machine.now_ms())).await??;
    Ok(Json(Completion { completion: site.settings.completions.finished.clone() }))
}
