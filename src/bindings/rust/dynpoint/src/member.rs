// SPDX-License-Identifier: BSD-3-Clause
//! What bodies and tools of a world have in common.

macro_rules! member {
    (
        $member:ident, $settings:ident, $what:literal, named by $named:literal, kept: $kept:literal,
        $remove:ident, $set_pose:ident, $teleport:ident, $get_pose:ident, $set_user:ident, $get_user:ident,
        $set_settings:ident, $get_settings:ident, $is_valid:ident, $get_wrench:ident
    ) => {
        impl $member {
            #[doc = concat!("The number, as ", $named, " name it.")]
            pub const fn id(self) -> u32 {
                self.0
            }

            #[doc = concat!("The ", $what, " of a number.")]
            pub const fn from_id(id: u32) -> Self {
                Self(id)
            }

            #[doc = concat!("Remove the ", $what, "; the world no longer keeps its ", $kept, ".")]
            pub fn remove(self, world: &mut World<'_>) -> Result<()> {
                // SAFETY: the world is there.
                check(unsafe { sys::$remove(world.as_raw(), self.0) })?;
                world.let_go(self.0);
                Ok(())
            }

            #[doc = concat!("Move the ", $what, "; the motion is swept.")]
            pub fn set_pose(self, world: &mut World<'_>, pose: &Pose) -> Result<()> {
                // SAFETY: world and pose are there.
                check(unsafe { sys::$set_pose(world.as_raw(), self.0, pose.raw()) })
            }

            #[doc = concat!("Put the ", $what, " somewhere else without a motion.")]
            pub fn teleport(self, world: &mut World<'_>, pose: &Pose) -> Result<()> {
                // SAFETY: as above.
                check(unsafe { sys::$teleport(world.as_raw(), self.0, pose.raw()) })
            }

            /// The last valid pose.
            pub fn pose(self, world: &World<'_>) -> Result<Pose> {
                let mut pose = Pose::IDENTITY;
                // SAFETY: as above.
                check(unsafe { sys::$get_pose(world.as_raw(), self.0, pose.raw_mut()) })?;
                Ok(pose)
            }

            /// A value of your own.
            pub fn set_user(self, world: &mut World<'_>, user: u64) -> Result<()> {
                // SAFETY: the world is there.
                check(unsafe { sys::$set_user(world.as_raw(), self.0, user) })
            }

            /// The value of your own, 0 at first.
            pub fn user(self, world: &World<'_>) -> Result<u64> {
                let mut user = 0;
                // SAFETY: as above.
                check(unsafe { sys::$get_user(world.as_raw(), self.0, &mut user) })?;
                Ok(user)
            }

            #[doc = concat!("Change settings; begin with those of [`", stringify!($member), "::settings`].")]
            pub fn set_settings(self, world: &mut World<'_>, settings: &$settings) -> Result<()> {
                // SAFETY: the settings have their size.
                check(unsafe { sys::$set_settings(world.as_raw(), self.0, settings.raw()) })
            }

            #[doc = concat!("The settings of the ", $what, ".")]
            pub fn settings(self, world: &World<'_>) -> Result<$settings> {
                let mut settings = $settings::empty();
                // SAFETY: as above.
                check(unsafe { sys::$get_settings(world.as_raw(), self.0, settings.raw_mut()) })?;
                Ok(settings)
            }

            #[doc = concat!("Whether the world has this ", $what, ".")]
            pub fn is_valid(self, world: &World<'_>) -> bool {
                // SAFETY: the world is there.
                unsafe { sys::$is_valid(world.as_raw(), self.0) != 0 }
            }

            /// What was felt in the last step: by the tool, or by the body of all tools.
            pub fn wrench(self, world: &World<'_>) -> Result<Wrench> {
                let mut wrench = Wrench::empty();
                // SAFETY: world and wrench are there.
                check(unsafe { sys::$get_wrench(world.as_raw(), self.0, wrench.raw_mut()) })?;
                Ok(wrench)
            }
        }
    };
}
