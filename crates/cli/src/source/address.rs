//! Addresses of streams and files elsewhere: which ones are read, and how `ffmpeg` is asked to.

use anyhow::{Result, bail};

/// What an address may lead to, for example in a playlist. Files of this machine are not in it.
const PROTOCOLS: &str = "crypto,http,https,httpproxy,rtp,rtsp,srtp,tcp,tls,udp";

/// An address of a scheme that is read.
#[derive(Debug)]
pub struct Address {
    url: String,
    /// As shown: without user name and password.
    name: String,
    is_live: bool,
}

impl Address {
    /// `None` for what is no address but a path.
    pub fn parse(input: &str) -> Result<Option<Self>> {
        let Some((scheme, rest)) = input.split_once("://") else {
            return Ok(None);
        };
        let scheme = scheme.to_ascii_lowercase();
        let is_word = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
        if scheme.is_empty() || !scheme.chars().all(is_word) {
            return Ok(None);
        }
        let is_live = matches!(&*scheme, "rtsp" | "rtsps");
        if !is_live && !matches!(&*scheme, "http" | "https") {
            bail!("{scheme}: of addresses, rtsp, rtsps, http and https are read");
        }
        let (authority, path) = rest.split_at(rest.find(['/', '?']).unwrap_or(rest.len()));
        let host = authority
            .rsplit_once('@')
            .map_or(authority, |(_, host)| host);
        if host.is_empty() {
            bail!("{scheme}://{path}: the address names no host");
        }
        Ok(Some(Address {
            url: format!("{scheme}://{rest}"),
            name: format!("{scheme}://{host}{path}"),
            is_live,
        }))
    }

    /// For messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether frames come as they are taken.
    pub fn is_live(&self) -> bool {
        self.is_live
    }

    /// The options of `ffmpeg` for this input.
    pub fn arguments(&self) -> Vec<&str> {
        let transport: &[&str] = match self.is_live {
            // Over TCP: datagrams that are lost would be grey blocks in the picture.
            true => &["-rtsp_transport", "tcp"],
            false => &[],
        };
        let common = ["-protocol_whitelist", PROTOCOLS, "-i", &self.url];
        [transport, &common].concat()
    }

    /// A message of `ffmpeg` without the password.
    pub fn redacted(&self, message: &str) -> String {
        message.replace(&self.url, &self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_paths() {
        let parsed = |input| Address::parse(input).unwrap();
        for path in ["a.mp4", "/dev/video0", "dir/http://x", "C:/x.mp4", "-"] {
            assert!(parsed(path).is_none(), "{path}");
        }
        let camera = parsed("RTSP://me:secret@cam:554/s?a=1").unwrap();
        assert!(camera.is_live());
        assert_eq!(camera.name(), "rtsp://cam:554/s?a=1");
        let url = "rtsp://me:secret@cam:554/s?a=1";
        assert_eq!(camera.arguments().last(), Some(&url));
        assert_eq!(
            camera.redacted(&format!("{url}: no")),
            "rtsp://cam:554/s?a=1: no"
        );
        assert!(!parsed("https://x/[1].mp4").unwrap().is_live());
        for (bad, word) in [("ftp://x/y", "rtsp"), ("http:///y", "no host")] {
            let error = Address::parse(bad).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}
