// E0499: two threads step a world.
use dynpoint::World;

fn step(world: &mut World<'_>) {
    std::thread::scope(|scope| {
        scope.spawn(|| world.step(0.001).unwrap());
        scope.spawn(|| world.step(0.001).unwrap());
    });
}

fn main() {
    let _ = step;
}
