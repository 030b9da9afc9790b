//! `posewise view` with real clients: a WebSocket in Rust, and headless Chromium.
//!
//! A program of its own: what is live has the machine to itself.
#![cfg(unix)]

#[allow(dead_code)] // only a part is used here
#[path = "command/common/mod.rs"]
mod common;

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::skip::need;
use crate::common::{fails_with, gradient_clip, posewise};
use serde_json::Value;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::{Message, WebSocket};

/// A rendered head; 20 frames a second.
const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz");

/// The running command.
struct View {
    child: Child,
    /// HOST:PORT.
    address: String,
    /// `/TOKEN/`.
    base: String,
}

impl View {
    fn start(args: &[&str]) -> View {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin("posewise"))
            .args(["view", "--bind", "127.0.0.1:0"])
            .args(args)
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut url = String::new();
        let mut stdout = BufReader::new(child.stdout.take().expect("a pipe"));
        stdout.read_line(&mut url).expect("a line");
        let rest = url.trim().strip_prefix("http://").expect("an address");
        let (address, base) = rest.split_at(rest.find('/').expect("a path"));
        assert_eq!(
            base.len(),
            "/".len() + 32 + "/".len(),
            "a token of 128 bits"
        );
        View {
            child,
            address: address.into(),
            base: base.into(),
        }
    }

    /// Status line, headers and body of an answer.
    fn ask(&self, request: &str) -> String {
        let host = &self.address;
        self.ask_with(request, &[&format!("Host: {host}")])
    }

    /// The same with other headers.
    fn ask_with(&self, request: &str, headers: &[&str]) -> String {
        let mut stream = TcpStream::connect(&self.address).expect("it listens");
        let headers = headers.join("\r\n");
        let head = format!("{request} HTTP/1.1\r\n{headers}\r\nConnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).expect("it reads");
        let mut text = String::new();
        stream.read_to_string(&mut text).expect("it answers");
        text
    }

    fn connect(&self, base: &str) -> Result<WebSocket<TcpStream>, String> {
        let stream = TcpStream::connect(&self.address).expect("it listens");
        let patience = Some(Duration::from_secs(20));
        stream.set_read_timeout(patience).expect("a timeout");
        let url = format!("ws://{}{base}frames", self.address);
        let connected = tungstenite::client::client(url, stream);
        connected
            .map(|(socket, _)| socket)
            .map_err(|e| e.to_string())
    }

    fn viewer(&self) -> Viewer {
        Viewer(self.connect(&self.base).expect("it accepts viewers"))
    }

    /// As Ctrl-C; gives the exit status.
    fn interrupt(&mut self) -> Option<i32> {
        let pid = self.child.id().to_string();
        let kill = Command::new("kill").args(["-INT", &pid]).status();
        assert!(kill.expect("kill").success());
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                return status.code();
            }
            assert!(start.elapsed() < Duration::from_secs(10), "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

struct Viewer(WebSocket<TcpStream>);

impl Viewer {
    fn ask(&mut self) {
        self.0
            .send(Message::Text("next".into()))
            .expect("connected");
    }

    /// Results and picture of the next frame.
    fn frame(&mut self) -> (Value, image::RgbImage) {
        let message = self.0.read().expect("a frame");
        let bytes = message.into_data();
        let (length, rest) = bytes.split_first_chunk().expect("a length");
        let (text, jpeg) = rest.split_at(u32::from_le_bytes(*length) as usize);
        let picture = image::load_from_memory(jpeg).expect("a JPEG").into_rgb8();
        (serde_json::from_slice(text).expect("JSON"), picture)
    }
}

fn time_us(frame: &Value) -> i64 {
    frame["result"]["timestampUs"].as_i64().expect("a time")
}

/// What `track` says of each time of the clip.
fn tracked() -> HashMap<i64, Value> {
    let run = posewise()
        .args(["track", DEMO, "--jsonl", "-", "--quiet"])
        .assert()
        .success();
    let text = String::from_utf8(run.get_output().stdout.clone()).expect("UTF-8");
    let rows = text
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"));
    rows.map(|row: Value| (row["timestamp_us"].as_i64().expect("a time"), row))
        .collect()
}

#[test]
fn a_viewer_sees_what_track_writes() {
    let mut view = View::start(&[DEMO, "--width", "160"]);
    let mut viewer = view.viewer();
    let expected = tracked();
    let mut last_us = -1;
    let mut compared = 0;
    for _ in 0..12 {
        viewer.ask();
        let (frame, picture) = viewer.frame();
        assert!(time_us(&frame) > last_us, "frames come in order");
        last_us = time_us(&frame);
        assert_eq!(
            (&frame["width"], &frame["height"]),
            (&320.into(), &240.into())
        );
        assert_eq!(picture.dimensions(), (160, 120));
        // The clip may have begun again.
        if let Some(row) = expected.get(&last_us) {
            let result = &frame["result"];
            assert_eq!(result["yawDeg"], row["yaw_deg"]);
            assert_eq!(result["state"], row["state"]);
            assert_eq!(frame["landmarks"][30]["x"], row["landmarks"][30][0]);
            compared += 1;
        }
    }
    assert!(compared > 0);
    let farewell = std::thread::spawn(move || {
        loop {
            viewer.ask();
            match viewer.0.read() {
                Ok(Message::Close(close)) => break close,
                Ok(_) => {}
                Err(error) => panic!("no farewell: {error}"),
            }
        }
    });
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(view.interrupt(), Some(0));
    let close = farewell.join().expect("a farewell").expect("a reason");
    assert_eq!(close.code, CloseCode::Normal);
    assert!(TcpStream::connect(&view.address).is_err(), "nobody listens");
}

/// One that does not ask is sent nothing; one that asks late is sent what is seen then.
#[test]
fn slow_viewers_skip_frames() {
    let view = View::start(&[DEMO]);
    let _silent = view.viewer();
    let (mut slow, mut quick) = (view.viewer(), view.viewer());
    slow.ask();
    let first = time_us(&slow.frame().0);
    let mut count = 0;
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(2) {
        quick.ask();
        quick.frame();
        count += 1;
    }
    slow.ask();
    let waited = time_us(&slow.frame().0) - first;
    assert!(waited > 1_500_000, "{waited} us: an old frame was kept");
    assert!(count >= 10, "{count} frames in 2 s beside a silent viewer");
}

#[test]
fn only_the_token_opens_the_page_and_viewers_are_limited() {
    let view = View::start(&[DEMO]);
    let base = &view.base;
    let page = view.ask(&format!("GET {base}"));
    assert!(
        page.starts_with("HTTP/1.1 200") && page.contains("demo/live.js"),
        "{page}"
    );
    let script = view.ask(&format!("GET {base}demo/live.js?x"));
    assert!(script.contains("text/javascript") && script.contains("new WebSocket"));
    for request in [
        "GET /".to_string(),
        "GET /frames".into(),
        "GET /demo/live.js".into(),
        format!("GET /{}/", "0".repeat(32)),
        format!("GET {base}../Cargo.toml"),
        format!("POST {base}"),
    ] {
        assert!(view.ask(&request).starts_with("HTTP/1.1 404"), "{request}");
    }
    assert!(
        view.ask(&format!("GET {base}frames"))
            .starts_with("HTTP/1.1 426")
    );
    let refused = view.connect("/").expect_err("no token");
    assert!(refused.contains("404"), "{refused}");
    let viewers: Vec<_> = (0..8).map(|_| view.viewer()).collect();
    let refused = view.connect(base).expect_err("too many");
    assert!(refused.contains("503"), "{refused}");
    drop(viewers);
}

/// Pages of other sites, also those whose name leads to this machine, see nothing.
#[test]
fn foreign_hosts_and_origins_are_refused() {
    let view = View::start(&[DEMO, "--host", "camera.example"]);
    let (base, own) = (&view.base, format!("Host: {}", view.address));
    let status = |headers: &[&str]| {
        let answer = view.ask_with(&format!("GET {base}"), headers);
        answer.split(' ').nth(1).map(String::from)
    };
    let refused = Some("403".to_string());
    assert_eq!(status(&["Host: evil.example"]), refused);
    assert_eq!(status(&["Host: 127.0.0.1.evil.example:80"]), refused);
    assert_eq!(status(&["Accept: */*"]), refused, "no host at all");
    let two = [&own[..], "Host: evil.example"];
    assert_eq!(status(&two), refused, "two hosts");
    assert_eq!(status(&[&own, "Origin: http://evil.example"]), refused);
    assert_eq!(status(&[&own, "Origin: null"]), refused);
    let same = format!("Origin: http://{}", view.address);
    for headers in [
        &[&own[..]][..],
        &[&own, &same],
        // By way of `ssh -L`.
        &["Host: localhost:9000", "Origin: http://localhost:9000"],
        &["Host: [::1]:9000"],
        &["Host: camera.example", "Origin: https://camera.example"],
    ] {
        assert_eq!(status(headers), Some("200".into()), "{headers:?}");
    }
    let frames = view.ask_with(
        &format!("GET {base}frames"),
        &[
            &own,
            "Origin: http://evil.example",
            "Upgrade: websocket",
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        ],
    );
    assert!(frames.starts_with("HTTP/1.1 403"), "{frames}");
}

/// What a hostile client does with its connection, until it is thrown out.
fn attack(kind: usize, address: &str, stop: &std::sync::atomic::AtomicBool) {
    let heads = [
        "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999\r\n\r\n",
        "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 18446744073709551615\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: x\r\nX-Endless: ",
        "GET / HTTP/1.1\r\nHost: x\r\n\r\n",
        "",
    ];
    let kind = kind % heads.len();
    while !stop.load(std::sync::atomic::Ordering::Relaxed) {
        let Ok(mut stream) = TcpStream::connect(address) else {
            return;
        };
        let pause = Some(Duration::from_millis(50));
        stream.set_write_timeout(pause).unwrap();
        let _ = stream.write_all(heads[kind].as_bytes());
        let more = match kind {
            2 => "x".repeat(1 << 16),
            3 => heads[3].repeat(1000),
            _ => String::new(),
        };
        stream.set_read_timeout(pause).unwrap();
        while !stop.load(std::sync::atomic::Ordering::Relaxed) {
            // Those that send never read; the others wait for an answer.
            let done = match more.is_empty() {
                false => stream.write_all(more.as_bytes()),
                true => stream.read_exact(&mut [0]),
            };
            match done {
                Ok(()) => std::thread::sleep(Duration::from_millis(5)),
                Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {}
                Err(_) => break,
            }
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Memory of a process \[MB\], where the system tells.
fn peak_mb(pid: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1024)
}

#[test]
fn hostile_clients_stop_nobody() {
    let mut view = View::start(&[DEMO]);
    let mut viewer = view.viewer();
    viewer.ask();
    viewer.frame();
    let stop = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let hostile: Vec<_> = (0..64)
        .map(|kind| {
            let (address, stop) = (view.address.clone(), std::sync::Arc::clone(&stop));
            std::thread::spawn(move || attack(kind, &address, &stop))
        })
        .collect();
    let start = Instant::now();
    let (mut last, mut longest) = (Instant::now(), Duration::ZERO);
    let mut newcomers = 0;
    while start.elapsed() < Duration::from_secs(6) {
        viewer.ask();
        viewer.frame();
        longest = longest.max(last.elapsed());
        last = Instant::now();
        // Others can still join.
        if start.elapsed() > Duration::from_secs(newcomers + 1) {
            let mut newcomer = view.viewer();
            newcomer.ask();
            newcomer.frame();
            newcomers += 1;
            last = Instant::now();
        }
    }
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    for thread in hostile {
        thread.join().expect("an attack ends");
    }
    assert!(newcomers >= 3, "{newcomers} joined");
    assert!(
        longest < Duration::from_secs(2),
        "{longest:?} without a frame"
    );
    if let Some(peak) = peak_mb(view.child.id()) {
        assert!(peak < 200, "{peak} MB");
    }
    assert_eq!(view.interrupt(), Some(0));
}

#[test]
fn the_end_of_the_input_is_the_end() {
    let dir = tempfile::tempdir().unwrap();
    let clip = dir.path().join("clip.y4m");
    // A second at 25 frames a second.
    std::fs::write(&clip, gradient_clip(64, 48, 26)).unwrap();
    let mut view = View::start(&["--once", clip.to_str().unwrap()]);
    let mut viewer = view.viewer();
    let reason = loop {
        viewer.ask();
        match viewer.0.read().expect("a message") {
            Message::Close(close) => break close.expect("a reason"),
            _ => continue,
        }
    };
    assert_eq!(reason.code, CloseCode::Normal);
    assert_eq!(&*reason.reason, "The input has ended.");
    assert_eq!(view.child.wait().unwrap().code(), Some(0));

    fails_with(&["view", "nowhere.mp4"], Vec::new(), &["no such file"]);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = taken.local_addr().unwrap().to_string();
    let bind = ["view", DEMO, "--bind", &taken];
    fails_with(&bind, Vec::new(), &["--bind", &taken]);
    posewise()
        .args(["view", "--bind", "nowhere"])
        .assert()
        .code(2);
}

#[test]
fn the_live_page_works_in_chromium() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for package in ["playwright-core", "axe-core"] {
        let there = root.join("web/node_modules").join(package).exists();
        if !need(&format!("{package} (npm ci --prefix web)"), there) {
            return;
        }
    }
    for program in ["node", "chromium"] {
        let runs = Command::new(program).arg("--version").output().is_ok();
        if !need(program, runs) {
            return;
        }
    }
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("live");
    std::fs::create_dir_all(&out).unwrap();
    let run = Command::new("node")
        .arg(root.join("web/test/live.mjs"))
        .arg(assert_cmd::cargo::cargo_bin("posewise"))
        .arg(DEMO)
        .arg(&out)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{said}");
    let table = std::fs::read_to_string(out.join("live.csv")).unwrap();
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().count() > 5, "a row for each frame");
    assert!(table.lines().all(|row| row.split(',').count() == columns));
}
