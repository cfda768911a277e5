//! The server of a simulation: the real journal and the real handlers, without a socket and without a thread.

use super::machine::Simulated;
use crate::journal::{Desk, Journal, JournalError, Loss, desk};
use crate::server::{Settings, Shared, addresses::Peer, site};
use axum::body::{Body, to_bytes};
use axum::http::{Request, header};
use hyper::service::Service;
use hyper_util::service::TowerToHyperService;
use std::collections::BTreeSet;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, Wake, Waker};

/// What came back: status and text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Reply {
    pub(super) status: u16,
    pub(super) text: String,
}

type Answering = Pin<Box<dyn Future<Output = Reply>>>;

/// A request on its way through the handlers.
pub(super) struct Pending {
    answering: Answering,
    bell: Arc<Bell>,
}

/// Rings when a handler can go on: while the process lives, or too late.
struct Bell {
    machine: Simulated,
    in_time: AtomicBool,
}

impl Wake for Bell {
    fn wake(self: Arc<Self>) {
        self.in_time.fetch_or(self.machine.state().disk.end().is_none(), Ordering::Relaxed);
    }
}

impl Pending {
    /// Has the handler go as far as it gets.
    fn poll(&mut self) -> Poll<Reply> {
        let waker = Waker::from(Arc::clone(&self.bell));
        self.answering.as_mut().poll(&mut Context::from_waker(&waker))
    }

    /// The reply that left the server while it lived.
    pub(super) fn reply(mut self) -> Option<Reply> {
        match self.poll() {
            Poll::Ready(reply) if self.bell.in_time.load(Ordering::Relaxed) => Some(reply),
            _ => None,
        }
    }
}

pub(super) struct Running {
    machine: Simulated,
    service: TowerToHyperService<axum::Router>,
    desk: Desk,
}

impl Running {
    /// Starts it on what is on the disk. Of 1 to 1000 pages, `log_pages` are those after which a log is merged.
    pub(super) fn start(
        machine: &Simulated,
        settings: &Settings,
        log_pages: u32,
    ) -> Result<Self, JournalError> {
        let Settings { answers, file, digest, .. } = settings;
        let journal = Journal::open_on(Arc::new(machine.clone()), answers, file, digest, Loss::Refuse)?;
        journal.merge_log_after(log_pages);
        let (handle, desk) = desk(journal);
        let shared = Shared::new(settings.clone(), Arc::new(machine.clone()), handle, BTreeSet::new());
        let service = TowerToHyperService::new(site(Arc::new(shared)));
        Ok(Self { machine: machine.clone(), service, desk })
    }

    /// Sends a request: to the researcher's pages with the token, to others with a body.
    pub(super) fn send(&self, path: &str, body: Option<String>) -> Pending {
        let method = if body.is_some() { "POST" } else { "GET" };
        let request = Request::builder()
            .method(method)
            .uri(path)
            .header(header::HOST, "127.0.0.1")
            .header(header::CONTENT_TYPE, "application/json")
            .header(header::AUTHORIZATION, format!("Bearer {}", super::TOKEN))
            .extension(Peer([127, 0, 0, 1].into()))
            .body(body.map_or_else(Body::empty, Body::from))
            .expect("it is a request");
        let answered = self.service.call(request);
        let answering = async move {
            let response = answered.await.expect("handlers do not fail");
            let status = response.status().as_u16();
            let bytes = to_bytes(response.into_body(), usize::MAX).await.expect("it is in memory");
            Reply { status, text: String::from_utf8(bytes.to_vec()).expect("texts") }
        };
        let bell = Arc::new(Bell { machine: self.machine.clone(), in_time: false.into() });
        let mut pending = Pending { answering: Box::pin(answering), bell };
        let early = pending.poll();
        if let Poll::Ready(reply) = early {
            pending.answering = Box::pin(std::future::ready(reply));
            Arc::clone(&pending.bell).wake();
        }
        pending
    }

    /// Does what has arrived, as its thread would.
    pub(super) fn work(&mut self) -> Result<(), JournalError> {
        self.desk.batch(None)
    }

    /// Asks for one thing alone; `None` where the server did not live to answer.
    pub(super) fn ask(&mut self, path: &str) -> Option<Reply> {
        let pending = self.send(path, None);
        self.work().ok()?;
        pending.reply()
    }

    /// Stops it in peace.
    pub(super) fn stop(self) -> Result<(), JournalError> {
        drop(self.service);
        self.desk.close()
    }
}
