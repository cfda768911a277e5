//! The server: HTTP on a socket, the page, the stimuli, and what the page may ask.

mod addresses;
mod admin;
mod api;
mod connections;
mod host;
mod limits;
mod pace;
mod stimuli;
mod stopping;

#[cfg(test)]
mod simulation;

pub use host::{NoPublicUrl, PublicUrl};
pub use limits::Limits;
pub use stopping::{Judge, Rule};

use crate::cameras;
use crate::completions::Completions;
use crate::journal::{self, Chooser, Handle, Held, Journal, JournalError, Loss};
use crate::machine::{Machine, System};
use crate::page::{self, LibraryFile, Media, Served, forms_js};
use addresses::{Budgets, Peer};
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, Path as Matched, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use isostudy_design::config::Panel;
use isostudy_design::forms::{ANY_FORM, FormFile, KeyEntry, Quotas};
use std::collections::BTreeSet;
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::Duration;
use tokio::sync::Semaphore;
use tower_http::set_header::SetResponseHeaderLayer;

/// Bytes that a researcher's token has at least. Tries are not slowed down for whoever has the right one, so that it must not be found
/// by trying.
pub const SHORTEST_TOKEN: usize = 16;

/// What is served, and where.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The forms.
    pub file: FormFile,
    /// What they show.
    pub key: Vec<KeyEntry>,
    /// Digest of the forms, which tells one version of a study from another.
    pub digest: String,
    /// Folder of the stimuli.
    pub stimuli: PathBuf,
    /// In what files they are.
    pub media: Media,
    /// Files that draw models, where they are shown.
    pub library: Vec<LibraryFile>,
    /// Folder of the answers.
    pub answers: PathBuf,
    /// Where to listen.
    pub address: SocketAddr,
    /// What the researcher's page asks for: of at least [`SHORTEST_TOKEN`] bytes, else nobody is let in.
    pub admin_token: String,
    /// What people get at the end.
    pub completions: Completions,
    /// Who sends people.
    pub panel: Panel,
    /// How many people the study takes.
    pub quotas: Quotas,
    /// What chooses questions of newcomers, in a study that asks each person where an answer tells most.
    pub chooser: Option<Chooser>,
    /// When a study that runs is looked at.
    pub rule: Option<Rule>,
    /// Values of the questions that check attention.
    pub attention: Vec<(String, String)>,
    /// Where participants reach the server, if not at the address where it listens. There is a proxy on this machine then, which tells
    /// whose requests it hands on.
    pub public_url: Option<PublicUrl>,
    /// What a client may cost.
    pub limits: Limits,
    /// What to do where there are fewer answers than there were.
    pub loss: Loss,
}

