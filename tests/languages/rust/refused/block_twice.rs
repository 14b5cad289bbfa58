// E0499: two worlds in one block.
use dynpoint::{World, WorldDef};
use std::mem::MaybeUninit;

fn main() {
    let mut block = [MaybeUninit::uninit(); 4096];
    let mut one = World::new_in(&mut block, &WorldDef::default()).unwrap();
    let _other = World::new_in(&mut block, &WorldDef::default()).unwrap();
    one.step(0.001).unwrap();
}
