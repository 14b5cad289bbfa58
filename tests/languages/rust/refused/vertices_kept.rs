// E0502: a body's positions are kept while it moves.
use dynpoint::{Body, World};

fn feel(world: &mut World<'_>, body: Body) -> f32 {
    let positions = body.vertices(world).unwrap();
    world.step(0.001).unwrap();
    positions[0][0]
}

fn main() {
    let _ = feel;
}
