//! The floating-point environment of a call: rounding to nearest, subnormal numbers as they are,
//! no trapping exception, whatever the caller's is. Results are then the same bits, and ordinary
//! arithmetic does not trap. Rust, too, requires this environment.
//!
//! | machine | register | what else of it matters |
//! |---|---|---|
//! | x86-64, x86 with SSE2 | MXCSR | flush to zero, denormals are zero |
//! | AArch64 | FPCR, FPSR | flush to zero, default NaN |
//! | ARM with a floating-point unit | FPSCR | the same, and the length of vectors |
//!
//! Elsewhere nothing is done. WebAssembly and processors without a floating-point unit have one
//! environment only. On others (RISC-V, PowerPC) the caller's must be the default.

/// Runs `body` in the default environment, then restores the caller's, flags of exceptions too.
pub(super) fn with_default<T>(body: impl FnOnce() -> T) -> T {
    let caller = Environment::swap(Environment::DEFAULT);
    let result = separate(body);
    Environment::swap(caller);
    result
}

/// Not inlined: no arithmetic of `body` moves to where the caller's environment holds.
#[inline(never)]
fn separate<T>(body: impl FnOnce() -> T) -> T {
    body()
}

/// The registers: MXCSR, FPSCR, or FPCR and FPSR.
#[derive(Clone, Copy)]
struct Environment([usize; 2]);

#[cfg(any(
    target_arch = "x86_64",
    all(target_arch = "x86", target_feature = "sse2")
))]
#[cfg(not(miri))]
impl Environment {
    /// MXCSR after a reset: all exceptions masked, nothing else set.
    const DEFAULT: Environment = Environment([0x1F80, 0]);

    /// Sets an environment; returns the one before.
    #[inline]
    fn swap(to: Environment) -> Environment {
        let (mut before, to) = (0u32, to.0[0] as u32);
        // SAFETY: writes one variable and reads the other, each of 32 bits. No reserved bit is set,
        // because `to` is DEFAULT or was read.
        unsafe {
            core::arch::asm!(
                "stmxcsr [{before}]",
                "ldmxcsr [{to}]",
                before = in(reg) &mut before,
                to = in(reg) &to,
                options(nostack)
            );
        }
        Environment([before as usize, 0])
    }
}

#[cfg(all(target_arch = "aarch64", not(miri)))]
impl Environment {
    /// Round to nearest, no trap, no flag.
    const DEFAULT: Environment = Environment([0; 2]);

    /// Sets an environment; returns the one before.
    #[inline]
    fn swap(to: Environment) -> Environment {
        let (control, status);
        // SAFETY: programs may read and write both registers.
        unsafe {
            core::arch::asm!(
                "mrs {control}, fpcr",
                "mrs {status}, fpsr",
                "msr fpcr, {to_control}",
                "msr fpsr, {to_status}",
                control = out(reg) control,
                status = out(reg) status,
                to_control = in(reg) to.0[0],
                to_status = in(reg) to.0[1],
                options(nostack)
            );
        }
        Environment([control, status])
    }
}

// Whether there is a floating-point unit is no stable condition of Rust for ARM, but these ABIs
// have one.
#[cfg(all(
    target_arch = "arm",
    any(target_abi = "eabihf", target_os = "android"),
    not(miri)
))]
impl Environment {
    /// Round to nearest, no trap, no flag, no vectors.
    const DEFAULT: Environment = Environment([0; 2]);

    /// Sets an environment; returns the one before.
    #[inline]
    fn swap(to: Environment) -> Environment {
        let control;
        // SAFETY: programs may read and write the register.
        unsafe {
            core::arch::asm!(
                "vmrs {control}, fpscr",
                "vmsr fpscr, {to}",
                control = out(reg) control,
                to = in(reg) to.0[0],
                options(nostack)
            );
        }
        Environment([control, 0])
    }
}

#[cfg(any(
    miri,
    not(any(
        target_arch = "x86_64",
        all(target_arch = "x86", target_feature = "sse2"),
        target_arch = "aarch64",
        all(target_arch = "arm", any(target_abi = "eabihf", target_os = "android"))
    ))
))]
impl Environment {
    /// The only one.
    const DEFAULT: Environment = Environment([0; 2]);

    /// Does nothing.
    #[inline]
    fn swap(to: Environment) -> Environment {
        Environment(to.0)
    }
}
