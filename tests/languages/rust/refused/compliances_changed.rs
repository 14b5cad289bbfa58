// E0506: numbers that a body reads in each tick change beside it.
use dynpoint::{DeformableDef, Mesh, Pose, World};
use std::mem::MaybeUninit;

fn feel<'a>(world: &mut World<'a>, mesh: &Mesh<'a>, block: &'a mut [MaybeUninit<u64>], own: &'a mut [f32; 8]) {
    world.add_deformable_in(block, mesh, &Pose::IDENTITY, &DeformableDef::default(), &*own).unwrap();
    own[0] = 1.0;
}

fn main() {
    let _ = feel;
}
