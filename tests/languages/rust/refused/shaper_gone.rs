// E0597: what shapes a force borrows what ends before the world.
use dynpoint::{Tool, World};

fn shape<'a>(world: &mut World<'a>, tool: Tool) {
    let mut felt = 0.0;
    let reference = &mut felt;
    tool.set_shaper(world, move |info, _, _| *reference = info.energy).unwrap();
}

fn main() {
    let _ = shape;
}
