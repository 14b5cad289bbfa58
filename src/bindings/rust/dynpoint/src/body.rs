// SPDX-License-Identifier: BSD-3-Clause
use crate::block::{first_of, first_of_mut, slice};
use crate::error::{check, count_of, room_of};
use crate::{sys, BodySettings, DeformableDef, Error, Load, Mesh, Pose, Result, Springs, SpringsInfo, World, Wrench};

#[cfg(feature = "alloc")]
use {crate::block::all_of, alloc::vec::Vec};

/// The id of a body in its world. It is a number: one that is gone, or of a tool, gives [`Error::HANDLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Body(pub(crate) u32);

member! {
    Body, BodySettings, "body", named by "hits and contacts", kept: "mesh",
    dpt_body_remove, dpt_body_set_pose, dpt_body_teleport, dpt_body_get_pose,
    dpt_body_set_user, dpt_body_get_user, dpt_body_set_settings, dpt_body_get_settings,
    dpt_body_is_valid, dpt_body_get_wrench
}

impl Body {
    /// The bytes of a deformable body of this mesh, for [`World::add_deformable_in`].
    pub fn deformable_bytes(mesh: &Mesh<'_>, def: &DeformableDef) -> Result<usize> {
        let mut def = *def;
        def.mesh = mesh.as_raw();
        // SAFETY: the mesh is open.
        match unsafe { sys::dpt_deformable_bytes(def.raw()) } {
            0 => Err(Error::ARGUMENT),
            bytes => Ok(bytes),
        }
    }

    /// Move vertices of a deformable body, from vertex `first` on, in the body's frame. `bound` is how far any of them
    /// moves at most; below 0 it is measured.
    pub fn set_vertices(self, world: &mut World<'_>, first: u32, positions: &[[f32; 3]], bound: f64) -> Result<()> {
        // SAFETY: there are as many positions.
        check(unsafe {
            sys::dpt_body_set_vertices(
                world.as_raw(),
                self.0,
                first,
                count_of(positions.len())?,
                first_of(positions).cast(),
                bound,
            )
        })
    }

    /// Move the vertices of a list: a position for each.
    pub fn set_vertex_list(
        self,
        world: &mut World<'_>,
        vertices: &[u32],
        positions: &[[f32; 3]],
        bound: f64,
    ) -> Result<()> {
        if vertices.len() != positions.len() {
            return Err(Error::ARGUMENT);
        }
        // SAFETY: there are as many of both.
        check(unsafe {
            sys::dpt_body_set_vertex_list(
                world.as_raw(),
                self.0,
                first_of(vertices),
                count_of(vertices.len())?,
                first_of(positions).cast(),
                bound,
            )
        })
    }

    /// Move the vertices with the nodes in which they are embedded: all of [`Mesh::node_count`].
    #[cfg(feature = "alloc")]
    pub fn set_nodes(self, world: &mut World<'_>, nodes: &[[f32; 3]]) -> Result<()> {
        let mesh = world.find_kept(self.0).and_then(|kept| kept.mesh.as_ref()).ok_or(Error::HANDLE)?;
        let count = mesh.node_count();
        if count == 0 {
            return Err(Error::UNSUPPORTED);
        }
        if nodes.len() != count {
            return Err(Error::ARGUMENT);
        }
        // SAFETY: there are as many nodes as the body's mesh has.
        check(unsafe { sys::dpt_body_set_nodes(world.as_raw(), self.0, nodes.as_ptr().cast()) })
    }

    /// Where the vertices of a deformable body are, in its frame.
    pub fn vertices<'w>(self, world: &'w World<'_>) -> Result<&'w [[f32; 3]]> {
        let (mut start, mut count) = (core::ptr::null(), 0);
        // SAFETY: the array is the body's, and stays until the world changes, which it cannot while it is borrowed.
        unsafe {
            check(sys::dpt_body_get_vertices(world.as_raw(), self.0, &mut start, &mut count))?;
            Ok(slice(start.cast(), count as usize))
        }
    }

    /// What tools do to a deformable body: forces on vertices. It says how many there are.
    pub fn loads_into(self, world: &World<'_>, loads: &mut [Load]) -> Result<usize> {
        let mut count = 0;
        self.fill_loads(world, loads, &mut count)?;
        Ok(count as usize)
    }

    fn fill_loads(self, world: &World<'_>, loads: &mut [Load], count: &mut u32) -> Result<()> {
        let room = room_of(loads.len());
        // SAFETY: no more is written than there is room for.
        check(unsafe { sys::dpt_body_get_loads(world.as_raw(), self.0, first_of_mut(loads).cast(), room, count) })
    }

    /// All loads on vertices.
    #[cfg(feature = "alloc")]
    pub fn loads(self, world: &World<'_>) -> Result<Vec<Load>> {
        all_of(|loads, count| self.fill_loads(world, loads, count))
    }

    /// All loads on the nodes in which the vertices are embedded.
    #[cfg(feature = "alloc")]
    pub fn node_loads(self, world: &World<'_>) -> Result<Vec<Load>> {
        all_of(|loads: &mut [Load], count| {
            let room = room_of(loads.len());
            // SAFETY: no more is written than there is room for.
            check(unsafe {
                sys::dpt_body_get_node_loads(world.as_raw(), self.0, first_of_mut(loads).cast(), room, count)
            })
        })
    }

    /// The mean of the loads since physics answered last, and how long that is, s.
    #[cfg(feature = "alloc")]
    pub fn mean_loads(self, world: &World<'_>) -> Result<(Vec<Load>, f64)> {
        let seconds = core::cell::Cell::new(0.0);
        let loads = all_of(|loads: &mut [Load], count| {
            let room = room_of(loads.len());
            let raw = first_of_mut(loads).cast();
            // SAFETY: no more is written than there is room for.
            check(unsafe { sys::dpt_body_get_mean_loads(world.as_raw(), self.0, raw, room, count, seconds.as_ptr()) })
        })?;
        Ok((loads, seconds.get()))
    }

    /// An answer of physics: the positions that stand hold what these loads do.
    pub fn set_answered_loads(self, world: &mut World<'_>, loads: &[Load]) -> Result<()> {
        let count = count_of(loads.len())?;
        // SAFETY: there are as many loads.
        check(unsafe { sys::dpt_body_set_answered_loads(world.as_raw(), self.0, first_of(loads).cast(), count) })
    }

    /// After a step of the world: the body's springs go on by `dt`, together with the tools that touch it. `None` is for
    /// a body with a compliance. After an error the body is held where it was.
    pub fn step_springs(
        self,
        world: &mut World<'_>,
        springs: Option<&mut Springs<'_>>,
        dt: f64,
    ) -> Result<SpringsInfo> {
        let mut info = SpringsInfo::empty();
        let springs = springs.map_or(core::ptr::null_mut(), |springs| springs.as_raw());
        // SAFETY: world and springs are there; that they are of one mesh is for C to check.
        check(unsafe { sys::dpt_body_step_springs(world.as_raw(), self.0, springs, dt, info.raw_mut()) })?;
        Ok(info)
    }
}
