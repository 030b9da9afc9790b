//! Results as UDP datagrams for other programs: `track --osc` and `--udp-opentrack`.

mod opentrack;
mod vmc;

use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};
use posewise::TrackResult;

use crate::retarget::Retargeting;

/// The datagrams of one frame.
type Encode = Box<dyn Fn(&TrackResult) -> Result<Vec<Vec<u8>>>>;

/// Every receiver that was asked for.
#[derive(Default)]
pub struct Streams(Vec<Stream>);

impl Streams {
    /// `osc` and `opentrack` are HOST:PORT; `gaze` says whether the gaze is looked for, and
    /// `retargeting` which weights an avatar gets.
    pub fn open(
        osc: Option<&str>,
        opentrack: Option<&str>,
        gaze: bool,
        retargeting: Option<Retargeting>,
    ) -> Result<Self> {
        let vmc = osc.map(|to| -> (_, Encode) {
            let datagrams = move |result: &TrackResult| {
                let avatar = retargeting.as_ref().map(|of| of.weights(result));
                vmc::datagrams(result, gaze, avatar.as_ref())
            };
            (to, Box::new(datagrams))
        });
        let opentrack = opentrack.map(|to| -> (_, Encode) { (to, Box::new(opentrack::datagrams)) });
        let streams = [vmc, opentrack].into_iter().flatten();
        Ok(Streams(
            streams
                .map(|(to, encode)| Stream::open(to, encode))
                .collect::<Result<_>>()?,
        ))
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Sends the result of a frame.
    pub fn send(&mut self, result: &TrackResult) -> Result<()> {
        self.0.iter_mut().try_for_each(|stream| stream.send(result))
    }

    /// What could not be sent.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.0.iter().filter_map(Stream::warning)
    }
}

/// One receiver.
struct Stream {
    /// As given.
    name: String,
    socket: UdpSocket,
    /// The socket is not connected to it: a receiver that is not there yet is no error.
    to: SocketAddr,
    encode: Encode,
    unsent: u64,
    error: Option<std::io::Error>,
}

impl Stream {
    fn open(name: &str, encode: Encode) -> Result<Self> {
        let mut found = name
            .to_socket_addrs()
            .with_context(|| format!("cannot find {name}"))?;
        let to = found.next();
        let to = to.ok_or_else(|| anyhow!("{name} has no address"))?;
        let any = match to {
            SocketAddr::V4(_) => "0.0.0.0:0",
            SocketAddr::V6(_) => "[::]:0",
        };
        let socket = UdpSocket::bind(any).context("cannot open a UDP socket")?;
        Ok(Stream {
            name: name.to_string(),
            socket,
            to,
            encode,
            unsent: 0,
            error: None,
        })
    }

    /// A datagram that cannot be sent is counted: a network that is away for a moment does not end
    /// the run.
    fn send(&mut self, result: &TrackResult) -> Result<()> {
        for datagram in (self.encode)(result)? {
            if let Err(error) = self.socket.send_to(&datagram, self.to) {
                self.unsent += 1;
                self.error = Some(error);
            }
        }
        Ok(())
    }

    fn warning(&self) -> Option<String> {
        let (count, name) = (self.unsent, &self.name);
        let error = self.error.as_ref()?;
        Some(format!(
            "{count} datagrams to {name} were not sent: {error}"
        ))
    }
}

/// Lets recorded frames pass at the rate at which they were taken.
#[derive(Default)]
pub struct Pace {
    /// When the first frame passed, and its timestamp \[µs\].
    first: Option<(Instant, i64)>,
}

impl Pace {
    /// Waits until the frame of this timestamp is due. A late frame passes at once.
    pub fn wait(&mut self, timestamp_us: i64) {
        let (start, first_us) = *self.first.get_or_insert((Instant::now(), timestamp_us));
        let since_us = timestamp_us.saturating_sub(first_us);
        let due = Duration::from_micros(u64::try_from(since_us).unwrap_or(0));
        std::thread::sleep(due.saturating_sub(start.elapsed()));
    }
}
