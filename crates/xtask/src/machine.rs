//! How C is compiled for a machine, and how a program for it is run here.

use crate::root;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Command;

/// Seconds after which an emulated program is taken to hang.
const EMULATION_TIMEOUT_S: &str = "1800";

/// Where Debian's package wine64 has it; it puts nothing on the path.
pub const WINE: &str = "/usr/lib/wine/wine64";

/// A machine with a C compiler and, where it is another one than this, an emulator.
pub struct Machine {
    compiler: Vec<String>,
    size: &'static str,
    emulator: &'static [&'static str],
    /// Whether there is no operating system: files and arguments come from the debugger.
    bare: bool,
}

impl Machine {
    /// The machine of this name in Rust; `None` is this one.
    pub fn named(target: Option<&str>) -> Result<Self> {
        let words = |line: &str| line.split(' ').map(String::from).collect();
        Ok(match target {
            // Android's C library is not needed: a Linux program links the library as well.
            None | Some("x86_64-linux-android") => Machine {
                compiler: vec![std::env::var("CC").unwrap_or("cc".into())],
                size: "size",
                emulator: &[],
                bare: false,
            },
            Some("aarch64-unknown-linux-gnu" | "aarch64-linux-android") => Machine {
                compiler: words("aarch64-linux-gnu-gcc -static"),
                size: "aarch64-linux-gnu-size",
                emulator: &["qemu-aarch64-static", "-cpu", "cortex-a76"],
                bare: false,
            },
            Some("armv7-unknown-linux-gnueabihf") => Machine {
                compiler: words("arm-linux-gnueabihf-gcc -static"),
                size: "arm-linux-gnueabihf-size",
                emulator: &["qemu-arm-static", "-cpu", "cortex-a7"],
                bare: false,
            },
            Some("thumbv7em-none-eabihf") => Machine {
                compiler: words(
                    "arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16",
                ),
                size: "arm-none-eabi-size",
                emulator: &["qemu-system-arm", "-M", "mps2-an386"],
                bare: true,
            },
            Some("x86_64-pc-windows-gnu") => Machine {
                compiler: words("x86_64-w64-mingw32-gcc -static"),
                size: "x86_64-w64-mingw32-size",
                emulator: &[WINE],
                bare: false,
            },
            Some(other) => bail!("no compiler and emulator are known for {other}"),
        })
    }

    /// The C compiler with the flags that choose the machine.
    pub fn compiler(&self) -> Command {
        let mut command = Command::new(&self.compiler[0]);
        command.args(&self.compiler[1..]);
        command
    }

    /// What the names of programs end with.
    pub fn suffix(&self) -> &'static str {
        match self.emulator {
            [WINE, ..] => ".exe",
            _ => "",
        }
    }

    /// The `size` of binutils.
    pub fn size(&self) -> Command {
        Command::new(self.size)
    }

    /// Further arguments for linking a whole program: on a bare machine its start-up code and its
    /// memory map. Files, standard output and exit status go through the debugger (semihosting).
    pub fn start_up(&self) -> Vec<String> {
        if !self.bare {
            return Vec::new();
        }
        let board = root().join("ffi-examples/bare-metal");
        let flags = "--specs=rdimon.specs -nostartfiles -Wl,--no-warn-execstack -T";
        let files = ["mps2-an386.ld", "start.c"].map(|file| board.join(file));
        flags
            .split(' ')
            .map(String::from)
            .chain(files.map(|file| file.display().to_string()))
            .collect()
    }

    /// Runs a program, in the emulator if there is one. Arguments must have no blanks or commas.
    pub fn run(&self, program: &Path, arguments: &[String]) -> Command {
        let Some(emulator) = self.emulator.first() else {
            let mut command = Command::new(program);
            command.args(arguments);
            return command;
        };
        let mut command = Command::new("timeout");
        // Wine keeps its files beside the program, and says nothing of what it lacks.
        command.env("WINEPREFIX", program.with_file_name("wine"));
        command.env("WINEDEBUG", "-all");
        command.args([EMULATION_TIMEOUT_S, emulator]);
        command.args(&self.emulator[1..]);
        if !self.bare {
            command.arg(program).args(arguments);
            return command;
        }
        command.args(["-nographic", "-monitor", "none", "-serial", "null"]);
        let mut semihosting = String::from("enable=on,target=native,arg=program");
        for argument in arguments {
            semihosting += &format!(",arg={argument}");
        }
        command.args(["-semihosting-config", &semihosting]);
        command.arg("-kernel").arg(program);
        command
    }
}
