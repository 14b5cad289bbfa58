// SPDX-License-Identifier: BSD-3-Clause
use crate::block::{first_of, Block};
use crate::error::{check, count_of};
use crate::{sys, Body, DeformableDef, Error, Mesh, Pose, Result, Segment, Step, Tool, WorldDef, WorldInfo};
use core::{marker::PhantomData, mem::MaybeUninit, ptr::NonNull};

#[cfg(feature = "alloc")]
use {crate::hulls::Hull, crate::shaper::Shaper, crate::Springs, crate::SpringsInfo, alloc::vec::Vec};

/// What a body or a tool needs for as long as it is in its world.
#[cfg(feature = "alloc")]
pub(crate) struct Kept<'a> {
    pub(crate) id: u32,
    pub(crate) mesh: Option<Mesh<'a>>,
    pub(crate) _blocks: [Option<Block<'a>>; 2],
    pub(crate) hulls: Vec<Hull<'a>>,
    pub(crate) shaper: Option<Shaper<'a>>,
}

/// A world: bodies, tools, and the step that lets one feel the other.
///
/// It belongs to one thread at a time, and may move between threads. Dropping it frees what it kept.
pub struct World<'a> {
    raw: NonNull<sys::dpt_world>,
    #[cfg(feature = "alloc")]
    kept: Vec<Kept<'a>>,
    _block: Block<'a>,
    lent: PhantomData<Mesh<'a>>,
}

// SAFETY: a world belongs to one thread at a time, whichever that is (world.h); what it keeps may be sent.
unsafe impl Send for World<'_> {}

impl<'a> World<'a> {
    /// The bytes that a world of this def needs: [`Error::ARGUMENT`] for one that is not valid.
    pub fn bytes(def: &WorldDef) -> Result<usize> {
        // SAFETY: the def has its size, and its pointers are null.
        match unsafe { sys::dpt_world_bytes(def.raw()) } {
            0 => Err(Error::ARGUMENT),
            bytes => Ok(bytes),
        }
    }

    /// Make a world in memory of its own.
    #[cfg(feature = "alloc")]
    pub fn new(def: &WorldDef) -> Result<Self> {
        Self::create(Block::new(Self::bytes(def)?)?, def)
    }

    /// Make a world in a block of yours, of [`World::bytes`] or more.
    pub fn new_in(block: &'a mut [MaybeUninit<u64>], def: &WorldDef) -> Result<Self> {
        Self::create(Block::lent(block), def)
    }

    fn create(block: Block<'a>, def: &WorldDef) -> Result<Self> {
        let mut world = core::ptr::null_mut();
        // SAFETY: the block is the world's from now on, and stays where it is.
        check(unsafe { sys::dpt_world_create(block.start(), block.bytes(), def.raw(), &mut world) })?;
        Ok(Self {
            raw: NonNull::new(world).ok_or(Error::ARGUMENT)?,
            #[cfg(feature = "alloc")]
            kept: Vec::new(),
            _block: block,
            lent: PhantomData,
        })
    }

    /// The world, for calls of [`crate::sys`]. What the world keeps must not be removed by them.
    pub fn as_raw(&self) -> *mut sys::dpt_world {
        self.raw.as_ptr()
    }

    /// Forget all earlier steps.
    pub fn reset(&mut self) -> Result<()> {
        // SAFETY: the world is there.
        check(unsafe { sys::dpt_world_reset(self.as_raw()) })
    }

    /// The most that the world has used, and its kernel.
    pub fn info(&self) -> Result<WorldInfo> {
        let mut info = WorldInfo::empty();
        // SAFETY: the info has its size.
        check(unsafe { sys::dpt_world_get_info(self.as_raw(), info.raw_mut()) })?;
        Ok(info)
    }

    /// One tick of `dt` seconds.
    pub fn step(&mut self, dt: f64) -> Result<()> {
        // SAFETY: the world is there, with all that it points to.
        let result = unsafe { sys::dpt_world_step(self.as_raw(), dt, core::ptr::null_mut()) };
        self.pass_panics_on();
        check(result)
    }

    /// One tick that also finds the pairs of tools that a proxy holds back, and tells of all tools together.
    pub fn step_told(&mut self, dt: f64) -> Result<Step> {
        let mut step = Step::empty();
        // SAFETY: as above; the step has its size.
        let result = unsafe { sys::dpt_world_step(self.as_raw(), dt, step.raw_mut()) };
        self.pass_panics_on();
        check(result)?;
        Ok(step)
    }

    /// Add a rigid body. The world keeps the mesh until the body is removed.
    pub fn add_body(&mut self, mesh: &Mesh<'a>, pose: &Pose) -> Result<Body> {
        let mut body = 0;
        // SAFETY: the mesh stays as long as 'a, or as what is kept.
        check(unsafe { sys::dpt_body_add(self.as_raw(), mesh.as_raw(), pose.raw(), &mut body) })?;
        #[cfg(feature = "alloc")]
        self.keep(body, Some(mesh.clone()), [None, None]);
        Ok(Body(body))
    }

