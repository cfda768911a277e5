//! A client's socket that does not wait for ever for a client that does not read.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::sync::Mutex;
use std::task::{Context, Poll, ready};
use std::time::{Duration, Instant};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::sync::Notify;
use tokio::time::Sleep;

/// How a connection gets on, for whoever has to choose one to end.
#[derive(Debug)]
pub(super) struct Pace {
    last: Mutex<Last>,
    /// Told when the connection has to end.
    pub(super) cut: Notify,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    /// When bytes moved last.
    moved: Instant,
    /// Whether bytes wait that the client does not take.
    blocked: bool,
}

impl Pace {
    pub(super) fn new() -> Self {
        let last = Mutex::new(Last { moved: Instant::now(), blocked: false });
        Self { last, cut: Notify::new() }
    }

    fn note(&self, change: impl FnOnce(&mut Last)) {
        change(&mut self.last.lock().expect("nothing panics with it"));
    }

    /// When bytes moved last, and whether some wait for the client.
    pub(super) fn last(&self) -> (Instant, bool) {
        let last = *self.last.lock().expect("nothing panics with it");
        (last.moved, last.blocked)
    }
}

/// A stream that can be left without waiting for what was written to it.
pub(super) trait Abort {
    /// Has the kernel throw away what the client has not taken, once the stream is dropped.
    fn abort(&self);
}

impl Abort for TcpStream {
    fn abort(&self) {
        // Refused: then the kernel keeps the bytes for some minutes, as it would by itself.
        drop(self.set_zero_linger());
    }
}

/// A stream whose writes fail once nothing was taken for a while.
pub(super) struct Paced<S: Abort> {
    stream: S,
    pace: Arc<Pace>,
    patience: Duration,
    /// Runs while bytes wait that the client does not take.
    blocked: Option<Pin<Box<Sleep>>>,
}

impl<S: Abort> Drop for Paced<S> {
    fn drop(&mut self) {
        if self.blocked.is_some() {
            self.stream.abort();
        }
    }
}

impl<S: Abort> Paced<S> {
    pub(super) fn new(stream: S, pace: Arc<Pace>, patience: Duration) -> Self {
        Self { stream, pace, patience, blocked: None }
    }

    fn written(
        &mut self,
        context: &mut Context<'_>,
        tried: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        if tried.is_ready() {
            self.blocked = None;
            self.pace.note(|last| *last = Last { moved: Instant::now(), blocked: false });
            return tried;
        }
        self.pace.note(|last| last.blocked = true);
        let patience = self.patience;
        let end = self.blocked.get_or_insert_with(|| Box::pin(tokio::time::sleep(patience)));
        ready!(end.as_mut().poll(context));
        Poll::Ready(Err(io::ErrorKind::TimedOut.into()))
    }
}

impl<S: AsyncRead + Abort + Unpin> AsyncRead for Paced<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        to: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let read = ready!(Pin::new(&mut self.stream).poll_read(context, to));
        self.pace.note(|last| last.moved = Instant::now());
        Poll::Ready(read)
    }
}

impl<S: AsyncWrite + Abort + Unpin> AsyncWrite for Paced<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let tried = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.written(context, tried)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let tried = Pin::new(&mut self.stream).poll_write_vectored(context, bytes);
        self.written(context, tried)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    impl Abort for tokio::io::DuplexStream {
        fn abort(&self) {}
    }

    fn run<T>(work: impl Future<Output = T>) -> T {
        tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(work)
    }

    const PATIENCE: Duration = Duration::from_millis(400);

    #[test]
    fn a_client_that_takes_nothing_is_given_up() {
        run(async {
            let (near, _far) = tokio::io::duplex(64);
            let pace = Arc::new(Pace::new());
            let mut paced = Paced::new(near, Arc::clone(&pace), PATIENCE);
            let failed = tokio::time::timeout(Duration::from_secs(60), paced.write_all(&[7; 65])).await;
            assert_eq!(failed.unwrap().unwrap_err().kind(), io::ErrorKind::TimedOut);
            assert!(pace.last().1);
        });
    }

    /// Each part comes after half of the time; all of it takes far longer than that.
    #[test]
    fn a_slow_client_gets_everything() {
        run(async {
            let (near, mut far) = tokio::io::duplex(64);
            let mut paced = Paced::new(near, Arc::new(Pace::new()), PATIENCE);
            let reader = tokio::spawn(async move {
                let mut part = [0; 64];
                for _ in 0..8 {
                    tokio::time::sleep(PATIENCE / 2).await;
                    far.read_exact(&mut part).await.unwrap();
                }
            });
            paced.write_all(&[7; 8 * 64]).await.unwrap();
            reader.await.unwrap();
        });
    }
}
