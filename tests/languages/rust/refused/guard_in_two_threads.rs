// E0277: two threads read a guard.
use dynpoint::Guard;

fn read(guard: &Guard) {
    std::thread::scope(|scope| {
        scope.spawn(|| guard.info().unwrap());
    });
}

fn main() {
    let _ = read;
}
