//! The names that a server answers to. A page elsewhere can give its own name this machine's address (DNS rebinding) and would
//! then be taken for the questionnaire's own; it cannot change the name that the browser sends.

use super::Shared;
use axum::extract::{Request, State};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::fmt;
use std::net::IpAddr;
use std::str::FromStr;
use std::sync::Arc;

/// The address under which participants reach the server, such as `https://study.example.org`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublicUrl {
    text: String,
    name: String,
}

/// Not an address of a site.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("allowed: https:// or http:// and a name, such as https://study.example.org")]
pub struct NoPublicUrl;

impl FromStr for PublicUrl {
    type Err = NoPublicUrl;

    fn from_str(text: &str) -> Result<Self, NoPublicUrl> {
        let uri: Uri = text.parse().map_err(|_| NoPublicUrl)?;
        let web = matches!(uri.scheme_str(), Some("http" | "https"));
        let named = uri.authority().filter(|authority| web && !authority.as_str().contains('@'));
        let name = plain(named.ok_or(NoPublicUrl)?).to_owned();
        Ok(Self { text: text.trim_end_matches('/').to_owned(), name })
    }
}

impl fmt::Display for PublicUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A host without what may be written in two ways.
fn plain(authority: &Authority) -> &str {
    authority.host().trim_start_matches('[').trim_end_matches(']').trim_end_matches('.')
}

/// Whether a request is meant for a server that listens there. Ports are not compared: they may be forwarded, and no page elsewhere
/// is known by one.
fn admits(headers: &HeaderMap, listening: IpAddr, public: Option<&PublicUrl>) -> bool {
    let mut hosts = headers.get_all(header::HOST).iter();
    let (Some(host), None) = (hosts.next(), hosts.next()) else { return false };
    let Some(authority) = host.to_str().ok().and_then(|host| host.parse::<Authority>().ok()) else {
        return false;
    };
    let name = plain(&authority);
    if public.is_some_and(|public| public.name.eq_ignore_ascii_case(name)) {
        return true;
    }
    let local = listening.is_loopback() || listening.is_unspecified();
    match name.parse::<IpAddr>() {
        Ok(address) if listening.is_loopback() => address.is_loopback(),
        Ok(address) => listening.is_unspecified() || address == listening,
        Err(_) => local && name.eq_ignore_ascii_case("localhost"),
    }
}

/// Refuses what is meant for others.
pub(super) async fn check(State(site): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let settings = &site.settings;
    if admits(request.headers(), settings.address.ip(), settings.public_url.as_ref()) {
        return next.run(request).await;
    }
    let text = "this server does not answer to that name; use its address, or start it with --public-url";
    (StatusCode::MISDIRECTED_REQUEST, text).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_its_own_names_are_answered() {
        let admits = |host: &str, listening: &str, public: Option<&str>| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, host.parse().unwrap());
            let public = public.map(|text| text.parse().unwrap());
            admits(&headers, listening.parse().unwrap(), public.as_ref())
        };
        for host in ["127.0.0.1:8080", "localhost", "LocalHost:9000", "[::1]:8080", "127.0.0.2"] {
            assert!(admits(host, "127.0.0.1", None), "{host}");
        }
        let foreign =
            ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example", "192.0.2.1", "", "a b", "@"];
        for host in foreign {
            assert!(!admits(host, "127.0.0.1", None), "{host}");
        }
        assert!(admits("192.0.2.1:8080", "0.0.0.0", None) && admits("[2001:db8::1]", "::", None));
        assert!(!admits("lab-pc:8080", "0.0.0.0", None));
        assert!(admits("192.0.2.1:80", "192.0.2.1", None) && !admits("192.0.2.2:80", "192.0.2.1", None));
        assert!(!admits("localhost", "192.0.2.1", None));
        let public = Some("https://study.example.org/");
        assert!(
            admits("Study.Example.org", "127.0.0.1", public) && admits("study.example.org.", "::", public)
        );
        assert!(admits("127.0.0.1:8080", "127.0.0.1", public) && !admits("example.org", "127.0.0.1", public));
        let mut headers = HeaderMap::new();
        assert!(!super::admits(&headers, [127, 0, 0, 1].into(), None), "no host");
        headers.append(header::HOST, "localhost".parse().unwrap());
        headers.append(header::HOST, "evil.example".parse().unwrap());
        assert!(!super::admits(&headers, [127, 0, 0, 1].into(), None), "two hosts");
    }

    #[test]
    fn a_public_address_is_a_sites() {
        let url: PublicUrl = "https://study.example.org:8443/".parse().unwrap();
        assert_eq!(
            (url.to_string().as_str(), url.name.as_str()),
            ("https://study.example.org:8443", "study.example.org")
        );
        for wrong in
            ["", "study.example.org", "ftp://study.example.org", "https://", "https://me@example.org", "/x"]
        {
            assert_eq!(wrong.parse::<PublicUrl>(), Err(NoPublicUrl), "{wrong}");
        }
    }
}