/// Why the server did not run, or stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The answers.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The socket.
    #[error("{address}: {source}")]
    Socket {
        /// Which.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// A stimulus is not there.
    #[error("{0}: not there; make the bundle first")]
    Stimulus(PathBuf),
    /// The system.
    #[error(transparent)]
    System(#[from] std::io::Error),
}

struct Shared {
    machine: Arc<dyn Machine>,
    settings: Settings,
    journal: Handle,
    index: Bytes,
    forms_js: Bytes,
    stimuli: BTreeSet<String>,
    turns: Arc<Semaphore>,
    /// New sessions of an address; `None` for any number.
    sessions: Option<Budgets>,
    /// Wrong researcher's tokens of an address.
    tries: Budgets,
    wrong_tokens: AtomicU64,
    /// What the looks of a stopping rule said.
    looked: stopping::Looked,
}

impl Shared {
    fn new(
        settings: Settings,
        machine: Arc<dyn Machine>,
        journal: Handle,
        stimuli: BTreeSet<String>,
    ) -> Self {
        let most = settings.limits.sessions_per_address;
        Self {
            index: Bytes::from(page::index(&settings.file)),
            forms_js: Bytes::from(forms_js(
                &settings.file,
                &settings.digest,
                &settings.media,
                Some(Served { panel: settings.panel, completions: &settings.completions }),
            )),
            settings,
            machine,
            journal,
            stimuli,
            turns: stimuli::turns(),
            sessions: (most > 0).then(|| Budgets::new(most, SESSIONS_BACK)),
            tries: Budgets::new(TRIES.0, TRIES.1),
            wrong_tokens: AtomicU64::new(0),
            looked: stopping::Looked::default(),
        }
    }

    /// Whoever sent a request.
    fn client(&self, peer: Peer, headers: &HeaderMap) -> IpAddr {
        addresses::client(peer, headers, self.settings.public_url.is_some())
    }
}

/// In what time an address may begin as many sessions again.
const SESSIONS_BACK: Duration = Duration::from_secs(100);
/// Wrong tokens at once, and in what time they come back.
const TRIES: (u32, Duration) = (10, Duration::from_secs(5));

/// Largest body of cameras: their JSON and whose they are.
const CAMERAS_BODY: usize = cameras::LARGEST + 1000;

type Site = State<Arc<Shared>>;

/// Serves until the process is told to stop (interrupt or terminate), then answers what has arrived and returns. `ready` is
/// called with the address once it listens, and with how much the folder of answers holds.
///
/// # Errors
/// [`ServeError`]; also when answers can no longer be kept, in which case whatever was acknowledged is on disk.
pub fn serve(settings: Settings, ready: impl FnOnce(SocketAddr, Held)) -> Result<(), ServeError> {
    let anywhere = settings.key.iter().filter(|of| of.form == ANY_FORM).map(|of| &of.stimulus);
    let stimuli: BTreeSet<String> = settings
        .file
        .forms
        .iter()
        .flat_map(|form| form.training.iter().chain(&form.questions))
        .chain(anywhere)
        .cloned()
        .collect();
    for code in &stimuli {
        for (kind, ..) in &settings.media.kinds {
            let path = settings.stimuli.join(format!("{code}.{}", kind.ending()));
            if !path.is_file() {
                return Err(ServeError::Stimulus(path));
            }
        }
    }
    if settings.media.kinds.is_empty() {
        return Err(ServeError::Stimulus(settings.stimuli));
    }
    let machine = Arc::new(System);
    let mut journal = Journal::open(&settings.answers, &settings.file, &settings.digest, settings.loss)?;
    journal.limit(settings.quotas.clone());
    if let Some(chooser) = &settings.chooser {
        journal.choose_by(chooser.clone());
    }
    let held = journal.held();
    if journal.is_uncounted() {
        machine.note(format!(
            "warning: {} holds {held}, but its file `count` is missing or empty, so nobody can tell whether answers are missing; \
             it is written anew",
            settings.answers.display()
        ));
    }
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let (handle, mut keeper) = journal::start(journal);
    let Settings { address, limits, .. } = settings;
    let shared = Arc::new(Shared::new(settings, machine, handle, stimuli));
    let served = runtime.block_on(async {
        let listener = limits::listen(address)?;
        ready(listener.local_addr()?, held);
        limits::run(listener, site(shared), limits.stalled, keeper.ended()).await
    });
    // Tasks hold ways to the journal; without them its thread ends, with everything on disk.
    drop(runtime);
    keeper.join()?;
    served.map_err(|source| ServeError::Socket { address, source })
}

fn site(shared: Arc<Shared>) -> Router {
    let fixed = |name: &'static str, value: &'static str| {
        SetResponseHeaderLayer::overriding(HeaderName::from_static(name), HeaderValue::from_static(value))
    };
    let asked = Router::new()
        .route("/api/sessions", post(api::begin))
        .route("/api/state", post(api::state))
        .route("/api/answers", post(api::answer))
        .route("/api/cameras", post(api::cameras).layer(DefaultBodyLimit::max(CAMERAS_BODY)))
        .route("/api/about", post(api::about))
        .route("/api/finish", post(api::finish))
        .route("/api/withdraw", post(api::withdraw))
        .route("/api/admin/summary", get(admin::summary))
        .route("/api/admin/answers.csv", get(admin::answers))
        .route("/api/admin/identities.csv", get(admin::identities))
        .route("/api/admin/about.csv", get(admin::about))
        .route("/api/admin/cameras.csv", get(admin::cameras))
        .route("/api/admin/shown.json", get(admin::shown))
        .layer(fixed("cache-control", "no-store"));
    let pages = Router::new()
        .route("/", get(|site: Site| async move { file("index.html", &site) }))
        .route("/{name}", get(|Matched(name): Matched<String>, site: Site| async move { file(&name, &site) }))
        .route("/stimuli/{name}", get(stimuli::stimulus));
    limits::limited(asked.merge(pages))
        .layer(axum::middleware::from_fn_with_state(Arc::clone(&shared), host::check))
        .layer(fixed("x-content-type-options", "nosniff"))
        .layer(fixed("referrer-policy", "no-referrer"))
        .layer(fixed(
            "content-security-policy",
            "default-src 'self'; img-src 'self' blob: data:; media-src 'self' blob:; frame-ancestors 'none'; form-action 'none'; base-uri 'none'",
        ))
        .with_state(shared)
}

fn file(name: &str, site: &Shared) -> Response {
    match name {
        "index.html" => typed("text/html; charset=utf-8", site.index.clone()),
        "forms.js" => typed("text/javascript; charset=utf-8", site.forms_js.clone()),
        "researcher" => typed("text/html; charset=utf-8", admin::PAGE),
        "replay" => typed("text/html; charset=utf-8", admin::REPLAY),
        "replay.js" => typed("text/javascript; charset=utf-8", admin::REPLAY_SCRIPT),
        "researcher.js" => typed("text/javascript; charset=utf-8", admin::SCRIPT),
        name => library_file(name, site).unwrap_or_else(|| page_file(name)),
    }
}

/// What draws models, in a study that shows them.
fn library_file(name: &str, site: &Shared) -> Option<Response> {
    let found = site.settings.library.iter().find(|file| file.name == name)?;
    Some(typed(found.mime, found.content.clone()))
}

fn page_file(name: &str) -> Response {
    match page::FILES.iter().find(|file| file.0 == name) {
        Some(&(_, mime, text)) => typed(mime, text),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

fn typed(mime: &'static str, text: impl Into<Body>) -> Response {
    ([(header::CONTENT_TYPE, mime), (header::CACHE_CONTROL, "no-cache")], text.into()).into_response()
}
