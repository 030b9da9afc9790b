//! `cargo xtask`: developer commands; see `crates/xtask/src/lib.rs`.

use anyhow::{Context, Result};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use xtask::{
    Library, code_size, cores, demo_clip, figures, interface, mobile, notices, picture, release,
    replay, root, site, size_table, web,
};

/// Measures the static library and the models.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Tracks a clip: prints a hash of every result, then sizes on standard error
    Replay {
        #[command(flatten)]
        build: Build,
        #[command(flatten)]
        clip: Clip,
        /// Frames to track, at most
        #[arg(long, default_value_t = 100)]
        frames: usize,
    },
    /// Prints the bytes of code and constants that a program gets, without the model
    Size {
        #[command(flatten)]
        build: Build,
    },
    /// Prints a table of all sizes, with and without what can be left out
    Sizes {
        #[command(flatten)]
        build: Build,
        #[command(flatten)]
        clip: Clip,
    },
    /// Estimates how long a tracking step takes on ARM cores, and how far off that is here
    Cores,
    /// Measures a model and writes its figures as JSON
    Measure(figures::measure::Args),
    /// Writes docs/accuracy.md and the figures in README.md from the JSON of `measure`
    Accuracy,
    /// Appends the figures of this version to docs/history.json, or writes them anew
    History,
    /// Writes what says again what src/ffi describes: posewise.h, layouts for other languages
    Interface,
    /// Writes packaging/NOTICES*.txt, the licences of what is linked in, as `make install` does
    Notices,
    /// Writes docs/tracked.png, the picture in README.md
    Picture,
    /// Builds the web page and the JavaScript package in target/web
    Web {
        /// Serves the page on this machine, at http://127.0.0.1:8040/
        #[arg(long)]
        serve: bool,
        /// Serves it at another port
        #[arg(long, default_value_t = 8040, requires = "serve")]
        port: u16,
    },
    /// Builds the documentation as a site, with the demo, in target/site; links are checked
    Site,
    /// Makes a folder in the shape of an AAR for Android, and prints its path
    Android,
    /// Makes an XCFramework for iOS, and prints its path
    Ios,
    /// Makes every package that this machine has the tools for, with checksums (`make release`)
    Release {
        /// The folder of the packages, which is emptied [default: target/packages]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Makes only these, separated by commas [default: all]
        #[arg(long, value_name = "NAMES", value_delimiter = ',')]
        only: Vec<String>,
    },
}

#[derive(Args)]
struct Build {
    /// The machine, by its name in Rust [default: this one]
    #[arg(long)]
    target: Option<String>,
    /// Parts to leave out, separated by commas
    #[arg(long, value_delimiter = ',')]
    without: Vec<String>,
}

impl Build {
    fn library(self) -> Library {
        Library {
            target: self.target,
            without: self.without,
            target_dir: target_dir(),
        }
    }
}

#[derive(Args)]
struct Clip {
    /// A grey y4m video of at most 640×480 [default: tests/data/demo.y4m.gz]
    #[arg(long)]
    clip: Option<PathBuf>,
}

impl Clip {
    fn path(self) -> Result<PathBuf> {
        match self.clip {
            Some(clip) => clip.canonicalize().with_context(|| format!("{clip:?}")),
            None => demo_clip(&target_dir()),
        }
    }
}

/// Cargo's build folder.
fn target_dir() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => folder.into(),
        None => root().join("target"),
    }
}

fn main() -> Result<()> {
    match Cli::parse().command {
        Task::Replay {
            build,
            clip,
            frames,
        } => {
            let replay = replay(&build.library(), &clip.path()?, frames, 0)?;
            eprint!("{}", replay.notes);
            print!("{}", replay.line);
        }
        Task::Size { build } => println!("{}", code_size(&build.library())?),
        Task::Sizes { build, clip } => {
            print!("{}", size_table(&build.library(), &clip.path()?)?);
        }
        Task::Cores => cores::run(&target_dir())?,
        Task::Measure(args) => figures::measure::run(&args)?,
        Task::Accuracy => figures::pages::write()?,
        Task::History => figures::history::write()?,
        Task::Interface => println!("written: {:?}", interface::write()?),
        Task::Notices => notices::write()?,
        Task::Picture => picture::write()?,
        Task::Web { serve, port } => {
            let folder = web::build(&target_dir())?;
            println!("{}", folder.display());
            if serve {
                let site = web::Site::bind(&folder, port)?;
                println!("{} (Ctrl-C ends it)", site.url()?);
                site.serve();
            }
        }
        Task::Site => println!("{}", site::build(&target_dir())?.display()),
        Task::Android => println!("{}", mobile::android(&target_dir())?.display()),
        Task::Ios => println!("{}", mobile::ios(&target_dir())?.display()),
        Task::Release { out, only } => {
            let folder = out.unwrap_or_else(|| target_dir().join("packages"));
            let packer = release::Packer::new(&target_dir(), &folder)?;
            for (what, outcome) in packer.pack(&only)? {
                println!("{what}: {outcome}");
            }
        }
    }
    Ok(())
}
