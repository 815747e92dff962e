//! `objecthood view` on a recording and on a stream: every frame has a name, and is looked at.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

use common::Folder;
use common::pipe::good;
use common::scene::Cloud;
use serde_json::{Value, json};

/// A server that is ended when the test ends.
struct Server {
    child: Child,
    host: String,
    place: String,
}

impl Server {
    /// A server, which gets `first` by stdin.
    fn view(folder: &Folder, arguments: &str, first: &[u8]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_objecthood"));
        command.current_dir(folder.path()).arg("view").args(arguments.split_whitespace());
        let command = command.args(["--port", "0"]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.as_mut().unwrap().write_all(first).unwrap();
        let mut address = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut address).unwrap();
        let (host, place) = address.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        Self { host: host.to_owned(), place: place.to_owned(), child }
    }

    /// The body of the answer to a request, which must succeed.
    fn ask(&self, method: &str, path: &str, body: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let Self { host, place, .. } = self;
        let length = body.len();
        write!(
            stream,
            "{method} /{place}{path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
        )
        .unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let head = answer.windows(4).position(|end| end == b"\r\n\r\n").unwrap();
        assert!(answer.starts_with(b"HTTP/1.1 200"), "{}", String::from_utf8_lossy(&answer[..head]));
        answer.split_off(head + 4)
    }

    /// A frame has its name, and objects are found in it.
    fn assert_shows(&self, frame: usize, name: &str) {
        let look = json!({"tab": 1, "frame": frame, "settings": {"method": "context", "set": {}}, "maps": ["objects"]});
        let answer = self.ask("POST", "look", &look.to_string());
        let text = String::from_utf8_lossy(&answer);
        assert!(text.contains(name) && text.contains("objectness"), "{}", &text[..text.len().min(400)]);
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

#[test]
fn the_frames_of_a_recording_have_names_of_their_own() {
    let folder = Folder::new();
    for (k, shift_m) in [0.0, 0.05, 0.1].into_iter().enumerate() {
        folder.write(&format!("in/{k}.pcd"), &Cloud::two_boxes(shift_m).to_binary_pcd());
    }
    folder.run("convert in --to mcap --out long.mcap", 0);
    let server = Server::view(&folder, "long.mcap in/0.pcd", &[]);
    let session: Value = serde_json::from_slice(&server.ask("GET", "session", "")).unwrap();
    let names = [0, 1, 2].map(|k| format!("long.mcap: long-{k:06}"));
    assert_eq!(session["frames"], json!([names[0], names[1], names[2], "in/0.pcd"]));
    names.iter().enumerate().for_each(|(frame, name)| server.assert_shows(frame, name));
}

/// It served a page on which every frame was an error.
#[test]
fn images_that_are_not_there_are_told_at_once() {
    let folder = Folder::new();
    folder.run("synth --video empty --fps 5 --size 160x120 --out video", 0);
    std::fs::remove_dir_all(folder.path().join("video/empty0/depth")).unwrap();
    let run = folder.run("view video/empty0", 1);
    assert_eq!(run.stdout, "");
    assert!(run.errors()[0].contains("frames: video/empty0/depth/"), "{}", run.stderr);
    assert!(run.errors()[0].contains(" is not there"), "{}", run.stderr);
}

#[test]
fn the_frames_of_a_stream_are_shown_as_they_come() {
    let mut server = Server::view(&Folder::new(), "-", &good("first", 0.0));
    let names = |server: &Server| -> Value {
        let session: Value = serde_json::from_slice(&server.ask("GET", "session", "")).unwrap();
        assert_eq!(session["grows"], true);
        session["frames"].clone()
    };
    assert_eq!(names(&server), json!(["first"]));
    server.assert_shows(0, "first");
    server.child.stdin.as_mut().unwrap().write_all(&good("second", 0.05)).unwrap();
    while names(&server) == json!(["first"]) {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert_eq!(names(&server), json!(["first", "second"]));
    server.assert_shows(1, "second");
    drop(server.child.stdin.take());
    server.assert_shows(0, "first");
}
