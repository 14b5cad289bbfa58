// E0277: two threads read springs.
use dynpoint::Springs;

fn read(springs: &Springs<'_>) {
    std::thread::scope(|scope| {
        scope.spawn(|| springs.energy().unwrap());
    });
}

fn main() {
    let _ = read;
}
