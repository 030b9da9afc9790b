//! The web server: the page, and a WebSocket on which a viewer asks for one frame after the other.
//!
//! Everything is below a path with a random token, so that other pages of the viewer's browser and
//! other users of the machine, who may reach the port, see nothing. Whoever does not know it is
//! bounded in time, size and number ([`http`]), and cannot keep others out: of the clients that
//! have not said yet what they want, the oldest must go when there are too many. A viewer is sent
//! a frame only when it asks, so a slow one skips frames, and at most one is in memory for each.

use std::collections::VecDeque;
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use super::http::{self, Head};
use super::latest::Latest;
use super::page;

/// Most connections, viewers included.
const MAX_CONNECTIONS: usize = 64;
/// Most connections whose request is not read yet.
const MAX_UNREAD: usize = 32;
/// Most viewers.
const MAX_VIEWERS: usize = 8;
/// Longest message of a viewer, who sends only words \[bytes\].
const MAX_MESSAGE: usize = 1024;
/// How long the end waits for viewers that do not ask.
const FAREWELL: Duration = Duration::from_millis(500);
/// Rest after a connection that could not be taken, as where file descriptors have run out.
const REST: Duration = Duration::from_millis(20);
/// Stack of a connection's thread \[bytes\].
const STACK: usize = 256 << 10;
/// Bytes of the token: too many to be guessed.
const TOKEN_BYTES: usize = 16;

/// A running server.
pub struct Server {
    shared: Arc<Shared>,
    address: SocketAddr,
}

/// What all requests need.
struct Shared {
    latest: Latest,
    /// `/TOKEN/`.
    base: String,
    index: String,
    /// Names under which this machine may be asked.
    names: Vec<String>,
    connections: AtomicUsize,
    viewers: AtomicUsize,
    unread: Mutex<VecDeque<Arc<TcpStream>>>,
}

impl Server {
    /// Binds and answers from now on.
    pub fn start(bind: SocketAddr, names: &[String]) -> Result<Self> {
        let listener = TcpListener::bind(bind).map_err(|e| anyhow!("--bind {bind}: {e}"))?;
        let address = listener.local_addr().context("no address")?;
        let mut token = [0; TOKEN_BYTES];
        getrandom::fill(&mut token).map_err(|e| anyhow!("no random numbers: {e}"))?;
        let token: String = token.iter().map(|byte| format!("{byte:02x}")).collect();
        let shared = Arc::new(Shared {
            latest: Latest::default(),
            base: format!("/{token}/"),
            index: page::index()?,
            names: names.to_vec(),
            connections: AtomicUsize::new(0),
            viewers: AtomicUsize::new(0),
            unread: Mutex::default(),
        });
        let server = Server {
            shared: Arc::clone(&shared),
            address,
        };
        // It ends with the program.
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                match stream {
                    Ok(stream) => take(stream, &shared),
                    Err(_) => std::thread::sleep(REST),
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

/// A connection whose request is not read yet, in the list of these until dropped.
struct Unread {
    shared: Arc<Shared>,
    handle: Arc<TcpStream>,
}

impl Unread {
    /// Enters it; the oldest one must go if they are too many.
    fn enter(stream: &TcpStream, shared: &Arc<Shared>) -> std::io::Result<Self> {
        let unread = Unread {
            shared: Arc::clone(shared),
            handle: Arc::new(stream.try_clone()?),
        };
        let mut list = unread.list();
        list.push_back(Arc::clone(&unread.handle));
        if list.len() > MAX_UNREAD {
            let oldest = list.pop_front();
            // Its thread reads the end.
            let _ = oldest.map(|stream| stream.shutdown(Shutdown::Both));
        }
        drop(list);
        Ok(unread)
    }

    fn list(&self) -> MutexGuard<'_, VecDeque<Arc<TcpStream>>> {
        let list = self.shared.unread.lock();
        list.unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Unread {
    fn drop(&mut self) {
        self.list()
            .retain(|other| !Arc::ptr_eq(other, &self.handle));
    }
}

/// Gives a connection its thread.
fn take(mut stream: TcpStream, shared: &Arc<Shared>) {
    let permit = Permit::take(shared, |s| &s.connections, MAX_CONNECTIONS);
    let (Some(permit), Ok(unread)) = (permit, Unread::enter(&stream, shared)) else {
        return;
    };
    let shared = Arc::clone(shared);
    let thread = std::thread::Builder::new().stack_size(STACK);
    // Without a thread it is dropped.
    let _ = thread.spawn(move || {
        let head = Head::read(&mut stream);
        drop(unread);
        if let Some(head) = head {
            answer(stream, head, &shared);
        }
        drop(permit);
    });
}

fn answer(mut stream: TcpStream, head: Head, shared: &Arc<Shared>) {
    let path = head.path().and_then(|path| path.strip_prefix(&shared.base));
    let file = page::FILES.iter().find(|file| Some(file.path) == path);
    match (path, file) {
        (None, _) => http::refuse(&mut stream, "404 Not Found"),
        _ if !head.is_own(&shared.names) => http::refuse(&mut stream, "403 Forbidden"),
        (Some("frames"), _) => show(stream, head, shared),
        (Some(""), _) => http::document(&mut stream, "text/html; charset=utf-8", &shared.index),
        (_, Some(file)) => http::document(&mut stream, file.kind, file.text),
        _ => http::refuse(&mut stream, "404 Not Found"),
    }
}

/// Sends frames to a viewer until it goes away.
fn show(mut stream: TcpStream, head: Head, shared: &Arc<Shared>) {
    let Some(key) = head.header("sec-websocket-key") else {
        return http::refuse(&mut stream, "426 Upgrade Required");
    };
    let Some(_permit) = Permit::take(shared, |s| &s.viewers, MAX_VIEWERS) else {
        return http::refuse(&mut stream, "503 Service Unavailable");
    };
    if http::upgrade(&mut stream, &derive_accept_key(key.as_bytes())).is_err() {
        return;
    }
    let config = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE))
        .max_frame_size(Some(MAX_MESSAGE));
    let mut socket = WebSocket::from_partially_read(stream, head.rest, Role::Server, Some(config));
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
