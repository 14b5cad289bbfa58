// SPDX-License-Identifier: BSD-3-Clause
use crate::block::{first_of, first_of_mut};
use crate::error::{check, count_of, room_of};
use crate::{
    sys, Body, Channel, Contact, Error, ForceInfo, Hit, Pose, Result, Segment, Sweep, Tip, ToolLoad, ToolSettings,
    World, Wrench,
};

#[cfg(feature = "alloc")]
use {crate::block::all_of, crate::shaper, alloc::vec::Vec};

/// The id of a tool in its world. It is a number: one that is gone, or of a body, gives [`Error::HANDLE`].
///
/// Answers are those of the last step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tool(pub(crate) u32);

/// As many as there is room for; it says how many there are.
macro_rules! list {
    ($(#[$text:meta])* $into:ident, $all:ident, $item:ident, $call:ident) => {
        $(#[$text])*
        ///
        /// At most as many as there is room for are written; it says how many there are.
        pub fn $into(self, world: &World<'_>, items: &mut [$item]) -> Result<usize> {
            let mut count = 0;
            self.$call(world, items, &mut count)?;
            Ok(count as usize)
        }

        $(#[$text])*
        #[cfg(feature = "alloc")]
        pub fn $all(self, world: &World<'_>) -> Result<Vec<$item>> {
            all_of(|items, count| self.$call(world, items, count))
        }

        fn $call(self, world: &World<'_>, items: &mut [$item], count: &mut u32) -> Result<()> {
            if let Some(item) = items.first_mut() {
                *item = $item::empty();
            }
            let room = room_of(items.len());
            // SAFETY: no more is written than there is room for; the first item has its size.
            check(unsafe { sys::$call(world.as_raw(), self.0, first_of_mut(items).cast(), room, count) })
        }
    };
}

member! {
    Tool, ToolSettings, "tool", named by "snapshots and recordings", kept: "hulls and its function",
    dpt_tool_remove, dpt_tool_set_pose, dpt_tool_teleport, dpt_tool_get_pose,
    dpt_tool_set_user, dpt_tool_get_user, dpt_tool_set_settings, dpt_tool_get_settings,
    dpt_tool_is_valid, dpt_tool_get_wrench
}

impl Tool {
    /// Move a free tool: as many segments as it has, in the world.
    pub fn set_segments(self, world: &mut World<'_>, segments: &[Segment]) -> Result<()> {
        let count = count_of(segments.len())?;
        // SAFETY: there are as many segments.
        check(unsafe { sys::dpt_tool_set_segments(world.as_raw(), self.0, first_of(segments).cast(), count) })
    }

    /// Test a motion to `pose` without moving the tool: the first touch, and where the tool is then.
    pub fn try_pose(self, world: &World<'_>, pose: &Pose, clearance: f64) -> Result<(Sweep, Pose)> {
        let (mut first, mut reached) = (Sweep::empty(), Pose::IDENTITY);
        // SAFETY: all of it is there, and the sweep has its size.
        check(unsafe {
            sys::dpt_tool_try_pose(world.as_raw(), self.0, pose.raw(), clearance, first.raw_mut(), reached.raw_mut())
        })?;
        Ok((first, reached))
    }

    /// Test a motion of a free tool to `segments`, in the world, and have them where it touches first.
    pub fn try_segments(self, world: &World<'_>, segments: &mut [Segment], clearance: f64) -> Result<Sweep> {
        let (mut first, count) = (Sweep::empty(), count_of(segments.len())?);
        let both = first_of_mut(segments).cast::<sys::dpt_segment>();
        // SAFETY: there are as many segments; the result may be written over them.
        check(unsafe {
            sys::dpt_tool_try_segments(world.as_raw(), self.0, both, count, clearance, first.raw_mut(), both)
        })?;
        Ok(first)
    }

    /// The pose of the tool's proxy.
    pub fn proxy(self, world: &World<'_>) -> Result<Pose> {
        let mut pose = Pose::IDENTITY;
        // SAFETY: world and pose are there.
        check(unsafe { sys::dpt_tool_get_proxy(world.as_raw(), self.0, pose.raw_mut()) })?;
        Ok(pose)
    }

    /// The pose in which the last step of springs left the tool.
    pub fn end(self, world: &World<'_>) -> Result<Pose> {
        let mut pose = Pose::IDENTITY;
        // SAFETY: as above.
        check(unsafe { sys::dpt_tool_get_end(world.as_raw(), self.0, pose.raw_mut()) })?;
        Ok(pose)
    }

    /// The nearest pair of the tool and all bodies.
    pub fn hit(self, world: &World<'_>) -> Result<Hit> {
        let mut hit = Hit::empty();
        // SAFETY: the hit has its size. That it may be searched for now is why a world is not shared by threads.
        check(unsafe { sys::dpt_tool_get_hit(world.as_raw(), self.0, hit.raw_mut()) })?;
        Ok(hit)
    }

    /// The nearest pair of one segment of the tool, from 0; tips follow the segments.
    pub fn segment_hit(self, world: &World<'_>, segment: u32) -> Result<Hit> {
        let mut hit = Hit::empty();
        // SAFETY: as above.
        check(unsafe { sys::dpt_tool_get_segment_hit(world.as_raw(), self.0, segment, hit.raw_mut()) })?;
        Ok(hit)
    }

    /// The first touch of a segment of the tool between the last two steps.
    pub fn sweep(self, world: &World<'_>, segment: u32) -> Result<Sweep> {
        let mut sweep = Sweep::empty();
        // SAFETY: the sweep has its size.
        check(unsafe { sys::dpt_tool_get_sweep(world.as_raw(), self.0, segment, sweep.raw_mut()) })?;
        Ok(sweep)
    }

    list! {
        /// The tool's contacts; [`Error::FULL`] where the def's `max_contacts` is 0.
        contacts_into, contacts, Contact, dpt_tool_get_contacts
    }

    list! {
        /// Where bodies push the tool.
        loads_into, loads, ToolLoad, dpt_tool_get_loads
    }

    list! {
        /// The channels that a needle has made; [`Error::UNSUPPORTED`] where the def's `max_channels` is 0.
        channels_into, channels, Channel, dpt_tool_get_channels
    }

    /// What the tool feels, and why.
    pub fn force_info(self, world: &World<'_>) -> Result<ForceInfo> {
        let mut info = ForceInfo::empty();
        // SAFETY: the info has its size.
        check(unsafe { sys::dpt_tool_get_force_info(world.as_raw(), self.0, info.raw_mut()) })?;
        Ok(info)
    }

    /// What the tool does to one body.
    pub fn body_wrench(self, world: &World<'_>, body: Body) -> Result<Wrench> {
        let mut wrench = Wrench::empty();
        // SAFETY: as above.
        check(unsafe { sys::dpt_tool_get_body_wrench(world.as_raw(), self.0, body.0, wrench.raw_mut()) })?;
        Ok(wrench)
    }

    /// Give the tool its tips, at most 64, in place of those that it has. The world keeps their hulls.
    pub fn set_tips<'a>(self, world: &mut World<'a>, tips: &[Tip<'_, 'a>]) -> Result<()> {
        let size = core::mem::size_of::<sys::dpt_tip>() as u32;
        let none = sys::dpt_tip { size, reserved: 0, hull: core::ptr::null(), pose: core::ptr::null() };
        let mut raw = [none; 64];
        if tips.len() > raw.len() {
            return Err(Error::LIMIT);
        }
        for (raw, tip) in raw.iter_mut().zip(tips) {
            raw.hull = tip.hull.as_raw();
            raw.pose = tip.pose.raw();
        }
        // SAFETY: there are as many tips; their hulls stay for 'a, or as long as what is kept.
        check(unsafe { sys::dpt_tool_set_tips(world.as_raw(), self.0, raw.as_ptr(), tips.len() as u32) })?;
        #[cfg(feature = "alloc")]
        {
            world.kept(self.0).hulls = tips.iter().map(|tip| tip.hull.clone()).collect();
        }
        Ok(())
    }

    /// Say where a tip, from 0, is to be in its tool's frame.
    pub fn set_tip_pose(self, world: &mut World<'_>, tip: u32, pose: &Pose) -> Result<()> {
        // SAFETY: world and pose are there.
        check(unsafe { sys::dpt_tool_set_tip_pose(world.as_raw(), self.0, tip, pose.raw()) })
    }

    /// Where a tip stood in its tool's frame at the end of the last step.
    pub fn tip_pose(self, world: &World<'_>, tip: u32) -> Result<Pose> {
        let mut pose = Pose::IDENTITY;
        // SAFETY: as above.
        check(unsafe { sys::dpt_tool_get_tip_pose(world.as_raw(), self.0, tip, pose.raw_mut()) })?;
        Ok(pose)
    }

    /// Put a piercing tool in, where its device is.
    pub fn insert(self, world: &mut World<'_>) -> Result<()> {
        // SAFETY: the world is there.
        check(unsafe { sys::dpt_tool_insert(world.as_raw(), self.0) })
    }

    /// Have a function of yours shape the wrench in each step: a guide, a vibration. It gets what the law gives, and dt.
    /// Where it panics there is no force, and the panic comes out of the step.
    #[cfg(feature = "alloc")]
    pub fn set_shaper<'a>(
        self,
        world: &mut World<'a>,
        shape: impl FnMut(&ForceInfo, f64, &mut Wrench) + Send + 'a,
    ) -> Result<()> {
        let new = shaper::Shaper::new(shape);
        // SAFETY: the function is kept until another takes its place, or the tool goes.
        check(unsafe { sys::dpt_tool_set_shaper(world.as_raw(), self.0, Some(shaper::shape), new.user()) })?;
        world.kept(self.0).shaper = Some(new);
        Ok(())
    }

    /// The wrench is that of the law again.
    #[cfg(feature = "alloc")]
    pub fn remove_shaper(self, world: &mut World<'_>) -> Result<()> {
        // SAFETY: no function is allowed.
        check(unsafe { sys::dpt_tool_set_shaper(world.as_raw(), self.0, None, core::ptr::null_mut()) })?;
        world.kept(self.0).shaper = None;
        Ok(())
    }
}
