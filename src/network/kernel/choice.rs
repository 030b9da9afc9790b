//! The list of kernels, and which of them runs.

use core::sync::atomic::{AtomicU8, Ordering};

/// A kernel's instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum KernelName {
    /// Portable Rust, which defines what the others compute.
    Scalar = 1,
    /// x86-64.
    Sse2,
    /// x86-64 with AVX2.
    Avx2,
    /// x86-64 with AVX2 and AVX512-VNNI.
    Avx512,
    /// x86-64 with AVX2 and AVX-VNNI.
    Vnni,
    /// AArch64.
    Neon,
    /// AArch64 with dot products.
    Dotprod,
    /// WebAssembly with 128-bit SIMD.
    Simd128,
    /// WebAssembly with relaxed SIMD whose dot products are exact.
    Relaxed,
}

impl KernelName {
    /// All kernels, the fastest of each machine last.
    pub const ALL: [KernelName; 9] = [
        Self::Scalar,
        Self::Sse2,
        Self::Avx2,
        Self::Avx512,
        Self::Vnni,
        Self::Neon,
        Self::Dotprod,
        Self::Simd128,
        Self::Relaxed,
    ];

    /// Name on the command line.
    #[cfg(any(test, feature = "unstable-internals"))]
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Vnni => "vnni",
            Self::Neon => "neon",
            Self::Dotprod => "dotprod",
            Self::Simd128 => "simd128",
            Self::Relaxed => "relaxed",
        }
    }

    /// Whether this build has the kernel and this machine runs it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => cfg!(any(test, feature = "unstable-internals", not(simd_kernel))),
            Self::Sse2 => cfg!(target_arch = "x86_64"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => super::avx::has_avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => super::avx::has_avx512(),
            #[cfg(target_arch = "x86_64")]
            Self::Vnni => super::avx::has_vnni(),
            Self::Neon => cfg!(target_arch = "aarch64"),
            Self::Dotprod => cfg!(target_arch = "aarch64") && has_dotprod(),
            Self::Simd128 => cfg!(all(target_arch = "wasm32", simd_kernel)),
            #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
            Self::Relaxed => super::relaxed::is_exact(),
            #[allow(unreachable_patterns, reason = "kernels of other machines")]
            _ => false,
        }
    }
}

/// Number of the chosen kernel, 0 until the first run chooses; and [`DOTPROD`].
static CHOSEN: AtomicU8 = AtomicU8::new(0);

/// The bit of [`CHOSEN`] that says that an AArch64 processor has dot products.
const DOTPROD: u8 = 1 << 7;

fn has_dotprod() -> bool {
    cfg!(target_feature = "dotprod") || CHOSEN.load(Ordering::Relaxed) & DOTPROD != 0
}

/// Says whether an AArch64 processor has dot products, which only its operating system tells. The
/// kernel is chosen anew. Elsewhere, and where the build is for such processors, nothing changes.
///
/// # Safety
/// What it says is true.
pub unsafe fn set_dotprod(has: bool) {
    if cfg!(target_arch = "aarch64") {
        CHOSEN.store(if has { DOTPROD } else { 0 }, Ordering::Relaxed);
    }
}

/// Notes the choice.
fn store(kernel: KernelName) {
    let flag = CHOSEN.load(Ordering::Relaxed) & DOTPROD;
    CHOSEN.store(kernel as u8 | flag, Ordering::Relaxed);
}

/// The kernel that runs: the fastest of this machine, unless another was selected.
#[inline]
pub fn chosen_kernel() -> KernelName {
    let chosen = CHOSEN.load(Ordering::Relaxed) & !DOTPROD;
    let known = KernelName::ALL.into_iter().find(|k| *k as u8 == chosen);
    match known {
        Some(kernel) => kernel,
        None => choose(),
    }
}

#[cold]
fn choose() -> KernelName {
    let mut available = KernelName::ALL
        .into_iter()
        .rev()
        .filter(|k| k.is_available());
    let fastest = available.next().unwrap_or(KernelName::Scalar);
    store(fastest);
    fastest
}

