// E0597: a world's block ends before the world.
use dynpoint::{World, WorldDef};
use std::mem::MaybeUninit;

fn main() {
    let mut world;
    {
        let mut block = [MaybeUninit::uninit(); 4096];
        world = World::new_in(&mut block, &WorldDef::default()).unwrap();
    }
    world.step(0.001).unwrap();
}
