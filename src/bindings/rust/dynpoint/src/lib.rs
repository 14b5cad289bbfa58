// SPDX-License-Identifier: BSD-3-Clause
//! Let a line-shaped tool feel triangle meshes in a haptic loop: exact nearest pairs, contacts and forces, and no
//! motion that goes through a surface.
//!
//! ```
//! use dynpoint::{Compiler, Mesh, Pose, Segment, World, WorldDef};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let mesh: Mesh = Compiler::new().unit(0.1).arrays(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let mut world = World::new(&WorldDef::default())?;
//! let body = world.add_body(&mesh, &Pose::IDENTITY)?;
//! let settings = body.settings(&world)?.static_friction(0.3);
//! body.set_settings(&mut world, &settings)?;
//! let tool = world.add_tool(&[Segment { a: [0.0; 3], b: [0.0, 0.0, 0.1], radius: 0.002 }])?;
//! for tick in 0..150 {
//!     tool.set_pose(&mut world, &Pose::at([0.02, 0.02, 0.1 - 0.0005 * f64::from(tick)]))?;
//!     world.step(0.001)?;
//! }
//! println!("{} m, {:?}", tool.hit(&world)?.distance, tool.wrench(&world)?); // m; N and Nm
//! assert!(tool.wrench(&world)?.force[2] > 1.0);
//! # Ok(())
//! # }
//! ```
//!
//! # Rules
//!
//! A method does what the C function of that name does, and structs have the fields of the C headers; their comments are
//! the manual. Units are SI. `size`, what is reserved and pointers are the crate's own affair.
//!
//! **Life.** A [`Mesh`] that owns its bytes is counted: it is cheap to clone, and a world keeps what it feels. So a mesh
//! outlives its world, and both fit into one struct, which a lifetime would forbid. A mesh of borrowed bytes, as in
//! flash, has their lifetime; a world that outlives them does not compile:
//!
//! ```compile_fail,E0505
//! # use dynpoint::{Mesh, Pose, World, WorldDef};
//! # fn feel(bytes: Vec<u8>) -> Result<(), dynpoint::Error> {
//! let mut world = World::new(&WorldDef::default())?;
//! world.add_body(&Mesh::borrow(&bytes)?, &Pose::IDENTITY)?;
//! drop(bytes);
//! world.step(0.001)
//! # }
//! ```
//!
//! **Threads.** Meshes and hulls are `Send` and `Sync`. Worlds, springs, guards and hosts are `Send` alone: getters of a
//! world may search, so that even they belong to one thread at a time. That does not compile either:
//!
//! ```compile_fail,E0277
//! # use dynpoint::{Tool, World};
//! # fn feel(world: World, tool: Tool) {
//! std::thread::scope(|scope| {
//!     scope.spawn(|| tool.hit(&world));
//!     scope.spawn(|| tool.hit(&world));
//! });
//! # }
//! ```
//!
//! **Errors.** What the library refuses is an [`Error`] with its text. Wrong numbers, as NaN, and ids that are gone are
//! errors, never a panic. A panic in a function of yours that the library calls comes out of the call that led there.
//!
//! **Without `std`** the crate allocates nothing: [`World::new_in`] takes a block of yours. With `alloc` alone it has
//! blocks and lists of its own.
#![cfg_attr(not(feature = "std"), no_std)]
#![warn(missing_docs)]

#[cfg(all(feature = "alloc", not(feature = "std")))]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std as alloc;

#[macro_use]
mod member;
#[macro_use]
mod mirror;

mod block;
mod body;
#[cfg(feature = "compile")]
mod compiler;
mod error;
#[cfg(feature = "host")]
mod host;
mod hulls;
mod mesh;
mod motor_guard;
mod plain;
#[cfg(feature = "alloc")]
mod shaper;
mod springs;
mod text;
mod tool;
mod world;

pub use body::Body;
#[cfg(feature = "compile")]
pub use compiler::{CompileError, Compiler, Note};
pub use error::{version, Error, Result};
#[cfg(feature = "host")]
pub use host::{Felt, Host, HostError, HostOptions, HostStopper};
pub use hulls::{Hull, Tip};
pub use mesh::Mesh;
pub use motor_guard::Guard;
pub use plain::*;
pub use springs::Springs;
pub use tool::Tool;
pub use world::World;

/// The declarations, for what the safe layer does not have.
pub use dynpoint_sys as sys;

/// Its example is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
