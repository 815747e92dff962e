//! What can be asked for.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Router, middleware};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use tokio::sync::Semaphore;

use crate::assets::{LICENCES, PAGE, SCRIPT, STYLE};
use crate::error::{Error, Result};
use crate::explain::{Asked, Question};
use crate::follow::{self, follow};
use crate::guard::{self, Guard};
use crate::look::{Look, look};
use crate::pipelines::{Bench, Key, Pipelines, lock};
use crate::repair::{self, repair};
use crate::session::Session;

/// The parameters take 10 kB as JSON.
const MOST_BODY_BYTES: usize = 64 << 10;
/// Requests that run the method at a time; the others wait. One leaves a core to whoever looks.
const MOST_RUNS: usize = 2;

/// What every answer is made from.
pub(crate) struct Shared {
    pub(crate) session: Session,
    pub(crate) pipelines: Pipelines,
    runs: Semaphore,
}

impl Shared {
    pub(crate) fn new(session: Session) -> Self {
        Self { session, pipelines: Pipelines::default(), runs: Semaphore::new(MOST_RUNS) }
    }
}

/// The routes, behind the guard.
pub(crate) fn routes(shared: Arc<Shared>, guard: Guard) -> Router {
    let below = Router::new()
        .route("/page.js", get(|| async { typed("text/javascript; charset=utf-8", SCRIPT) }))
        .route("/page.css", get(|| async { typed("text/css; charset=utf-8", STYLE) }))
        .route("/licences", get(|| async { typed("text/plain; charset=utf-8", LICENCES) }))
        .route("/session", get(greet))
        .route("/look", post(answer_look))
        .route("/explain", post(answer_explain))
        .route("/follow", post(answer_follow))
        .route("/repair", post(answer_repair))
        .route("/close", post(close))
        .with_state(shared);
    Router::new()
        .nest(&format!("/{}", guard.token()), below)
        .route(&format!("/{}/", guard.token()), get(|| async { typed("text/html; charset=utf-8", PAGE) }))
        .layer(DefaultBodyLimit::max(MOST_BODY_BYTES))
        .layer(middleware::from_fn_with_state(guard, guard::check))
}

fn typed(kind: &'static str, body: impl IntoResponse) -> Response {
    let mut response = body.into_response();
    response.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

/// What is not answered: the status, and a line for the reader of the page.
struct Refusal(StatusCode, String);

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self(StatusCode::UNPROCESSABLE_ENTITY, error.to_string())
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let Self(status, why) = self;
        (status, typed(JSON, json!({ "error": why }).to_string())).into_response()
    }
}

const JSON: &str = "application/json";

async fn greet(State(shared): State<Arc<Shared>>) -> Result<Response, Refusal> {
    let greeting = serde_json::to_vec(&shared.session.greeting()?).map_err(Error::from)?;
    Ok(typed(JSON, greeting))
}

/// A request of a tab: which one, and what it asks.
#[derive(Deserialize)]
struct OfTab<T> {
    tab: u64,
    /// Which of its pictures: 0 and 1 are compared, 2 is the contact sheet, 3 follows objects, 4 searches for repairs.
    #[serde(default)]
    side: u8,
    #[serde(flatten)]
    asked: T,
}

impl<T> OfTab<T> {
    /// A tab has five of them.
    fn key(&self) -> Key {
        (self.tab, self.side.min(4))
    }
}

fn read<T: DeserializeOwned>(body: &Bytes) -> Result<T, Refusal> {
    serde_json::from_slice(body).map_err(|why| Refusal(StatusCode::BAD_REQUEST, why.to_string()))
}

/// Runs on a thread that may take its time, at the bench of the tab.
async fn at_bench<T: Send + 'static>(
    shared: Arc<Shared>,
    key: Key,
    work: impl FnOnce(&Session, &mut Bench) -> Result<T> + Send + 'static,
) -> Result<T, Refusal> {
    let failed = |why: &str| Refusal(StatusCode::INTERNAL_SERVER_ERROR, why.to_owned());
    let Ok(_permit) = shared.runs.acquire().await else { return Err(failed("the server ends")) };
    let bench = shared.pipelines.of(key);
    let owned = Arc::clone(&shared);
    let worked = tokio::task::spawn_blocking(move || work(&owned.session, &mut lock(&bench))).await;
    Ok(worked.map_err(|_| failed("the method broke off: this is a mistake of objecthood"))??)
}

async fn answer_look(State(shared): State<Arc<Shared>>, body: Bytes) -> Result<Response, Refusal> {
    let asked: OfTab<Look> = read(&body)?;
    let looked = at_bench(shared, asked.key(), move |session, bench| {
        let capture = bench.capture(session, asked.asked.frame)?;
        let name = &session.frames.get(asked.asked.frame)?.name;
        look(&mut bench.pipeline, name, &capture, &asked.asked)
    });
    Ok(typed("application/octet-stream", looked.await?))
}

async fn answer_follow(State(shared): State<Arc<Shared>>, body: Bytes) -> Result<Response, Refusal> {
    let asked: OfTab<follow::Asked> = read(&body)?;
    let followed = at_bench(shared, asked.key(), move |session, bench| {
        follow(&mut bench.following, session, &asked.asked)
    });
    Ok(typed("application/octet-stream", followed.await?))
}

/// A question, and whether what would change the answer is to be searched.
#[derive(Deserialize)]
struct Search {
    #[serde(default)]
    in_full: bool,
    #[serde(flatten)]
    question: Question,
}

async fn answer_explain(State(shared): State<Arc<Shared>>, body: Bytes) -> Result<Response, Refusal> {
    let asked: OfTab<Search> = read(&body)?;
    let explained = at_bench(shared, asked.key(), move |session, bench| {
        let Search { in_full, question } = asked.asked;
        let capture = bench.capture(session, question.frame)?;
        let name = &session.frames.get(question.frame)?.name;
        let asked = Asked::new(&bench.pipeline, name, &capture, &question)?;
        if in_full { asked.in_full() } else { asked.at_once() }
    });
    Ok(typed(JSON, explained.await?.to_string()))
}

async fn answer_repair(State(shared): State<Arc<Shared>>, body: Bytes) -> Result<Response, Refusal> {
    let asked: OfTab<repair::Asked> = read(&body)?;
    let repaired = at_bench(shared, asked.key(), move |session, bench| repair(bench, session, &asked.asked));
    Ok(typed(JSON, repaired.await?.to_string()))
}

/// A tab that is closed.
#[derive(Deserialize)]
struct Closed {
    tab: u64,
}

async fn close(State(shared): State<Arc<Shared>>, body: Bytes) -> Result<StatusCode, Refusal> {
    let closed: Closed = read(&body)?;
    shared.pipelines.close(closed.tab);
    Ok(StatusCode::NO_CONTENT)
}
