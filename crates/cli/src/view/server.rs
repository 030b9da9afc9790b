//! The web server: the page, and a WebSocket on which a viewer asks for one frame after the other.
//!
//! Everything is below a path with a random token, so that other pages of the viewer's browser and
//! other users of the machine, who may reach the port, see nothing. A viewer is sent a frame only
//! when it asks, so a slow one skips frames, and at most one is in memory for each.

use std::io::Cursor;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use tiny_http::{Header, Method, Request, Response};
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use super::latest::Latest;
use super::page;

/// Most requests that are answered at the same time, viewers included.
const MAX_REQUESTS: usize = 24;
/// Most viewers.
const MAX_VIEWERS: usize = 8;
/// Longest message of a viewer, who sends only words \[bytes\].
const MAX_MESSAGE: usize = 1024;
/// How long the end waits for viewers that do not ask.
const FAREWELL: Duration = Duration::from_millis(500);
/// Bytes of the token: too many to be guessed.
const TOKEN_BYTES: usize = 16;

/// A running server.
pub struct Server {
    http: Arc<tiny_http::Server>,
    shared: Arc<Shared>,
    address: SocketAddr,
}

/// What all requests need.
struct Shared {
    latest: Latest,
    /// `/TOKEN/`.
    base: String,
    index: String,
    requests: AtomicUsize,
    viewers: AtomicUsize,
}

impl Server {
    /// Binds and answers from now on.
    pub fn start(bind: SocketAddr) -> Result<Self> {
        let http = tiny_http::Server::http(bind).map_err(|e| anyhow!("--bind {bind}: {e}"))?;
        let address = http.server_addr().to_ip();
        let mut token = [0; TOKEN_BYTES];
        getrandom::fill(&mut token).map_err(|e| anyhow!("no random numbers: {e}"))?;
        let token: String = token.iter().map(|byte| format!("{byte:02x}")).collect();
        let server = Server {
            http: Arc::new(http),
            shared: Arc::new(Shared {
                latest: Latest::default(),
                base: format!("/{token}/"),
                index: page::index()?,
                requests: AtomicUsize::new(0),
                viewers: AtomicUsize::new(0),
            }),
            address: address.unwrap_or(bind),
        };
        let (http, shared) = (Arc::clone(&server.http), Arc::clone(&server.shared));
        std::thread::spawn(move || {
            for request in http.incoming_requests() {
                let shared = Arc::clone(&shared);
                // Dropped, a request is answered with an error.
                if let Some(permit) = Permit::take(&shared, |s| &s.requests, MAX_REQUESTS) {
                    std::thread::spawn(move || {
                        answer(request, &shared);
                        drop(permit);
                    });
                }
            }
        });
        Ok(server)
    }

    /// Where frames go.
    pub fn latest(&self) -> &Latest {
        &self.shared.latest
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://{}{}", self.address, self.shared.base)
    }

    /// Tells the viewers why it ends, and gives them a moment to hear it.
    pub fn end(&self, reason: &'static str) {
        self.shared.latest.end(reason);
        let start = Instant::now();
        while self.shared.viewers.load(Ordering::Relaxed) > 0 && start.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(10));
        }
        self.http.unblock();
    }
}

/// One of a limited number, given back when dropped.
struct Permit {
    shared: Arc<Shared>,
    count: fn(&Shared) -> &AtomicUsize,
}

impl Permit {
    fn take(shared: &Arc<Shared>, count: fn(&Shared) -> &AtomicUsize, most: usize) -> Option<Self> {
        // Counted first: dropped, it is given back.
        let permit = Permit {
            shared: Arc::clone(shared),
            count,
        };
        (count(shared).fetch_add(1, Ordering::Relaxed) < most).then_some(permit)
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        (self.count)(&self.shared).fetch_sub(1, Ordering::Relaxed);
    }
}

/// A browser that goes away in the middle of an answer is no reason for anything.
fn answer(request: Request, shared: &Arc<Shared>) {
    let path = request.url().split('?').next().unwrap_or_default();
    let path = match request.method() {
        Method::Get => path.strip_prefix(&shared.base),
        _ => None,
    };
    let file = page::FILES.iter().find(|file| Some(file.path) == path);
    let _ = match (path, file) {
        (Some("frames"), _) => {
            show(request, shared);
            Ok(())
        }
        (Some(""), _) => request.respond(document("text/html; charset=utf-8", &shared.index)),
        (_, Some(file)) => request.respond(document(file.kind, file.text)),
        _ => request.respond(Response::empty(404)),
    };
}

fn document(kind: &str, text: &str) -> Response<Cursor<Vec<u8>>> {
    let headers = [
        ("Content-Type", kind),
        ("Cache-Control", "no-store"),
        ("Referrer-Policy", "no-referrer"),
        ("X-Content-Type-Options", "nosniff"),
    ];
    let response = Response::from_data(text);
    headers
        .into_iter()
        .filter_map(|(name, value)| header(name, value))
        .fold(response, Response::with_header)
}

fn header(name: &str, value: &str) -> Option<Header> {
    Header::from_bytes(name, value).ok()
}

/// Sends frames to a viewer until it goes away.
fn show(request: Request, shared: &Arc<Shared>) {
    let mut headers = request.headers().iter();
    let key = headers.find(|h| h.field.equiv("Sec-WebSocket-Key"));
    let Some(accept) = key.map(|key| derive_accept_key(key.value.as_str().as_bytes())) else {
        let _ = request.respond(Response::empty(426));
        return;
    };
    let Some(_permit) = Permit::take(shared, |s| &s.viewers, MAX_VIEWERS) else {
        let _ = request.respond(Response::empty(503));
        return;
    };
    let mut response = Response::empty(101);
    response.add_header(match header("Sec-WebSocket-Accept", &accept) {
        Some(header) => header,
        None => return,
    });
    let stream = request.upgrade("websocket", response);
    let config = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE))
        .max_frame_size(Some(MAX_MESSAGE));
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    while let Ok(message) = socket.read() {
        if !matches!(message, Message::Text(_) | Message::Binary(_)) {
            continue;
        }
        let sent = match shared.latest.next() {
            Ok(frame) => socket.send(Message::Binary(frame)),
            Err(reason) => socket.close(Some(CloseFrame {
                code: CloseCode::Normal,
                reason: reason.into(),
            })),
        };
        if sent.is_err() {
            break;
        }
    }
}
