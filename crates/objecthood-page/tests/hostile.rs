//! A server that is asked for nonsense, or by a client that reads nothing, goes on answering.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use objecthood::{Camera, Frame, Params, Raster};
use objecthood_io::Capture;
use objecthood_page::{Address, FrameList, FrameSource, Session, serve};

/// A server over one frame without any depth but a wall, until it is dropped.
struct Server {
    port: u16,
    token: String,
    is_over: Arc<AtomicBool>,
}

impl Server {
    fn start() -> Self {
        let (told, address) = mpsc::channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&is_over);
        thread::spawn(move || {
            let ready = |Address(address): &Address| told.send(address.clone()).unwrap();
            serve(session(), 0, ready, || asked.load(Ordering::Relaxed)).unwrap();
        });
        let address = address.recv_timeout(Duration::from_secs(20)).unwrap();
        let (port, token) =
            address.strip_prefix("http://127.0.0.1:").unwrap().trim_end_matches('/').split_once('/').unwrap();
        Self { port: port.parse().unwrap(), token: token.to_owned(), is_over }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream
    }

    /// Sends bytes as they are, and if `is_all` says that nothing follows; the status of the answer, 0 if the server hangs up.
    fn send(&self, bytes: &[u8], is_all: bool) -> u16 {
        let mut stream = self.connect();
        // The server may hang up before it has read all.
        let _ = stream.write_all(bytes);
        if is_all {
            let _ = stream.shutdown(Shutdown::Write);
        }
        let mut answer = Vec::new();
        if let Err(error) = stream.read_to_end(&mut answer) {
            assert_eq!(error.kind(), ErrorKind::ConnectionReset, "{error}");
        }
        let line = String::from_utf8_lossy(&answer[..answer.len().min(12)]).into_owned();
        line.strip_prefix("HTTP/1.1 ").map_or(0, |status| status.parse().unwrap())
    }

    fn post(&self, path: &str, body: &[u8]) -> u16 {
        let Self { port, token, .. } = self;
        let length = body.len();
        let head = format!(
            "POST /{token}/{path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
        );
        self.send(&[head.as_bytes(), body].concat(), false)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
    }
}

fn session() -> Session {
    let read = || {
        let camera = Camera::new(60.0, 60.0, 31.5, 23.5).map_err(|e| e.to_string())?;
        let depth_m = Raster::from_vec(64, 48, vec![1.0; 64 * 48]).map_err(|e| e.to_string())?;
        Ok(Capture::new(Frame::new(depth_m, None, camera).map_err(|e| e.to_string())?))
    };
    let frames = vec![FrameSource::new("a wall".to_owned(), read)];
    Session {
        title: "a wall".to_owned(),
        words: vec!["wall.pcd".to_owned()],
        frames: Arc::new(FrameList::of(frames)),
        params: Params::default(),
    }
}

/// Numbers that look random and are the same every time (xorshift).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
}

const LOOK: &[u8] = br#"{"tab":1,"side":0,"frame":0,"settings":{"method":"context","set":{"objectness.threshold":0.4}},"maps":["objects"]}"#;

#[test]
fn a_thousand_malformed_requests_leave_it_working() {
    let server = Server::start();
    assert_eq!(server.post("look", LOOK), 200);
    let whole = format!(
        "POST /{}/look HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        server.token,
        server.port,
        LOOK.len()
    );
    let whole = [whole.as_bytes(), LOOK].concat();
    let mut dice = Dice(23);
    let mut refused = 0;
    for k in 0..1000 {
        let status = if k % 2 == 0 {
            // A request with a few bytes changed, or cut off.
            let mut bytes = whole.clone();
            for _ in 0..1 + dice.roll() % 6 {
                let place = dice.roll() as usize % bytes.len();
                bytes[place] = dice.roll() as u8;
            }
            bytes.truncate(1 + dice.roll() as usize % (2 * whole.len()));
            server.send(&bytes, true)
        } else {
            // JSON with a few bytes changed.
            let mut body = LOOK.to_vec();
            for _ in 0..1 + dice.roll() % 6 {
                let place = dice.roll() as usize % body.len();
                body[place] = b"\"{}[],:0-9e.xnull"[dice.roll() as usize % 17];
            }
            server.post(["look", "explain", "follow", "close", "repair"][k / 2 % 5], &body)
        };
        assert!(status < 500, "request {k} was answered by {status}");
        refused += u32::from(status == 0 || status >= 400);
    }
    assert!(refused > 700, "{refused} were refused");
    assert_eq!(server.post("look", LOOK), 200);
}

#[test]
fn what_is_wrong_is_refused_by_its_status() {
    let server = Server::start();
    for (path, body, status) in [
        ("look", &b"{}"[..], 400),
        ("look", br#"{"tab":1,"frame":7}"#, 422),
        ("look", br#"{"tab":1,"maps":["../../etc/passwd"]}"#, 422),
        ("look", br#"{"tab":1,"settings":{"set":{"objectness.threshold":1e9}}}"#, 422),
        ("explain", br#"{"tab":1,"pixel":[64,0]}"#, 422),
        ("explain", br#"{"tab":1,"settings":{"method":"paper"}}"#, 422),
        ("repair", br#"{"tab":1,"pixel":[64,0]}"#, 422),
        ("repair", br#"{"tab":1,"pixel":[0,0],"with":[0,48]}"#, 422),
        ("repair", br#"{"tab":1,"settings":{"method":"paper"}}"#, 422),
        ("../../Cargo.toml", b"", 404),
        ("close", br#"{"tab":1}"#, 204),
        ("look", &[b' '; 1 << 17], 413),
    ] {
        assert_eq!(
            server.post(path, body),
            status,
            "{path} {}",
            String::from_utf8_lossy(&body[..body.len().min(80)])
        );
    }
}

#[test]
fn clients_that_read_nothing_leave_it_working() {
    let server = Server::start();
    let body = br#"{"tab":1,"maps":["objects","depth","superpixels"]}"#;
    let head = format!(
        "POST /{}/look HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Length: {}\r\n\r\n",
        server.token,
        server.port,
        body.len()
    );
    let idle: Vec<TcpStream> = (0..100)
        .map(|k| {
            let mut stream = server.connect();
            // Some ask again and again and read no answer; some say nothing at all, or half of it.
            match k % 3 {
                0 => (0..20).for_each(|_| stream.write_all(&[head.as_bytes(), body].concat()).unwrap()),
                1 => stream.write_all(&head.as_bytes()[..40]).unwrap(),
                _ => {}
            }
            stream
        })
        .collect();
    assert_eq!(server.post("look", LOOK), 200);
    drop(idle);
}
