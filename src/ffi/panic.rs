//! The panic handler that a program without std needs to link Rust code. It is never reached in the
//! library as it ships; in builds with overflow checks or assertions it stops the program.
//!
//! `rust_eh_personality` is not defined here: the library must link beside others in Rust. Whole-
//! program optimisation (profile dist) removes the references to it in `core`.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    // tests/shipping/link.rs shows that no path of the linked library leads here.
    trap()
}

/// Executes an undefined instruction, at which a debugger stops or the system ends the program.
/// Where Rust has no stable name for one, does not return.
fn trap() -> ! {
    // SAFETY: control never comes back.
    #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
    unsafe {
        core::arch::asm!("ud2", options(noreturn, nomem, nostack))
    }
    // SAFETY: as above.
    #[cfg(any(target_arch = "aarch64", target_arch = "arm"))]
    unsafe {
        core::arch::asm!("udf #0", options(noreturn, nomem, nostack))
    }
    // SAFETY: as above.
    #[cfg(any(target_arch = "riscv32", target_arch = "riscv64"))]
    unsafe {
        core::arch::asm!("unimp", options(noreturn, nomem, nostack))
    }
    #[cfg(target_family = "wasm")]
    core::arch::wasm32::unreachable();
    #[cfg(not(any(
        target_arch = "x86_64",
        target_arch = "x86",
        target_arch = "aarch64",
        target_arch = "arm",
        target_arch = "riscv32",
        target_arch = "riscv64",
        target_family = "wasm"
    )))]
    loop {}
}