/// Makes every tracker run this kernel from its next network on. Returns false, and changes
/// nothing, where it is not available.
#[cfg(any(test, feature = "unstable-internals"))]
pub fn select_kernel(kernel: KernelName) -> bool {
    let available = kernel.is_available();
    if available {
        store(kernel);
    }
    available
}

/// The chosen kernel.
#[derive(Clone, Copy)]
pub(in crate::network) enum Chosen {
    #[cfg(target_arch = "x86_64")]
    Vnni(super::vnni::Vnni),
    #[cfg(target_arch = "x86_64")]
    Avx512(super::avx512::Avx512),
    #[cfg(target_arch = "x86_64")]
    Avx2(super::avx2::Avx2),
    #[cfg(target_arch = "x86_64")]
    Sse2(super::sse2::Sse2),
    #[cfg(target_arch = "aarch64")]
    Dotprod(super::dotprod::Dotprod),
    #[cfg(target_arch = "aarch64")]
    Neon(super::neon::Neon),
    #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
    Relaxed(super::relaxed::Relaxed),
    #[cfg(all(target_arch = "wasm32", simd_kernel))]
    Simd128(super::simd128::Simd128),
    #[cfg(any(test, feature = "unstable-internals", not(simd_kernel)))]
    Scalar(super::scalar::Scalar),
}

/// The chosen kernel, for [`dispatch`].
#[inline]
pub(in crate::network) fn chosen() -> Chosen {
    // SAFETY: only what is available is chosen.
    unsafe { of_name(chosen_kernel()) }
}

/// The kernel of a name.
///
/// # Safety
/// It is available.
#[inline]
pub(super) unsafe fn of_name(name: KernelName) -> Chosen {
    match name {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the caller promises that it is available.
        KernelName::Vnni => Chosen::Vnni(unsafe { super::vnni::Vnni::new() }),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        KernelName::Avx512 => Chosen::Avx512(unsafe { super::avx512::Avx512::new() }),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        KernelName::Avx2 => Chosen::Avx2(unsafe { super::avx2::Avx2::new() }),
        #[cfg(all(simd_kernel, any(test, feature = "unstable-internals")))]
        KernelName::Scalar => Chosen::Scalar(super::scalar::Scalar),
        #[cfg(target_arch = "x86_64")]
        _ => Chosen::Sse2(super::sse2::Sse2),
        #[cfg(target_arch = "aarch64")]
        // SAFETY: the caller promises that it is available.
        KernelName::Dotprod => Chosen::Dotprod(unsafe { super::dotprod::Dotprod::new() }),
        #[cfg(target_arch = "aarch64")]
        _ => Chosen::Neon(super::neon::Neon),
        #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
        // SAFETY: the caller promises that it is available.
        KernelName::Relaxed => Chosen::Relaxed(unsafe { super::relaxed::Relaxed::new() }),
        #[cfg(all(target_arch = "wasm32", simd_kernel))]
        _ => Chosen::Simd128(super::simd128::Simd128),
        #[cfg(not(simd_kernel))]
        _ => Chosen::Scalar(super::scalar::Scalar),
    }
}

/// Evaluates an expression with the chosen [`Kernel`](super::Kernel).
macro_rules! dispatch {
    ($kernel:ident => $call:expr) => {{
        use crate::network::kernel::{Chosen, chosen};
        match chosen() {
            #[cfg(target_arch = "x86_64")]
            Chosen::Vnni($kernel) => $call,
            #[cfg(target_arch = "x86_64")]
            Chosen::Avx512($kernel) => $call,
            #[cfg(target_arch = "x86_64")]
            Chosen::Avx2($kernel) => $call,
            #[cfg(target_arch = "x86_64")]
            Chosen::Sse2($kernel) => $call,
            #[cfg(target_arch = "aarch64")]
            Chosen::Dotprod($kernel) => $call,
            #[cfg(target_arch = "aarch64")]
            Chosen::Neon($kernel) => $call,
            #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
            Chosen::Relaxed($kernel) => $call,
            #[cfg(all(target_arch = "wasm32", simd_kernel))]
            Chosen::Simd128($kernel) => $call,
            #[cfg(any(test, feature = "unstable-internals", not(simd_kernel)))]
            Chosen::Scalar($kernel) => $call,
        }
    }};
}
pub(in crate::network) use dispatch;
