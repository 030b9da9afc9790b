//! The head of an HTTP request, read within limits of time and size, and short answers.
//!
//! A connection has one request, whose body is never read: what a client sends beyond its head
//! costs nothing.

use std::io::{Read, Write};
use std::net::{IpAddr, TcpStream};
use std::time::{Duration, Instant};

/// Longest head \[bytes\]. Source: chosen; browsers send less than 1 KB.
const MAX_HEAD: usize = 8 << 10;
/// How long a head may take. Source: chosen; it is one packet, by way of slow lines two.
const HEAD_PATIENCE: Duration = Duration::from_secs(3);
/// How long nothing of an answer may be taken.
const WRITE_PATIENCE: Duration = Duration::from_secs(10);
/// Where the head ends.
const END: &[u8] = b"\r\n\r\n";

/// Request line and headers.
pub struct Head {
    method: String,
    target: String,
    headers: Vec<(String, String)>,
    /// What was read beyond the head.
    pub rest: Vec<u8>,
}

impl Head {
    /// Reads a head; `None` if it is late, too long or no HTTP.
    pub fn read(stream: &mut TcpStream) -> Option<Head> {
        stream.set_write_timeout(Some(WRITE_PATIENCE)).ok()?;
        let deadline = Instant::now() + HEAD_PATIENCE;
        let mut bytes = Vec::new();
        let mut part = [0; 1024];
        while bytes.len() < MAX_HEAD {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return None;
            }
            stream.set_read_timeout(Some(left)).ok()?;
            let count = stream.read(&mut part).ok().filter(|count| *count > 0)?;
            // The end may have begun in the part before.
            let from = bytes.len().saturating_sub(END.len() - 1);
            bytes.extend_from_slice(&part[..count]);
            let end = bytes[from..].windows(END.len()).position(|w| w == END);
            if let Some(end) = end {
                let rest = bytes.split_off(from + end + END.len());
                stream.set_read_timeout(None).ok()?;
                return Self::parse(&String::from_utf8(bytes).ok()?, rest);
            }
        }
        None
    }

    fn parse(text: &str, rest: Vec<u8>) -> Option<Head> {
        let mut lines = text.split("\r\n");
        let mut words = lines.next()?.split(' ');
        let (method, target) = (words.next()?, words.next()?);
        if words.next()? != "HTTP/1.1" || words.next().is_some() {
            return None;
        }
        let header = |line: &str| {
            let (name, value) = line.split_once(':')?;
            Some((name.to_ascii_lowercase(), value.trim().to_string()))
        };
        let lines = lines.filter(|line| !line.is_empty());
        Some(Head {
            method: method.into(),
            target: target.into(),
            headers: lines.map(header).collect::<Option<_>>()?,
            rest,
        })
    }

    /// The path of a GET, without what follows `?`.
    pub fn path(&self) -> Option<&str> {
        let is_get = self.method == "GET";
        self.target.split('?').next().filter(|_| is_get)
    }

    /// The value of a header that stands there once; `name` in lower case.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut values = self.headers.iter().filter(|(n, _)| n == name);
        let (_, value) = values.next()?;
        values.next().is_none().then_some(value)
    }

    /// Whether it comes from a page of this server. A page of another site has another origin; one
    /// whose name was made to lead here has that name as its host. So hosts are addresses,
    /// `localhost`, or one of `names`.
    pub fn is_own(&self, names: &[String]) -> bool {
        let Some(host) = self.header("host") else {
            return false;
        };
        let name = without_port(host);
        let is_address = name.trim_matches(['[', ']']).parse::<IpAddr>().is_ok();
        let is_named = names.iter().any(|known| name.eq_ignore_ascii_case(known));
        let has_origin = self.headers.iter().any(|(name, _)| name == "origin");
        let origin = self
            .header("origin")
            .and_then(|origin| origin.split_once("://"));
        let is_same = origin.is_some_and(|(_, authority)| authority == host);
        (is_address || name == "localhost" || is_named) && (is_same || !has_origin)
    }
}

/// The host without `:PORT`.
fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) && !name.is_empty() => name,
        _ => host,
    }
}

/// Sends an answer without content.
pub fn refuse(stream: &mut TcpStream, status: &str) {
    let head = format!("HTTP/1.1 {status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    // A client that goes away is no reason for anything.
    let _ = stream.write_all(head.as_bytes());
}

/// Sends a document.
pub fn document(stream: &mut TcpStream, kind: &str, text: &str) {
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n\
         Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\n\
         X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        text.len()
    );
    let _ = stream.write_all(head.as_bytes());
    let _ = stream.write_all(text.as_bytes());
}

/// Says that WebSocket messages follow.
pub fn upgrade(stream: &mut TcpStream, accept: &str) -> std::io::Result<()> {
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accept}\r\n\r\n"
    );
    stream.write_all(head.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_read_strictly() {
        let parse = |text: &str| Head::parse(text, Vec::new());
        let head = parse("GET /a?b HTTP/1.1\r\nHost: x:1\r\nX: 1\r\nx: 2\r\n\r\n").unwrap();
        assert_eq!(
            (head.path(), head.header("host")),
            (Some("/a"), Some("x:1"))
        );
        assert_eq!(head.header("x"), None, "it is not said which counts");
        assert_eq!(parse("POST / HTTP/1.1\r\n\r\n").unwrap().path(), None);
        for text in [
            "GET /\r\n\r\n",
            "GET / x HTTP/1.1\r\n\r\n",
            "GET / HTTP/1.1\r\nx\r\n\r\n",
        ] {
            assert!(parse(text).is_none(), "{text}");
        }
    }

    #[test]
    fn hosts_without_ports() {
        for (host, name) in [
            ("localhost:80", "localhost"),
            ("localhost", "localhost"),
            ("[::1]:80", "[::1]"),
            ("127.0.0.1", "127.0.0.1"),
        ] {
            assert_eq!(without_port(host), name);
        }
    }
}
