// SPDX-License-Identifier: BSD-3-Clause
//! Functions that shape a tool's wrench. C holds an address; no reference is held beside it.
use crate::{sys, ForceInfo, Wrench};
use alloc::boxed::Box;
use core::{ffi::c_void, marker::PhantomData, ptr::NonNull};

type Shape<'a> = dyn FnMut(&ForceInfo, f64, &mut Wrench) + Send + 'a;

struct Inner<'a> {
    shape: Box<Shape<'a>>,
    #[cfg(feature = "std")]
    panic: Option<Box<dyn core::any::Any + Send>>,
}

pub(crate) struct Shaper<'a> {
    inner: NonNull<Inner<'a>>,
    owned: PhantomData<Inner<'a>>,
}

// SAFETY: the function may be sent, and is called where the world is.
unsafe impl Send for Shaper<'_> {}

impl<'a> Shaper<'a> {
    pub(crate) fn new(shape: impl FnMut(&ForceInfo, f64, &mut Wrench) + Send + 'a) -> Self {
        let inner = Inner {
            shape: Box::new(shape),
            #[cfg(feature = "std")]
            panic: None,
        };
        Self { inner: NonNull::from(Box::leak(Box::new(inner))), owned: PhantomData }
    }

    pub(crate) fn user(&self) -> *mut c_void {
        self.inner.as_ptr().cast()
    }

    /// A panic that was held back in C.
    #[cfg(feature = "std")]
    pub(crate) fn take_panic(&mut self) -> Option<Box<dyn core::any::Any + Send>> {
        // SAFETY: C has returned, so that nobody else has a reference.
        unsafe { self.inner.as_mut() }.panic.take()
    }
}

impl Drop for Shaper<'_> {
    fn drop(&mut self) {
        // SAFETY: it is of a box, and C has forgotten it or is forgotten with it.
        drop(unsafe { Box::from_raw(self.inner.as_ptr()) });
    }
}

/// What C calls. Where panics unwind, they wait until C has returned, and the tool has no force; elsewhere they abort.
pub(crate) unsafe extern "C" fn shape(
    user: *mut c_void,
    told: *const sys::dpt_force_info,
    dt: f64,
    wrench: *mut sys::dpt_wrench,
) {
    let mut info = ForceInfo::empty();
    let mine = core::mem::size_of::<ForceInfo>();
    // SAFETY: C gives the address of Shaper::user, and structs of its own that are there during the call; one of an older
    // library is shorter.
    let (inner, wrench) = unsafe {
        let bytes = ((*told).size as usize).min(mine);
        core::ptr::copy_nonoverlapping(told.cast::<u8>(), info.raw_mut().cast::<u8>(), bytes);
        (&mut *user.cast::<Inner<'_>>(), &mut *wrench.cast::<Wrench>())
    };
    info.size = mine as u32;
    #[cfg(not(feature = "std"))]
    (inner.shape)(&info, dt, wrench);
    #[cfg(feature = "std")]
    {
        let shape = &mut inner.shape;
        let called = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| shape(&info, dt, wrench)));
        if let Err(panic) = called {
            inner.panic = Some(panic);
            *wrench = Wrench::empty();
        }
    }
}
