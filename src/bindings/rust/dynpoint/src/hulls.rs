// SPDX-License-Identifier: BSD-3-Clause
use crate::block::{first_of, Block};
use crate::error::{check, count_of};
use crate::{sys, Error, HullInfo, Pose, Result};
use core::{marker::PhantomData, mem::MaybeUninit, ptr::NonNull};

/// A convex polyhedron with rounded edges: what a tool's tip is made of. It does not change; threads and worlds share it.
#[derive(Clone)]
pub struct Hull<'a> {
    raw: NonNull<sys::dpt_hull>,
    #[cfg(feature = "alloc")]
    _block: alloc::sync::Arc<Block<'a>>,
    lent: PhantomData<&'a [u64]>,
}

// SAFETY: a hull is read-only (hull.h).
unsafe impl Send for Hull<'_> {}
// SAFETY: as above.
unsafe impl Sync for Hull<'_> {}

/// A hull, and where its frame is in its tool's.
#[derive(Clone, Copy)]
pub struct Tip<'h, 'a> {
    /// The hull; the world keeps it while the tool has the tip.
    pub hull: &'h Hull<'a>,
    /// Where its frame is in the tool's.
    pub pose: Pose,
}

impl<'a> Hull<'a> {
    fn def(corners: &[[f64; 3]], radius: f64) -> Result<sys::dpt_hull_def> {
        Ok(sys::dpt_hull_def {
            size: core::mem::size_of::<sys::dpt_hull_def>() as u32,
            corner_count: count_of(corners.len())?,
            corners: first_of(corners).cast(),
            reserved_pointer: core::ptr::null(),
            radius,
        })
    }

    /// The bytes that a hull of these corners needs.
    pub fn bytes(corners: &[[f64; 3]], radius: f64) -> Result<usize> {
        // SAFETY: there are as many corners.
        match unsafe { sys::dpt_hull_bytes(&Self::def(corners, radius)?) } {
            0 => Err(Error::ARGUMENT),
            bytes => Ok(bytes),
        }
    }

    /// Make a hull of corners in memory of its own.
    #[cfg(feature = "alloc")]
    pub fn new(corners: &[[f64; 3]], radius: f64) -> Result<Self> {
        Self::create(Block::new(Self::bytes(corners, radius)?)?, corners, radius)
    }

    /// Make a hull in a block of yours, of [`Hull::bytes`] or more.
    pub fn new_in(block: &'a mut [MaybeUninit<u64>], corners: &[[f64; 3]], radius: f64) -> Result<Self> {
        Self::create(Block::lent(block), corners, radius)
    }

    fn create(block: Block<'a>, corners: &[[f64; 3]], radius: f64) -> Result<Self> {
        let mut hull = core::ptr::null();
        let def = Self::def(corners, radius)?;
        // SAFETY: the block is the hull's from now on; corners are copied.
        check(unsafe { sys::dpt_hull_create(block.start(), block.bytes(), &def, &mut hull) })?;
        Ok(Self {
            raw: NonNull::new(hull.cast_mut()).ok_or(Error::ARGUMENT)?,
            #[cfg(feature = "alloc")]
            _block: alloc::sync::Arc::new(block),
            lent: PhantomData,
        })
    }

    /// The hull, for calls of [`crate::sys`].
    pub fn as_raw(&self) -> *const sys::dpt_hull {
        self.raw.as_ptr()
    }

    /// What it has.
    pub fn info(&self) -> Result<HullInfo> {
        let mut info = HullInfo::empty();
        // SAFETY: the info has its size.
        check(unsafe { sys::dpt_hull_get_info(self.as_raw(), info.raw_mut()) })?;
        Ok(info)
    }
}

impl core::fmt::Debug for Hull<'_> {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "Hull: {:?}", self.info())
    }
}
