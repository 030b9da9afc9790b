//! `posewise view`: tracks INPUT here and shows it in browsers, through a local web server.

mod frame;
mod http;
mod latest;
mod page;
mod playback;
mod server;

use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use self::frame::Encoder;
use self::playback::Playback;
use self::server::Server;
use crate::cli::{TrackerArgs, ViewArgs};
use crate::interrupt::Interrupt;
use crate::model_file::ModelFile;
use crate::monitor::watch::Watch;
use crate::output;
use crate::session::Session;

/// Runs the command, until a signal or the end of the input.
pub fn run(args: &ViewArgs) -> Result<()> {
    let file = ModelFile::read(args.tracker.model.as_deref())?;
    let model = file.model()?;
    args.frame.check(&args.tracker)?;
    let mut playback = Playback::open(args)?;
    let settings = TrackerArgs {
        natural_gaze: args.tracker.natural_gaze || args.monitor,
        ..args.tracker.clone()
    };
    let mut session = Session::new(&model, &settings, playback.is_live())?;
    session.set_roi(args.frame.roi)?;
    let interrupt = Interrupt::listen().context("cannot listen for signals")?;
    let server = Server::start(args.bind, &args.host)?;
    output::print(&announcement(&server))?;
    let ended = follow(args, &mut playback, &mut session, &server, &interrupt);
    server.end(match &ended {
        Ok(()) if interrupt.status().is_none() => "The input has ended.",
        Ok(()) => "The command has ended.",
        Err(_) => "The input broke off.",
    });
    // A signal reaches the programs at the other end of a pipe too.
    match interrupt.status() {
        Some(_) => Ok(()),
        None => ended,
    }
}

/// Tracks frame by frame. Pictures are made only when somebody looks.
fn follow(
    args: &ViewArgs,
    playback: &mut Playback<'_>,
    session: &mut Session<'_>,
    server: &Server,
    interrupt: &Interrupt,
) -> Result<()> {
    let encoder = Encoder::new(args.width);
    let mut watch = match args.monitor {
        true => Some(Watch::new(&args.monitor_settings, None, false)?),
        false => None,
    };
    let mut encoding = Duration::ZERO;
    while interrupt.status().is_none() {
        let Some(picture) = playback.next()? else {
            break;
        };
        let before = session.busy;
        session.step(&picture)?;
        // The page does not show the tracker's events.
        while session.events().pop().is_some() {}
        if let Some(watch) = &mut watch {
            watch.see(session.result(), picture.timestamp_us)?;
            watch.forget_old_events();
            let (camera, size) = (session.intrinsics(), session.size());
            if let Some(turn) = watch.keep(picture.timestamp_us, &camera, size) {
                session.turn(turn, args.frame.roi)?;
            }
        }
        if server.latest().is_wanted() {
            let start = Instant::now();
            let times = [session.busy - before, encoding];
            server
                .latest()
                .put(encoder.message(&picture, session, times, watch.as_mut())?);
            encoding = start.elapsed();
        }
    }
    Ok(())
}

fn announcement(server: &Server) -> String {
    let (url, address) = (server.url(), server.address());
    let mut text = format!("{url}\n");
    let port = address.port();
    if address.ip().is_loopback() {
        text += &format!(
            "From another machine: ssh -L {port}:{address} USER@THIS-MACHINE, then open it there.\n"
        );
    } else {
        text += "Whoever can reach this machine and knows the address sees the pictures.\n";
    }
    text + "Ctrl-C ends it.\n"
}
