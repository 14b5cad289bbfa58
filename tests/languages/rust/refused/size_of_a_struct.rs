// E0616: a struct's size that is not its own.
use dynpoint::Hit;

fn main() {
    let mut hit = Hit::default();
    hit.size = 4096;
}
