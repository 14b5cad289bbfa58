// E0277: what shapes a force belongs to one thread, and the world does not.
use dynpoint::{Tool, World};
use std::{cell::Cell, rc::Rc};

fn shape(world: &mut World<'_>, tool: Tool) {
    let calls = Rc::new(Cell::new(0));
    tool.set_shaper(world, move |_, _, _| calls.set(calls.get() + 1)).unwrap();
}

fn main() {
    let _ = shape;
}
