//! A server of static files on this machine, for trying the page.

use anyhow::{Result, anyhow};
use std::fs::File;
use std::path::{Component, Path, PathBuf};
use tiny_http::{Header, Request, Response, Server};

/// A folder at an address of this machine.
pub struct Site {
    server: Server,
    folder: PathBuf,
}

impl Site {
    /// Binds to 127.0.0.1. Port 0: any that is free.
    pub fn bind(folder: &Path, port: u16) -> Result<Site> {
        let server = Server::http(("127.0.0.1", port)).map_err(|error| anyhow!("{error}"))?;
        let folder = folder.to_owned();
        Ok(Site { server, folder })
    }

    /// Its address.
    pub fn url(&self) -> String {
        format!("http://{}/", self.server.server_addr())
    }

    /// Answers until the program ends.
    pub fn serve(&self) {
        for request in self.server.incoming_requests() {
            // A browser that goes away in the middle of an answer is no reason to stop.
            let _ = answer(request, &self.folder);
        }
    }
}

fn answer(request: Request, folder: &Path) -> std::io::Result<()> {
    let path = request.url().split(['?', '#']).next().unwrap_or("");
    let path = match path.trim_start_matches('/') {
        "" => "index.html",
        path => path,
    }
    .to_owned();
    // No `..` and no other root: only what lies in the folder.
    let mut parts = Path::new(&path).components();
    let is_inside = parts.all(|part| matches!(part, Component::Normal(_)));
    let file = match is_inside {
        true => File::open(folder.join(&path)).ok(),
        false => None,
    };
    match file.filter(|file| file.metadata().is_ok_and(|data| data.is_file())) {
        Some(file) => {
            let response = Response::from_file(file);
            let response = response.with_header(header("Content-Type", kind_of(&path)));
            request.respond(response.with_header(header("Cache-Control", "no-cache")))
        }
        None => request.respond(Response::from_string("not found").with_status_code(404)),
    }
}

fn header(name: &str, value: &str) -> Header {
    Header::from_bytes(name, value).expect("ASCII")
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
