// SPDX-License-Identifier: BSD-3-Clause
//! The core without std and alloc, as firmware links it: run.sh looks what it wants of others.
#![no_std]

use core::mem::MaybeUninit;
use dynpoint::{Guard, GuardDef, Mesh, Pose, Result, Segment, World, WorldDef, Wrench};

#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

fn press(bytes: &[u8], block: &mut [MaybeUninit<u64>], ticks: u64) -> Result<Wrench> {
    let mesh = Mesh::borrow(bytes)?;
    let mut world = World::new_in(block, &WorldDef::default())?;
    world.add_body(&mesh, &Pose::IDENTITY)?;
    let tool = world.add_tool(&[Segment { a: [0.0; 3], b: [0.0, 0.0, 0.05], radius: 0.002 }])?;
    let mut guard = Guard::new(&GuardDef::default())?;
    for tick in 0..ticks {
        tool.set_pose(&mut world, &Pose::at([0.0, 0.0, 0.1 - 0.0001 * tick as f64]))?;
        world.step(0.001)?;
        guard.step(1_000_000 * tick, Some(&tool.wrench(&world)?), true);
    }
    tool.wrench(&world)
}

/// # Safety
/// `bytes` are `size`, and `block` has room for `words` of 8 bytes.
#[no_mangle]
pub unsafe extern "C" fn press_from_c(
    bytes: *const u8,
    size: usize,
    block: *mut MaybeUninit<u64>,
    words: usize,
    ticks: u64,
) -> f64 {
    // SAFETY: as above.
    let (bytes, block) =
        unsafe { (core::slice::from_raw_parts(bytes, size), core::slice::from_raw_parts_mut(block, words)) };
    press(bytes, block, ticks).map_or(-1.0, |wrench| wrench.force[2])
}
