//! Stimuli, which are all but a thousandth of what a server sends.

use super::Site;
use crate::page::MediaFormat;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::Path as Matched;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use hyper::body::Frame;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use tokio::fs::File;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::bytes::BytesMut;
use tokio_util::io::poll_read_buf;
use tokio_util::sync::PollSemaphore;

/// Bytes that are read at a time.
const CHUNK: usize = 16 << 10;
/// Chunks that are read at the same time. When thousands ask at once they queue here, and not in front of people's answers.
const AT_ONCE: usize = 16;

/// Turns for reading chunks.
pub(super) fn turns() -> Arc<Semaphore> {
    Arc::new(Semaphore::new(AT_ONCE))
}

/// A stimulus by its code name: names are looked up, never joined to a path.
pub(super) async fn stimulus(Matched(name): Matched<String>, site: Site) -> Response {
    let known = |kind: MediaFormat| {
        let code = name.strip_suffix(kind.ending())?.strip_suffix('.')?;
        Some((site.stimuli.get(code)?, kind))
    };
    let Some((code, kind)) = site.settings.media.kinds.iter().find_map(|&(kind, ..)| known(kind)) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let path = site.settings.stimuli.join(format!("{code}.{}", kind.ending()));
    match File::open(&path).await {
        Err(_) => StatusCode::NOT_FOUND.into_response(),
        Ok(file) => {
            let length = file.metadata().await.map(|data| data.len()).unwrap_or_default();
            let turns = PollSemaphore::new(Arc::clone(&site.turns));
            let body = Body::new(Chunks { file, turns, turn: None, buffer: BytesMut::new() });
            let headers = [
                (header::CONTENT_TYPE, HeaderValue::from_static(kind.mime())),
                (header::CONTENT_LENGTH, HeaderValue::from(length)),
                (header::CACHE_CONTROL, HeaderValue::from_static("private, max-age=86400")),
            ];
            (headers, body).into_response()
        }
    }
}

/// A file chunk by chunk, each read in its turn.
struct Chunks {
    file: File,
    turns: PollSemaphore,
    turn: Option<OwnedSemaphorePermit>,
    buffer: BytesMut,
}

impl HttpBody for Chunks {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<io::Result<Frame<Bytes>>>> {
        let chunks = self.get_mut();
        if chunks.turn.is_none() {
            chunks.turn = ready!(chunks.turns.poll_acquire(context));
        }
        chunks.buffer.reserve(CHUNK);
        let read = ready!(poll_read_buf(Pin::new(&mut chunks.file), context, &mut chunks.buffer));
        chunks.turn = None;
        Poll::Ready(match read {
            Ok(0) => None,
            Ok(_) => Some(Ok(Frame::data(chunks.buffer.split().freeze()))),
            Err(error) => Some(Err(error)),
        })
    }
}
