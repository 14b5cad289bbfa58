// E0308: a position of two coordinates.
use dynpoint::{Body, World};

fn move_it(world: &mut World<'_>, body: Body) {
    body.set_vertices(world, 0, &[[0.0, 0.0]], -1.0).unwrap();
}

fn main() {
    let _ = move_it;
}
