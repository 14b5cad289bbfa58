// E0616: a def's pointer to anywhere.
use dynpoint::WorldDef;

fn main() {
    let mut def = WorldDef::default();
    def.baseline = 8 as *const _;
}
