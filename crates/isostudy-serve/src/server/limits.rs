//! What a client may cost: bytes, time, connections.

use super::addresses::Peer;
use super::connections::Connections;
use super::pace::Paced;
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::StatusCode;
use hyper::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::Service;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::io;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::net::{TcpListener, TcpSocket};
use tokio::signal::unix::{SignalKind, signal};
use tower_http::timeout::TimeoutLayer;

/// Largest body of a request; an answer takes 150 bytes.
const BODY: usize = 4096;
/// Longest time for the head of a request, and for all of one but writing its response.
const PATIENCE: Duration = Duration::from_secs(10);
/// How long a stopping server waits for what has begun.
const GRACE: Duration = Duration::from_secs(5);
/// Connections at a time, where the system allows as many files; for one more, one that is stuck or silent ends.
const CONNECTIONS: usize = 4096;
/// Files of a connection: its socket, and the stimulus that it is sent.
const FILES: usize = 2;
/// Files of everything else.
const OTHER_FILES: usize = 64;
/// Most bytes of a head, and of a response that wait in memory for a client to take them.
const BUFFER: usize = 16 << 10;
/// Most bytes that wait in the kernel to be sent to a client. All sockets of a system share its memory, which a few thousand clients
/// that do not read would else fill with 400 KB and more each: everybody's answers stopped for minutes.
#[cfg(target_os = "linux")]
const UNSENT: u32 = 16 << 10;
/// Most clients that wait to be let in.
const BACKLOG: u32 = 4096;

/// What may be set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// How long a client may take nothing of a response that waits for it.
    pub stalled: Duration,
    /// New sessions of one address at once, and in each further 100 seconds; 0 for any number.
    pub sessions_per_address: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { stalled: Duration::from_secs(30), sessions_per_address: 1000 }
    }
}

pub(super) fn limited<S: Clone + Send + Sync + 'static>(router: Router<S>) -> Router<S> {
    router
        .layer(DefaultBodyLimit::max(BODY))
        .layer(TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, PATIENCE))
}

/// A socket whose connections have bounded buffers.
pub(super) fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = if address.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    socket.set_reuseaddr(true)?;
    // What is accepted has it too. Bytes on their way do not count, so that nobody who reads is slowed down.
    #[cfg(target_os = "linux")]
    socket2::SockRef::from(&socket).set_tcp_notsent_lowat(UNSENT)?;
    socket.bind(address)?;
    socket.listen(BACKLOG)
}

/// Connections for which there are files; asks for more files where they are few.
fn places() -> usize {
    let needed = (CONNECTIONS * FILES + OTHER_FILES) as u64;
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    let wanted = maximum.map_or(needed, |most| most.min(needed));
    if current.is_some_and(|current| current < wanted) {
        // Refused: then there are as many as there were.
        let _ = setrlimit(Resource::Nofile, Rlimit { current: Some(wanted), maximum });
    }
    let files = getrlimit(Resource::Nofile).current.unwrap_or(needed).min(needed) as usize;
    (files.saturating_sub(OTHER_FILES) / FILES).max(1)
}

/// Hands on requests with the address that they come from.
struct From<S> {
    inner: S,
    peer: Peer,
}

impl<S: Service<Request<Incoming>>> Service<Request<Incoming>> for From<S> {
    type Response = S::Response;
    type Error = S::Error;
    type Future = S::Future;

    fn call(&self, mut request: Request<Incoming>) -> S::Future {
        request.extensions_mut().insert(self.peer);
        self.inner.call(request)
    }
}

/// Serves until an interrupt or a terminate signal, or until `ended` does.
pub(super) async fn run(
    listener: TcpListener,
    router: Router,
    stalled: Duration,
    ended: impl Future<Output = ()>,
) -> io::Result<()> {
    let (mut interrupt, mut terminate) = (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
    let connections = Connections::new(places());
    let graceful = GracefulShutdown::new();
    tokio::pin!(ended);
    loop {
        let accepted = async {
            let (stream, address) = listener.accept().await?;
            Ok::<_, io::Error>((stream, address.ip(), connections.enter(address.ip()).await))
        };
        let (stream, address, guest) = tokio::select! {
            accepted = accepted => match accepted {
                Ok(accepted) => accepted,
                Err(_) => {
                    // Too many open files, say, of other programs.
                    connections.end_one();
                    tokio::time::sleep(Duration::from_millis(10)).await;
                    continue;
                }
            },
            _ = interrupt.recv() => break,
            _ = terminate.recv() => break,
            () = &mut ended => break,
        };
        let service = From { inner: TowerToHyperService::new(router.clone()), peer: Peer(address) };
        let stream = Paced::new(stream, guest.pace.clone(), stalled);
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(PATIENCE)
            .max_buf_size(BUFFER)
            .serve_connection(TokioIo::new(stream), service);
        let connection = graceful.watch(connection);
        tokio::spawn(async move {
            tokio::select! {
                // An error here is a client that went away.
                _ = connection => {}
                () = guest.pace.cut.notified() => {}
            }
            drop(guest);
        });
    }
    drop(listener);
    tokio::select! {
        () = graceful.shutdown() => {}
        () = tokio::time::sleep(GRACE) => {}
    }
    Ok(())
}
