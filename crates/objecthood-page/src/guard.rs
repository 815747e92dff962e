//! Who may ask: only a browser on this machine that was given the address, and only from the page itself.

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderName, HeaderValue};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::error::{Error, Result};

/// What the page may load, run and be shown in: itself, and nothing else.
pub(crate) const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const HEADERS: [(HeaderName, &str); 6] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// What a request must say.
#[derive(Clone, Debug)]
pub(crate) struct Guard {
    hosts: [String; 2],
    token: String,
}

impl Guard {
    /// For a server at this port. The token is 128 random bits.
    ///
    /// # Errors
    /// [`Error::NoRandom`].
    pub(crate) fn new(port: u16) -> Result<Self> {
        let mut bits = [0_u8; 16];
        getrandom::fill(&mut bits).map_err(Error::NoRandom)?;
        let token = bits.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { hosts: ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}")), token })
    }

    /// The secret part of the address.
    pub(crate) fn token(&self) -> &str {
        &self.token
    }

    /// Another site that resolves to this machine says its own name as host; a page of another site says its own origin.
    fn lets_in(&self, headers: &HeaderMap, path: &str) -> Result<(), StatusCode> {
        let named = |name: HeaderName| headers.get_all(name).iter().map(HeaderValue::to_str);
        let is_own = |host: &str| self.hosts.iter().any(|own| own == host);
        let mut hosts = named(header::HOST);
        let (Some(Ok(host)), None) = (hosts.next(), hosts.next()) else {
            return Err(StatusCode::BAD_REQUEST);
        };
        let is_own_origin = |origin: &str| origin.strip_prefix("http://").is_some_and(is_own);
        if !is_own(host) || !named(header::ORIGIN).all(|origin| origin.is_ok_and(is_own_origin)) {
            return Err(StatusCode::FORBIDDEN);
        }
        let given = path.trim_start_matches('/').split('/').next().unwrap_or_default();
        if is_same(given.as_bytes(), self.token.as_bytes()) { Ok(()) } else { Err(StatusCode::NOT_FOUND) }
    }
}

/// Compares all bytes whatever they are, so that the time does not tell how many are right.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differs, (x, y)| differs | (x ^ y)) == 0
}

/// Refuses what the guard does not let in, and says in every answer what a browser may do with it.
pub(crate) async fn check(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let mut response = match guard.lets_in(request.headers(), request.uri().path()) {
        Ok(()) => next.run(request).await,
        Err(status) => status.into_response(),
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_page_itself_gets_in() {
        let guard = Guard::new(7000).unwrap();
        let path = format!("/{}/session", guard.token());
        let ask = |headers: &[(HeaderName, &str)], path: &str| {
            let named = headers.iter().map(|(name, value)| (name.clone(), value.parse().unwrap()));
            guard.lets_in(&named.collect(), path).map_err(|status| status.as_u16())
        };
        let host = |name| (header::HOST, name);
        let origin = |name| (header::ORIGIN, name);
        assert_eq!(ask(&[host("127.0.0.1:7000")], &path), Ok(()));
        assert_eq!(ask(&[host("localhost:7000"), origin("http://localhost:7000")], &path), Ok(()));
        assert_eq!(ask(&[], &path), Err(400));
        for foreign in
            ["127.0.0.1", "127.0.0.1:80", "evil.example:7000", "[::1]:7000", "127.0.0.1:7000.evil.example"]
        {
            assert_eq!(ask(&[host(foreign)], &path), Err(403), "{foreign}");
        }
        for foreign in ["null", "http://evil.example", "https://127.0.0.1:7000", "http://127.0.0.1:8000"] {
            assert_eq!(ask(&[host("127.0.0.1:7000"), origin(foreign)], &path), Err(403), "{foreign}");
        }
        let (short, long) = (&path[..20], format!("/x{}", guard.token()));
        for wrong in ["/", "", "/session", short, &long] {
            assert_eq!(ask(&[host("127.0.0.1:7000")], wrong), Err(404), "{wrong}");
        }
    }

    #[test]
    fn every_address_is_a_secret_of_its_own() {
        let tokens = [7000, 7000].map(|port| Guard::new(port).unwrap().token);
        assert_ne!(tokens[0], tokens[1]);
        assert_eq!(tokens[0].len(), 32);
    }
}
