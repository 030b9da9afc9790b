//! Memory with the alignment of a model.

/// A value at a multiple of 64 bytes, as [`Blob::open`](crate::Blob::open) requires of a model.
///
/// For a model that is embedded in a program:
///
/// ```
/// # macro_rules! include_bytes { ($path:literal) => { b"" } }
/// use posewise_format::Aligned;
/// static MODEL: &Aligned<[u8]> = &Aligned(*include_bytes!("my.posewise"));
/// let bytes: &[u8] = &MODEL.0;
/// ```
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct Aligned<B: ?Sized>(pub B);

const _: () = assert!(align_of::<Aligned<[u8; 1]>>() == crate::ALIGN);

/// Bytes on the heap that start at a multiple of [`ALIGN`](crate::ALIGN), for a model that is read
/// from a file.
#[cfg(feature = "alloc")]
pub struct AlignedBytes {
    storage: alloc::vec::Vec<u8>,
    start: usize,
}

#[cfg(feature = "alloc")]
impl AlignedBytes {
    /// Copies the bytes.
    pub fn new(bytes: &[u8]) -> Self {
        let mut storage = alloc::vec![0; bytes.len() + crate::ALIGN];
        // The heap block does not move when the struct does, so the offset stays right. Under Miri
        // `align_offset` may fail, which gives a start that `Blob::open` rejects.
        let start = storage
            .as_ptr()
            .align_offset(crate::ALIGN)
            .min(crate::ALIGN);
        storage.truncate(start + bytes.len());
        storage[start..].copy_from_slice(bytes);
        AlignedBytes { storage, start }
    }
}

#[cfg(feature = "alloc")]
impl core::ops::Deref for AlignedBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.storage[self.start..]
    }
}

#[cfg(feature = "alloc")]
impl core::ops::DerefMut for AlignedBytes {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut self.storage[self.start..]
    }
}
