//! What a program does before and after its command: the machine, the stack, the exit code.

use std::process::ExitCode;

use anyhow::Result;

use crate::output;

/// The tracker is plain data and may be moved by value; debug builds keep several copies.
const STACK_BYTES: usize = 64 << 20;

/// Runs a command on a stack of its own; `name` is for messages. The command may ask for an exit
/// status.
pub fn run(name: &str, command: impl FnOnce() -> Result<Option<u8>> + Send + 'static) -> ExitCode {
    end_on_panic();
    detect_cpu();
    report_large_files();
    let outcome = std::thread::Builder::new()
        .stack_size(STACK_BYTES)
        .spawn(command)
        .map(|thread| thread.join());
    match outcome {
        Ok(Ok(Ok(None))) => ExitCode::SUCCESS,
        Ok(Ok(Ok(Some(status)))) => ExitCode::from(status),
        Ok(Ok(Err(error))) if output::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Ok(Ok(Err(error))) => {
            eprintln!("{name}: {error:#}");
            ExitCode::FAILURE
        }
        Ok(Err(_)) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{name}: cannot start a thread: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A panic in any thread ends the program: the others would wait for that thread, or go on without
/// it.
fn end_on_panic() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        report(panic);
        std::process::abort();
    }));
}

/// Tells the library what of the processor it cannot find out without an operating system.
fn detect_cpu() {
    #[cfg(target_arch = "aarch64")]
    // SAFETY: the operating system says so.
    unsafe {
        posewise::set_dotprod(std::arch::is_aarch64_feature_detected!("dotprod"));
    }
}

/// Writing beyond the limit of a file's size becomes an error like others, in place of a signal
/// that ends the program and leaves what is half-written.
fn report_large_files() {
    #[cfg(unix)]
    // SAFETY: no handler is set, the signal is only ignored.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}
