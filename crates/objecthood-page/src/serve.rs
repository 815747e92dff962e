//! Listens on this machine's own address, and answers.

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use crate::error::{Error, Result};
use crate::guard::Guard;
use crate::routes::{Shared, routes};
use crate::session::Session;

/// Connections at a time; a browser opens six for a site.
const MOST_CONNECTIONS: usize = 128;
/// A client that does not say what it wants for this long is hung up on.
const PATIENCE: Duration = Duration::from_secs(15);
/// How often pipelines are looked for that nobody uses.
const SWEEP: Duration = Duration::from_secs(60);

/// The address of the page, which only its reader is to know.
#[derive(Clone, Debug)]
pub struct Address(pub String);

/// Shows the session at a port, 0 for any that is free, until `is_over`; `ready` is told the address once connections are accepted.
///
/// # Errors
/// [`Error::Listen`], [`Error::NoRandom`].
pub fn serve(
    session: Session,
    port: u16,
    ready: impl FnOnce(&Address),
    is_over: impl Fn() -> bool,
) -> Result<()> {
    let listen = |reason| Error::Listen { port, reason };
    let runtime =
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().map_err(listen)?;
    runtime.block_on(async {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await.map_err(listen)?;
        let port = listener.local_addr().map_err(listen)?.port();
        let guard = Guard::new(port)?;
        ready(&Address(format!("http://127.0.0.1:{port}/{}/", guard.token())));
        let shared = Arc::new(Shared::new(session));
        tokio::spawn(sweep(Arc::clone(&shared)));
        tokio::spawn(accept(listener, routes(shared, guard)));
        while !is_over() {
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        Ok(())
    })
}

async fn sweep(shared: Arc<Shared>) {
    loop {
        tokio::time::sleep(SWEEP).await;
        shared.pipelines.forget_idle();
    }
}

/// Answers every connection on a task of its own.
async fn accept(listener: TcpListener, routes: Router) {
    let room = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(PATIENCE);
    while let Ok(place) = Arc::clone(&room).acquire_owned().await {
        // What went wrong with one connection is no reason to refuse the next.
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let connection =
            http.serve_connection(TokioIo::new(stream), TowerToHyperService::new(routes.clone()));
        tokio::spawn(async move {
            // A client that hangs up is no error.
            let _ = connection.await;
            drop(place);
        });
    }
}
