//! A server of static files on this machine, for trying the page: GET alone, one thread and one
//! connection for each file, which cannot wait for each other.

use anyhow::Result;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// Most bytes of a request that are read.
const MOST_BYTES: u64 = 16 << 10;

/// For so long a browser may send nothing and take nothing.
const PATIENCE: Duration = Duration::from_secs(30);

/// A folder at an address of this machine.
pub struct Site {
    listener: TcpListener,
    folder: PathBuf,
}

impl Site {
    /// Binds to 127.0.0.1. Port 0: any that is free.
    pub fn bind(folder: &Path, port: u16) -> Result<Site> {
        let listener = TcpListener::bind(("127.0.0.1", port))?;
        let folder = folder.to_owned();
        Ok(Site { listener, folder })
    }

    /// Its address.
    pub fn url(&self) -> Result<String> {
        Ok(format!("http://{}/", self.listener.local_addr()?))
    }

    /// Answers until the program ends.
    pub fn serve(&self) {
        for stream in self.listener.incoming().flatten() {
            let folder = self.folder.clone();
            // A browser that goes away in the middle of an answer is no reason to stop.
            std::thread::spawn(move || answer(&stream, &folder));
        }
    }
}

fn answer(mut stream: &TcpStream, folder: &Path) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(stream.take(MOST_BYTES)).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    // The headers do not matter, but have to be read.
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    let path = request.strip_prefix("GET /").unwrap_or("..");
    let path = path.split([' ', '?']).next().unwrap_or_default();
    let path = match path {
        "" => "index.html",
        path => path,
    };
    // No `..` and no other root: only what lies in the folder.
    let mut parts = Path::new(path).components();
    let is_inside = parts.all(|part| matches!(part, Component::Normal(_)));
    let file = match is_inside {
        true => File::open(folder.join(path)).ok(),
        false => None,
    };
    let always = "Cache-Control: no-cache\r\nConnection: close\r\n";
    match file.and_then(|file| Some((file.metadata().ok()?, file))) {
        Some((data, mut file)) if data.is_file() => {
            let (kind, length) = (kind_of(path), data.len());
            let sizes = format!("Content-Type: {kind}\r\nContent-Length: {length}");
            write!(stream, "HTTP/1.1 200 OK\r\n{sizes}\r\n{always}\r\n")?;
            std::io::copy(&mut file, &mut stream)?;
        }
        _ => write!(
            stream,
            "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n{always}\r\n"
        )?,
    }
    Ok(())
}

fn kind_of(path: &str) -> &'static str {
    match path.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json") => "application/json",
        Some("wasm") => "application/wasm",
        Some("webm") => "video/webm",
        Some("md" | "txt" | "ts") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
