//! What a program without std must have to link Rust code at all; neither is ever reached.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    // A test on the linked library shows that no path leads here.
    loop {}
}

/// `core` is compiled for unwinding and names this symbol, also where nothing unwinds. Whole-program
/// optimisation removes the name; without it, a C program would not link.
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}
