//! The panic handler that a program without std needs to link Rust code. It is never reached.
//!
//! `rust_eh_personality` is not defined here: the library must link beside others in Rust. Whole-
//! program optimisation (profile dist) removes the references to it in `core`.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    // tests/link.rs shows that no path of the linked library leads here.
    loop {}
}
