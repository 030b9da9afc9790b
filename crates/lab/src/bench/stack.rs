//! How deep the stack gets: runs code on a stack of our own that was painted before.
//!
//! The memory is ours before the thread starts and after it has ended, so reading it back is
//! defined; the part that the operating system and the thread's start use is measured with an
//! empty run and taken off.

/// Peak stack of `run` beyond that of an empty function \[bytes\]; `None` where it cannot be
/// measured (not Unix, no memory, no thread).
pub fn peak(mut run: impl FnMut() + Send) -> Option<usize> {
    let base = painted::depth_of(&mut || {})?;
    Some(painted::depth_of(&mut run)?.saturating_sub(base))
}

#[cfg(not(unix))]
mod painted {
    pub fn depth_of(_run: &mut (dyn FnMut() + Send)) -> Option<usize> {
        None
    }
}

#[cfg(unix)]
mod painted {
    use std::ffi::c_void;

    /// Far above what a step may use; untouched pages below the guard cost nothing but paint.
    const LEN: usize = 16 << 20;
    /// Unusable bytes at the far end: an overflow faults instead of corrupting.
    const GUARD: usize = 64 << 10;
    const PAINT: u8 = 0xA5;

    type Job<'a> = &'a mut (dyn FnMut() + Send);

    extern "C" fn start(job: *mut c_void) -> *mut c_void {
        // SAFETY: `depth_of` passes a pointer to its `Job`, which outlives the thread (joined
        // there) and is not used by anyone else meanwhile.
        let job = unsafe { &mut *job.cast::<Job<'_>>() };
        job();
        std::ptr::null_mut()
    }

    /// Bytes of a fresh stack that `run` and the thread's own start-up touch.
    pub fn depth_of(run: Job<'_>) -> Option<usize> {
        let mut job: Job<'_> = run;
        // SAFETY: plain calls with valid arguments. The mapping is private, is painted before the
        // thread exists and read after it was joined, and is unmapped last. Stacks grow down on
        // every target that Rust's std supports here, so the guard lies at the low end.
        unsafe {
            let flags = libc::MAP_PRIVATE | libc::MAP_ANON;
            let access = libc::PROT_READ | libc::PROT_WRITE;
            let base = libc::mmap(std::ptr::null_mut(), GUARD + LEN, access, flags, -1, 0);
            if base == libc::MAP_FAILED {
                return None;
            }
            let stack = base.cast::<u8>().add(GUARD);
            std::ptr::write_bytes(stack, PAINT, LEN);
            let joined = libc::mprotect(base, GUARD, libc::PROT_NONE) == 0
                && run_on(stack, (&raw mut job).cast());
            let memory = std::slice::from_raw_parts(stack, LEN);
            let untouched = memory.iter().take_while(|b| **b == PAINT).count();
            libc::munmap(base, GUARD + LEN);
            joined.then_some(LEN - untouched)
        }
    }

    /// Starts a thread on `LEN` bytes at `stack` and waits for its end.
    ///
    /// # Safety
    /// `stack` must be writable and unused, `job` point to a live `Job`.
    unsafe fn run_on(stack: *mut u8, job: *mut c_void) -> bool {
        // SAFETY: as the caller promises; the attribute object is initialised before use.
        unsafe {
            let mut attr = std::mem::MaybeUninit::<libc::pthread_attr_t>::uninit();
            if libc::pthread_attr_init(attr.as_mut_ptr()) != 0 {
                return false;
            }
            let mut thread = std::mem::zeroed();
            let ok = libc::pthread_attr_setstack(attr.as_mut_ptr(), stack.cast(), LEN) == 0
                && libc::pthread_create(&mut thread, attr.as_ptr(), start, job) == 0
                && libc::pthread_join(thread, std::ptr::null_mut()) == 0;
            libc::pthread_attr_destroy(attr.as_mut_ptr());
            ok
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[inline(never)]
    fn use_stack<const N: usize>() {
        let mut bytes = [1u8; N];
        std::hint::black_box(&mut bytes);
    }

    #[test]
    fn sees_what_a_function_uses() {
        let deep = peak(use_stack::<300_000>).unwrap();
        assert!((290_000..420_000).contains(&deep), "{deep}");
        assert!(peak(|| ()).unwrap() < 4096);
    }
}
