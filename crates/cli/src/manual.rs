//! Manual pages and shell completions, from the command line's grammar. `make install` writes them.

use std::path::Path;

use anyhow::{Context, Result};
use clap::{Command, CommandFactory};
use clap_complete::Shell;

use crate::cli::Cli;

/// The shells, each with the folder in which it looks for completions.
const SHELLS: [(Shell, &str); 3] = [
    (Shell::Bash, "bash-completion/completions"),
    (Shell::Zsh, "zsh/site-functions"),
    (Shell::Fish, "fish/vendor_completions.d"),
];

/// Writes all of them below a folder that has the shape of /usr/share.
pub fn write(folder: &Path) -> Result<()> {
    let make = |name: &str| {
        let path = folder.join(name);
        std::fs::create_dir_all(&path).with_context(|| format!("cannot create {path:?}"))?;
        anyhow::Ok(path)
    };
    let pages = make("man/man1")?;
    clap_mangen::generate_to(grammar(), &pages)
        .with_context(|| format!("cannot write manual pages into {pages:?}"))?;
    for (shell, name) in SHELLS {
        let completions = make(name)?;
        clap_complete::generate_to(shell, &mut grammar(), "posewise", &completions)
            .with_context(|| format!("cannot write completions into {completions:?}"))?;
    }
    Ok(())
}

/// The grammar without hidden commands, which completions for zsh would show.
fn grammar() -> Command {
    let all = Cli::command();
    let shown = all.get_subcommands().filter(|c| !c.is_hide_set()).cloned();
    let mut own = Command::new("posewise").version(env!("CARGO_PKG_VERSION"));
    own = own.about(all.get_about().cloned().unwrap_or_default());
    own.subcommands(shown)
}
