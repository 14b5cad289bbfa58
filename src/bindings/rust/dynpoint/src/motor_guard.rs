// SPDX-License-Identifier: BSD-3-Clause
use crate::error::check;
use crate::{sys, GuardDef, GuardInfo, Result, Wrench};
use core::{cell::Cell, marker::PhantomData};

/// It stands between a host and a device's motors: what leaves it is finite, within limits, and ends when the host falls
/// silent.
#[derive(Clone)]
pub struct Guard(sys::dpt_guard, PhantomData<Cell<()>>); // to one thread at a time (guard.h)

impl Guard {
    /// A guard that is off, with all counts 0.
    pub fn new(def: &GuardDef) -> Result<Self> {
        let size = core::mem::size_of::<sys::dpt_guard>() as u32;
        let mut guard = sys::dpt_guard { size, reserved: 0, opaque: [0; 63] };
        // SAFETY: the guard has its size.
        check(unsafe { sys::dpt_guard_init(&mut guard, def.raw()) })?;
        Ok(Self(guard, PhantomData))
    }

    /// The wrench to send now, on every tick; `None` on one without a command. `is_ready` is false where the device or
    /// its pose cannot be trusted.
    pub fn step(&mut self, now_ns: u64, command: Option<&Wrench>, is_ready: bool) -> Wrench {
        let mut out = Wrench::empty();
        let command = command.map_or(core::ptr::null(), Wrench::raw);
        // SAFETY: all of it is there, and the command may be null.
        unsafe { sys::dpt_guard_step(&mut self.0, now_ns, command, is_ready.into(), out.raw_mut()) };
        out
    }

    /// What it has done so far.
    pub fn info(&self) -> Result<GuardInfo> {
        let mut info = GuardInfo::empty();
        // SAFETY: the info has its size.
        check(unsafe { sys::dpt_guard_get_info(&self.0, info.raw_mut()) })?;
        Ok(info)
    }
}

impl core::fmt::Debug for Guard {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "Guard: {:?}", self.info())
    }
}
