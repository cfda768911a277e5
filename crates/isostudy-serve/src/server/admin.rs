//! What the researcher asks, token in hand. Nothing here tells what was chosen by method while the study runs, but the
//! download, which is the researcher's to open.

use super::addresses::Peer;
use super::api::{Failure, now_ms};
use super::{Shared, Site};
use crate::export::{self, HEADER};
use crate::journal::Summary;
use crate::log;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

pub(super) const PAGE: &str = include_str!("../../page/researcher.html");
pub(super) const SCRIPT: &str = include_str!("../../page/researcher.js");

/// Wrong tokens that may wait, half a second each, before one more is refused unseen.
const AHEAD: u32 = 10;

/// Takes as long for a wrong token as for the right one. After ten wrong ones an address may try two a second: whatever it tries
/// waits before it is looked at, so that nothing is gained by not waiting for the reply.
async fn authorised(site: &Shared, peer: Peer, headers: &HeaderMap) -> Result<(), Failure> {
    let address = site.client(peer, headers);
    let wait = site.tries.take(address, AHEAD, Instant::now());
    let wait = wait.map_err(|wait| Failure::TooMany("too many wrong tokens came from this address", wait))?;
    tokio::time::sleep(wait).await;
    let given = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let given = given.and_then(|text| text.strip_prefix("Bearer ")).unwrap_or_default().as_bytes();
    let token = site.settings.admin_token.as_bytes();
    let different = given.iter().chain(std::iter::repeat(&0)).zip(token).fold(0, |all, (a, b)| all | (a ^ b));
    if different == 0 && given.len() == token.len() && !token.is_empty() {
        site.tries.give_back(address);
        return Ok(());
    }
    let wrong = site.wrong_tokens.fetch_add(1, Ordering::Relaxed) + 1;
    // At 1, 2, 4, 8 and so on: whoever tries without end fills no disk.
    if wrong.is_power_of_two() {
        log::note(format!(
            "somebody asked for the researcher's numbers with a wrong token ({wrong} since the start)"
        ));
    }
    Err(Failure::Unauthorised)
}

/// `GET /api/admin/summary`.
pub(super) async fn summary(
    site: Site,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
) -> Result<Json<Summary>, Failure> {
    authorised(&site, peer, &headers).await?;
    let of = Arc::clone(&site);
    Ok(Json(site.journal.read(move |journal| journal.summary(now_ms(), &of.settings.key)).await?))
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
    Ok(csv(export::csv(&lines, &HEADER)))
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
    Ok(csv(export::csv(&rows, &["participant", "PROLIFIC_PID", "STUDY_ID", "SESSION_ID"])))
}

fn csv(text: String) -> Response {
    ([(header::CONTENT_TYPE, "text/csv; charset=utf-8")], text).into_response()
}
