// SPDX-License-Identifier: BSD-3-Clause
//! Memory of nouns of the library. It is known by its address alone: no reference to it is held while C uses it.
#[cfg(feature = "alloc")]
use crate::{Error, Result};
use core::{marker::PhantomData, mem::MaybeUninit, ptr::NonNull};

pub(crate) struct Block<'a> {
    start: NonNull<u8>,
    bytes: usize,
    #[cfg(feature = "alloc")]
    owned: Option<core::alloc::Layout>,
    lent: PhantomData<&'a mut [u64]>,
}

// SAFETY: bytes that belong to it alone.
unsafe impl Send for Block<'_> {}
// SAFETY: nothing is done to them by a shared reference.
unsafe impl Sync for Block<'_> {}

impl<'a> Block<'a> {
    pub(crate) fn lent(block: &'a mut [MaybeUninit<u64>]) -> Self {
        Self {
            bytes: core::mem::size_of_val(block),
            start: NonNull::from(block).cast(),
            #[cfg(feature = "alloc")]
            owned: None,
            lent: PhantomData,
        }
    }

    /// `bytes` of 0 is what the library says of a def that is not valid.
    #[cfg(feature = "alloc")]
    pub(crate) fn new(bytes: usize) -> Result<Self> {
        if bytes == 0 {
            return Err(Error::ARGUMENT);
        }
        let layout = core::alloc::Layout::from_size_align(bytes, 64).map_err(|_| Error::MEMORY)?;
        // SAFETY: the size is not 0.
        let start = NonNull::new(unsafe { alloc::alloc::alloc(layout) }).ok_or(Error::MEMORY)?;
        Ok(Self { start, bytes, owned: Some(layout), lent: PhantomData })
    }

    /// A copy of plain numbers.
    #[cfg(feature = "alloc")]
    pub(crate) fn copy_of<T: Copy>(items: &[T]) -> Result<Self> {
        let bytes = core::mem::size_of_val(items);
        let block = Self::new(bytes)?;
        // SAFETY: the block is new and as long.
        unsafe { core::ptr::copy_nonoverlapping(items.as_ptr().cast::<u8>(), block.start.as_ptr(), bytes) };
        Ok(block)
    }

    pub(crate) fn start<T>(&self) -> *mut T {
        self.start.as_ptr().cast()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(feature = "alloc")]
impl Drop for Block<'_> {
    fn drop(&mut self) {
        if let Some(layout) = self.owned {
            // SAFETY: it was allocated so, and is freed once.
            unsafe { alloc::alloc::dealloc(self.start.as_ptr(), layout) };
        }
    }
}

/// An array that the library tells of.
///
/// # Safety
/// NULL, or `count` items that stay as they are for `'b`.
pub(crate) unsafe fn slice<'b, T>(start: *const T, count: usize) -> &'b [T] {
    if start.is_null() || count == 0 {
        &[]
    } else {
        // SAFETY: as above.
        unsafe { core::slice::from_raw_parts(start, count) }
    }
}

/// The address of the first item, or NULL of none: what C takes for no array.
pub(crate) fn first_of<T>(items: &[T]) -> *const T {
    if items.is_empty() {
        core::ptr::null()
    } else {
        items.as_ptr()
    }
}

pub(crate) fn first_of_mut<T>(items: &mut [T]) -> *mut T {
    if items.is_empty() {
        core::ptr::null_mut()
    } else {
        items.as_mut_ptr()
    }
}

/// All items of a list of unknown length: `fill` writes to the room that it is given, and tells how many there are.
#[cfg(feature = "alloc")]
pub(crate) fn all_of<T: Copy + Default>(fill: impl Fn(&mut [T], &mut u32) -> Result<()>) -> Result<alloc::vec::Vec<T>> {
    let mut items = alloc::vec![T::default(); 16];
    loop {
        let (mut count, room) = (0, items.len());
        let told = fill(&mut items, &mut count);
        let is_cut = count as usize > room;
        if !is_cut {
            told?;
        }
        items.resize(count as usize, T::default());
        if !is_cut {
            return Ok(items);
        }
    }
}
