// E0277: two threads read a world.
use dynpoint::{Tool, World};

fn feel(world: &World<'_>, tool: Tool) {
    std::thread::scope(|scope| {
        scope.spawn(|| tool.hit(world).unwrap());
    });
}

fn main() {
    let _ = feel;
}
