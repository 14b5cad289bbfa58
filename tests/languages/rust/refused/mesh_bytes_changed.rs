// E0506: the bytes of a mesh change while it is open.
use dynpoint::Mesh;

fn main() {
    let mut bytes = [0; 64];
    let mesh = Mesh::borrow(&bytes).unwrap();
    bytes[0] = 1;
    mesh.vertices();
}
