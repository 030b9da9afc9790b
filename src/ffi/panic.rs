//! Symbols that a program without std needs to link Rust code. Neither is ever reached.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    // tests/link.rs shows that no path of the linked library leads here.
    loop {}
}

/// `core` is compiled for unwinding and refers to this symbol even where nothing unwinds. Fat LTO
/// removes the reference; builds without it need the symbol to link.
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}
