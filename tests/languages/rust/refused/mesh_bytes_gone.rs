// E0505: the bytes of a mesh go before the world that feels them.
use dynpoint::{Mesh, Pose, World, WorldDef};

fn main() {
    let bytes = vec![0; 64];
    let mut world = World::new(&WorldDef::default()).unwrap();
    world.add_body(&Mesh::borrow(&bytes).unwrap(), &Pose::IDENTITY).unwrap();
    drop(bytes);
    world.step(0.001).unwrap();
}
