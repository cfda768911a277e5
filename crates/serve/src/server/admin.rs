//! What the researcher asks, token in hand. Nothing here tells what was chosen by method while the study runs, but the
//! download, which is the researcher's to open.

use super::Site;
use super::api::{Failure, now_ms};
use crate::export::{self, HEADER};
use crate::journal::Summary;
use axum::Json;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

pub(super) const PAGE: &str = include_str!("../../page/researcher.html");
pub(super) const SCRIPT: &str = include_str!("../../page/researcher.js");

/// Takes as long for a wrong token as for the right one.
fn authorised(headers: &HeaderMap, token: &str) -> Result<(), Failure> {
    let given = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let given = given.and_then(|text| text.strip_prefix("Bearer ")).unwrap_or_default().as_bytes();
    let token = token.as_bytes();
    let different = given.iter().chain(std::iter::repeat(&0)).zip(token).fold(0, |all, (a, b)| all | (a ^ b));
    if different == 0 && given.len() == token.len() && !token.is_empty() {
        Ok(())
    } else {
        Err(Failure::Unauthorised)
    }
}

/// `GET /api/admin/summary`.
pub(super) async fn summary(site: Site, headers: HeaderMap) -> Result<Json<Summary>, Failure> {
    authorised(&headers, &site.settings.admin_token)?;
    let of = Arc::clone(&site);
    Ok(Json(site.journal.change(move |journal| journal.summary(now_ms(), &of.settings.key)).await?))
}

/// `GET /api/admin/answers.csv`: the long format.
pub(super) async fn answers(site: Site, headers: HeaderMap) -> Result<Response, Failure> {
    authorised(&headers, &site.settings.admin_token)?;
    let given = site.journal.change(|journal| journal.given()).await?;
    let lines = export::lines(&given, &site.settings.key).map_err(Failure::Key)?;
    Ok(csv(export::csv(&lines, &HEADER)))
}

/// `GET /api/admin/identities.csv`: what a panel says of participants.
pub(super) async fn identities(site: Site, headers: HeaderMap) -> Result<Response, Failure> {
    authorised(&headers, &site.settings.admin_token)?;
    let all = site.journal.change(|journal| journal.identities()).await?;
    let rows: Vec<_> =
        all.iter().map(|(name, of)| (name, &of.prolific_pid, &of.study_id, &of.session_id)).collect();
    Ok(csv(export::csv(&rows, &["participant", "PROLIFIC_PID", "STUDY_ID", "SESSION_ID"])))
}

fn csv(text: String) -> Response {
    ([(header::CONTENT_TYPE, "text/csv; charset=utf-8")], text).into_response()
}