    /// Add a deformable body, in memory of its own. `compliances` are those of each vertex where the def has a
    /// compliance; empty: it is the def's.
    #[cfg(feature = "alloc")]
    pub fn add_deformable(
        &mut self,
        mesh: &Mesh<'a>,
        pose: &Pose,
        def: &DeformableDef,
        compliances: &[f32],
    ) -> Result<Body> {
        let own = if compliances.is_empty() { None } else { Some(Block::copy_of(compliances)?) };
        let start = own.as_ref().map_or(core::ptr::null(), |block| block.start::<f32>().cast_const());
        let block = Block::new(Body::deformable_bytes(mesh, def)?)?;
        // SAFETY: the block and the compliances are kept as long as the body.
        let body = unsafe { self.add_deformable_in_block(&block, mesh, pose, def, start, compliances.len()) }?;
        self.keep(body.0, Some(mesh.clone()), [Some(block), own]);
        Ok(body)
    }

    /// Add a deformable body in a block of yours, of [`Body::deformable_bytes`] or more.
    pub fn add_deformable_in(
        &mut self,
        block: &'a mut [MaybeUninit<u64>],
        mesh: &Mesh<'a>,
        pose: &Pose,
        def: &DeformableDef,
        compliances: &'a [f32],
    ) -> Result<Body> {
        let block = Block::lent(block);
        // SAFETY: the block and the compliances are lent as long as the world is.
        let body =
            unsafe { self.add_deformable_in_block(&block, mesh, pose, def, first_of(compliances), compliances.len()) }?;
        #[cfg(feature = "alloc")]
        self.keep(body.0, Some(mesh.clone()), [Some(block), None]);
        Ok(body)
    }

    /// # Safety
    /// The block and the compliances stay as long as the body.
    unsafe fn add_deformable_in_block(
        &mut self,
        block: &Block<'a>,
        mesh: &Mesh<'a>,
        pose: &Pose,
        def: &DeformableDef,
        compliances: *const f32,
        count: usize,
    ) -> Result<Body> {
        if !compliances.is_null() && count != mesh.vertices().len() {
            return Err(Error::ARGUMENT);
        }
        let mut def = *def;
        def.mesh = mesh.as_raw();
        def.pose = pose.raw();
        def.compliances = compliances;
        let mut body = 0;
        // SAFETY: as above, and the mesh stays as that of a rigid body.
        check(unsafe {
            sys::dpt_body_add_deformable(self.as_raw(), block.start(), block.bytes(), def.raw(), &mut body)
        })?;
        Ok(Body(body))
    }

    /// Add a tool of segments in its own frame.
    pub fn add_tool(&mut self, segments: &[Segment]) -> Result<Tool> {
        let mut tool = 0;
        // SAFETY: there are as many segments.
        check(unsafe {
            sys::dpt_tool_add(self.as_raw(), first_of(segments).cast(), count_of(segments.len())?, &mut tool)
        })?;
        Ok(Tool(tool))
    }

    /// Springs of several bodies go on by `dt`, solved together with the tools that touch them: as
    /// [`Body::step_springs`], which is for one. What is told of each body has its own result.
    #[cfg(feature = "alloc")]
    pub fn step_springs(
        &mut self,
        bodies: &mut [(Body, Option<&mut Springs<'_>>)],
        dt: f64,
    ) -> (Result<()>, Vec<SpringsInfo>) {
        let ids: Vec<u32> = bodies.iter().map(|(body, _)| body.0).collect();
        let springs: Vec<_> = bodies
            .iter_mut()
            .map(|(_, springs)| springs.as_mut().map_or(core::ptr::null_mut(), |one| one.as_raw()))
            .collect();
        let mut infos = alloc::vec![SpringsInfo::empty(); bodies.len()];
        // SAFETY: all arrays have as many items, and the springs are borrowed until the call returns.
        let result = count_of(bodies.len()).and_then(|count| {
            check(unsafe {
                sys::dpt_bodies_step_springs(
                    self.as_raw(),
                    ids.as_ptr(),
                    springs.as_ptr(),
                    count,
                    dt,
                    crate::block::first_of_mut(&mut infos).cast(),
                )
            })
        });
        (result, infos)
    }

    #[cfg(feature = "alloc")]
    fn keep(&mut self, id: u32, mesh: Option<Mesh<'a>>, blocks: [Option<Block<'a>>; 2]) {
        self.kept.push(Kept { id, mesh, _blocks: blocks, hulls: Vec::new(), shaper: None });
    }

    /// What a tool or a body has kept; for a new one there is nothing yet.
    #[cfg(feature = "alloc")]
    pub(crate) fn kept(&mut self, id: u32) -> &mut Kept<'a> {
        let at = self.kept.iter().position(|one| one.id == id);
        let at = at.unwrap_or_else(|| {
            self.keep(id, None, [None, None]);
            self.kept.len() - 1
        });
        &mut self.kept[at]
    }

    #[cfg(feature = "alloc")]
    pub(crate) fn find_kept(&self, id: u32) -> Option<&Kept<'a>> {
        self.kept.iter().find(|one| one.id == id)
    }

    /// After C has forgotten it.
    pub(crate) fn let_go(&mut self, _id: u32) {
        #[cfg(feature = "alloc")]
        self.kept.retain(|one| one.id != _id);
    }

    /// Go on with a panic in a function that shapes a force, once C has returned: the first, where there are several.
    fn pass_panics_on(&mut self) {
        #[cfg(feature = "std")]
        {
            let shapers = self.kept.iter_mut().filter_map(|one| one.shaper.as_mut());
            let panics: Vec<_> = shapers.filter_map(Shaper::take_panic).collect();
            if let Some(first) = panics.into_iter().next() {
                std::panic::resume_unwind(first);
            }
        }
    }
}

impl core::fmt::Debug for World<'_> {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "World at {:?}", self.raw)
    }
}
