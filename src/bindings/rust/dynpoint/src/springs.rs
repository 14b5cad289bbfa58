// SPDX-License-Identifier: BSD-3-Clause
use crate::block::{first_of, Block};
use crate::error::{check, count_of};
use crate::{sys, Error, Load, Mesh, Result, SpringsDef, SpringsInfo};
use core::{mem::MaybeUninit, ptr::NonNull};

/// Masses and springs of a mesh that was compiled with them, stepped over time.
pub struct Springs<'a> {
    raw: NonNull<sys::dpt_springs>,
    mesh: Mesh<'a>,
    _block: Block<'a>,
}

// SAFETY: springs belong to one thread at a time, whichever that is (springs.h).
unsafe impl Send for Springs<'_> {}

impl<'a> Springs<'a> {
    /// The bytes that springs of this mesh need: [`Error::ARGUMENT`] for a def that is not valid, or a mesh without.
    pub fn bytes(mesh: &Mesh<'a>, def: &SpringsDef) -> Result<usize> {
        let mut def = *def;
        def.mesh = mesh.as_raw();
        // SAFETY: the mesh is open.
        match unsafe { sys::dpt_springs_bytes(def.raw()) } {
            0 => Err(Error::ARGUMENT),
            bytes => Ok(bytes),
        }
    }

    /// Make springs at rest, in memory of their own.
    #[cfg(feature = "alloc")]
    pub fn new(mesh: &Mesh<'a>, def: &SpringsDef) -> Result<Self> {
        Self::create(Block::new(Self::bytes(mesh, def)?)?, mesh, def)
    }

    /// Make springs in a block of yours, of [`Springs::bytes`] or more.
    pub fn new_in(block: &'a mut [MaybeUninit<u64>], mesh: &Mesh<'a>, def: &SpringsDef) -> Result<Self> {
        Self::create(Block::lent(block), mesh, def)
    }

    fn create(block: Block<'a>, mesh: &Mesh<'a>, def: &SpringsDef) -> Result<Self> {
        let mut def = *def;
        def.mesh = mesh.as_raw();
        let mut springs = core::ptr::null_mut();
        // SAFETY: the block is theirs from now on, and the mesh is kept.
        check(unsafe { sys::dpt_springs_create(block.start(), block.bytes(), def.raw(), &mut springs) })?;
        Ok(Self { raw: NonNull::new(springs).ok_or(Error::ARGUMENT)?, mesh: mesh.clone(), _block: block })
    }

    /// The springs, for calls of [`crate::sys`].
    pub fn as_raw(&self) -> *mut sys::dpt_springs {
        self.raw.as_ptr()
    }

    /// The mesh that they were made of.
    pub fn mesh(&self) -> &Mesh<'a> {
        &self.mesh
    }

    /// How many nodes there are.
    pub fn count(&self) -> usize {
        // SAFETY: the springs are there.
        unsafe { sys::dpt_springs_get_count(self.as_raw()) as usize }
    }

    /// The longest substep that is stable, s.
    pub fn stable_step(&self) -> f64 {
        // SAFETY: as above.
        unsafe { sys::dpt_springs_get_stable_step(self.as_raw()) }
    }

    /// Go on by `dt` under loads on nodes. After an error nothing has moved.
    pub fn step(&mut self, dt: f64, loads: &[Load]) -> Result<SpringsInfo> {
        let mut info = SpringsInfo::empty();
        let count = count_of(loads.len())?;
        // SAFETY: there are as many loads.
        check(unsafe { sys::dpt_springs_step(self.as_raw(), dt, first_of(loads).cast(), count, info.raw_mut()) })?;
        Ok(info)
    }

    /// Where the nodes are and how fast: [`Springs::count`] of each; `speeds` may be empty.
    pub fn nodes_into(&self, positions: &mut [[f32; 3]], speeds: &mut [[f32; 3]]) -> Result<()> {
        if !speeds.is_empty() && speeds.len() != positions.len() {
            return Err(Error::ARGUMENT);
        }
        let (count, speeds) = (count_of(positions.len())?, crate::block::first_of_mut(speeds));
        // SAFETY: both have room for as many, and C refuses another count.
        check(unsafe { sys::dpt_springs_get_nodes(self.as_raw(), count, positions.as_mut_ptr().cast(), speeds.cast()) })
    }

    /// Put nodes, from `first` on, somewhere else; without speeds they rest.
    pub fn set_nodes(&mut self, first: u32, positions: &[[f32; 3]], speeds: &[[f32; 3]]) -> Result<()> {
        if !speeds.is_empty() && speeds.len() != positions.len() {
            return Err(Error::ARGUMENT);
        }
        let count = count_of(positions.len())?;
        // SAFETY: there are as many of both.
        check(unsafe {
            sys::dpt_springs_set_nodes(self.as_raw(), first, count, first_of(positions).cast(), first_of(speeds).cast())
        })
    }

    /// J: what the springs hold, and what moves.
    pub fn energy(&self) -> Result<(f64, f64)> {
        let (mut elastic, mut kinetic) = (0.0, 0.0);
        // SAFETY: the springs are there.
        check(unsafe { sys::dpt_springs_get_energy(self.as_raw(), &mut elastic, &mut kinetic) })?;
        Ok((elastic, kinetic))
    }

    /// How far a newton on a vertex moves it in a step of `dt`, m/N: one number for each vertex of the mesh.
    pub fn compliances_into(&self, dt: f64, compliances: &mut [f32]) -> Result<()> {
        let count = count_of(compliances.len())?;
        // SAFETY: there is room for as many, and C refuses another count.
        check(unsafe { sys::dpt_springs_get_compliances(self.as_raw(), dt, count, compliances.as_mut_ptr()) })
    }
}

impl core::fmt::Debug for Springs<'_> {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "Springs of {} nodes", self.count())
    }
}
