// SPDX-License-Identifier: BSD-3-Clause
//! What users get wrong in Rust: an error, or the panic that they began, never more. release.sh has it over sanitizers.
use dynpoint::{
    force, law, response, status, Body, Channel, Compiler, Contact, DeformableDef, Error, Guard, GuardDef, Hit,
};
use dynpoint::{
    Hull, Load, Mesh, Pose, QueryDef, Segment, SpringNetDef, Springs, SpringsDef, Tip, Tool, World, WorldDef,
};
use std::mem::{size_of, MaybeUninit};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;

const ROD: Segment = Segment { a: [0.0; 3], b: [0.0, 0.0, 0.05], radius: 0.002 };
const CORNERS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.1, 0.0, 0.0],
    [0.0, 0.1, 0.0],
    [0.1, 0.1, 0.0],
    [0.0, 0.0, 0.1],
    [0.1, 0.0, 0.1],
    [0.0, 0.1, 0.1],
    [0.1, 0.1, 0.1],
];
const BOX: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

fn cube() -> Mesh<'static> {
    Compiler::new().arrays(&CORNERS, &BOX).unwrap()
}

fn soft_cube() -> Mesh<'static> {
    let net = SpringNetDef::default().kind(dynpoint::net::VOLUME).spacing(0.02).drag(10.0);
    Compiler::new().springs(net, &[], &[]).arrays(&CORNERS, &BOX).unwrap()
}

fn above() -> Pose {
    Pose::at([0.05, 0.05, 0.11])
}

/// Numbers as bytes, which are aligned to 8 so.
fn bytes_of(numbers: &mut [u64]) -> &mut [u8] {
    // SAFETY: as many bytes, of any value.
    unsafe { std::slice::from_raw_parts_mut(numbers.as_mut_ptr().cast(), 8 * numbers.len()) }
}

/// A tool that presses a millimetre deep.
fn press(world: &mut World<'_>, tool: Tool) {
    for tick in 0..20 {
        tool.set_pose(world, &Pose::at([0.05, 0.05, 0.11 - 0.0007 * f64::from(tick)])).unwrap();
        world.step(0.001).unwrap();
    }
}

#[test]
fn a_world_keeps_what_it_feels() {
    let mut world = World::new(&WorldDef::default()).unwrap();
    let tool = {
        let (mesh, hull) = (cube(), Hull::new(&[[0.0; 3], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0]], 0.001).unwrap());
        world.add_body(&mesh, &Pose::IDENTITY).unwrap();
        let tool = world.add_tool(&[ROD]).unwrap();
        tool.set_tips(&mut world, &[Tip { hull: &hull, pose: Pose::IDENTITY }]).unwrap();
        tool
    };
    press(&mut world, tool);
    assert!(tool.wrench(&world).unwrap().force[2] > 0.5);
    tool.set_tips(&mut world, &[]).unwrap();
    press(&mut world, tool);
}

#[test]
fn a_removed_body_is_let_go() {
    let mut world = World::new(&WorldDef::default().max_bodies(1)).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    for _ in 0..3 {
        let body = world.add_body(&cube(), &Pose::IDENTITY).unwrap();
        press(&mut world, tool);
        assert!(tool.hit(&world).unwrap().body == body.id());
        assert_eq!(world.add_body(&cube(), &Pose::IDENTITY), Err(Error::FULL));
        body.remove(&mut world).unwrap();
        assert_eq!(body.remove(&mut world), Err(Error::HANDLE));
        assert!(!body.is_valid(&world));
        world.step(0.001).unwrap();
        assert_eq!(tool.wrench(&world).unwrap().force, [0.0; 3]);
    }
}

#[test]
fn ids_of_others() {
    let mut world = World::new(&WorldDef::default()).unwrap();
    let (body, tool) = (world.add_body(&cube(), &Pose::IDENTITY).unwrap(), world.add_tool(&[ROD]).unwrap());
    assert_eq!(Tool::from_id(body.id()).wrench(&world), Err(Error::HANDLE));
    assert_eq!(Body::from_id(tool.id()).set_pose(&mut world, &above()), Err(Error::HANDLE));
    for id in [0, 1, u32::MAX] {
        let (body, tool) = (Body::from_id(id), Tool::from_id(id));
        assert_eq!(body.set_vertices(&mut world, 0, &[[0.0; 3]], -1.0), Err(Error::HANDLE));
        assert_eq!(body.set_nodes(&mut world, &[[0.0; 3]]), Err(Error::HANDLE));
        assert_eq!(body.vertices(&world), Err(Error::HANDLE));
        assert!(body.loads(&world) == Err(Error::HANDLE) && body.remove(&mut world) == Err(Error::HANDLE));
        assert!(tool.hit(&world).is_err() && tool.contacts(&world).is_err() && tool.remove(&mut world).is_err());
        assert_eq!(tool.set_shaper(&mut world, |_, _, _| ()), Err(Error::HANDLE));
        assert_eq!(tool.set_tips(&mut world, &[]), Err(Error::HANDLE));
        assert_eq!(tool.remove_shaper(&mut world), Err(Error::HANDLE));
    }
}

#[test]
fn numbers_that_are_none() {
    let mut world = World::new(&WorldDef::default()).unwrap();
    let mesh = cube();
    let body = world.add_body(&mesh, &Pose::IDENTITY).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(tool.set_pose(&mut world, &Pose::at([bad, 0.0, 0.0])), Err(Error::FINITE));
        world.step(0.001).unwrap();
        assert_eq!(tool.force_info(&world).unwrap().reason, force::STALE);
        assert_eq!(tool.wrench(&world).unwrap().force, [0.0; 3]);
        let turned = Pose { orientation: [bad, 0.0, 0.0, 0.0], ..Pose::IDENTITY };
        assert!(body.set_pose(&mut world, &turned).is_err());
        body.set_pose(&mut world, &Pose::IDENTITY).unwrap();
        press(&mut world, tool);
        assert!(tool.wrench(&world).unwrap().force[2] > 0.5);
        assert!(world.step(bad).is_err() && world.step(-bad).is_err());
        assert!(world.add_tool(&[Segment { radius: bad, ..ROD }]).is_err());
        let settings = tool.settings(&world).unwrap().stiffness(bad);
        assert!(tool.set_settings(&mut world, &settings).is_err());
        assert!(World::new(&WorldDef::default().margin(bad)).is_err());
        let refused = Compiler::new().arrays(&[[bad, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        assert_eq!(refused.unwrap_err().error, Error::FINITE);
        let mut hits = [Hit::default(); 2];
        let ends = [[bad; 6], [0.0, 0.0, 0.2, 0.0, 0.0, 0.3]];
        assert_eq!(mesh.query(&Pose::IDENTITY, &ends, &[], &mut hits, &QueryDef::default()), Err(Error::FINITE));
        assert_eq!((hits[0].status, hits[1].status), (status::STALE, status::EXACT));
        let mut guard = Guard::new(&GuardDef::default()).unwrap();
        let wrench = dynpoint::Wrench { force: [bad, 0.0, 0.0], torque: [0.0; 3] };
        let sent = guard.step(1, Some(&wrench), true);
        assert!(sent.force.iter().all(|one| one.is_finite()));
        assert!(Guard::new(&GuardDef::default().force_max(bad)).is_err());
    }
}

#[test]
fn arrays_of_a_wrong_size() {
    let mut world = World::new(&WorldDef::default()).unwrap();
    let mesh = soft_cube();
    let body = world.add_deformable(&mesh, &Pose::IDENTITY, &DeformableDef::default(), &[]).unwrap();
    let rigid = world.add_body(&cube(), &Pose::at([1.0, 0.0, 0.0])).unwrap();
    let count = mesh.vertices().len();
    assert_eq!(count, 8);
    let many = vec![[0.05_f32; 3]; count + 1];
    assert_eq!(body.set_vertices(&mut world, 0, &many, -1.0), Err(Error::ARGUMENT));
    assert_eq!(body.set_vertices(&mut world, u32::MAX, &many[..1], -1.0), Err(Error::ARGUMENT));
    assert_eq!(body.set_vertex_list(&mut world, &[0, 1], &many[..1], -1.0), Err(Error::ARGUMENT));
    assert_eq!(body.set_vertex_list(&mut world, &[count as u32], &many[..1], -1.0), Err(Error::ARGUMENT));
    assert!(mesh.node_count() > count);
    for length in [0, 1, mesh.node_count() - 1, mesh.node_count() + 1] {
        assert_eq!(body.set_nodes(&mut world, &vec![[0.0; 3]; length]), Err(Error::ARGUMENT));
    }
    assert_eq!(rigid.set_nodes(&mut world, &many), Err(Error::UNSUPPORTED));
    let def = DeformableDef::default().compliance(1e-3);
    assert_eq!(world.add_deformable(&mesh, &Pose::IDENTITY, &def, &[1e-3; 3]), Err(Error::ARGUMENT));
    let mut hits = [Hit::default(); 3];
    assert_eq!(mesh.query(&Pose::IDENTITY, &[[0.0; 6]; 2], &[], &mut hits, &QueryDef::default()), Err(Error::ARGUMENT));
    let (def, ends) = (QueryDef::default(), [[0.0; 6]; 3]);
    assert_eq!(mesh.query(&Pose::IDENTITY, &ends, &[0.0; 2], &mut hits, &def), Err(Error::ARGUMENT));
    let tool = world.add_tool(&[ROD]).unwrap();
    assert!(tool.set_segments(&mut world, &[ROD, ROD]).is_err() && tool.set_segments(&mut world, &[]).is_err());
    assert!(tool.try_segments(&world, &mut [ROD; 3], 0.0).is_err());
    let hull = Hull::new(&CORNERS, 0.0).unwrap();
    assert_eq!(tool.set_tips(&mut world, &[Tip { hull: &hull, pose: above() }; 65]), Err(Error::LIMIT));
    assert_eq!(tool.set_tips(&mut world, &[Tip { hull: &hull, pose: above() }; 5]), Err(Error::FULL));
    let springs = Springs::new(&mesh, &SpringsDef::default()).unwrap();
    for length in [0, springs.count() - 1, springs.count() + 1] {
        assert!(springs.nodes_into(&mut vec![[0.0; 3]; length], &mut []).is_err());
    }
    let mut nodes = vec![[0.0; 3]; springs.count()];
    assert_eq!(springs.nodes_into(&mut nodes, &mut [[0.0; 3]; 2]), Err(Error::ARGUMENT));
    assert!(springs.compliances_into(0.001, &mut [0.0; 3]).is_err());
    springs.nodes_into(&mut nodes, &mut []).unwrap();
}

#[test]
fn nothing_at_all() {
    let mut world = World::new(&WorldDef::default().max_contacts(4).max_channels(1)).unwrap();
    assert!(world.add_tool(&[]).is_err());
    let tool = world.add_tool(&[ROD]).unwrap();
    world.step(0.001).unwrap();
    assert_eq!(tool.contacts_into(&world, &mut []), Ok(0));
    assert!(tool.contacts(&world).unwrap().is_empty() && tool.loads(&world).unwrap().is_empty());
    assert_eq!(tool.channels_into(&world, &mut [Channel::default(); 2]), Ok(0));
    let (ran, infos) = world.step_springs(&mut [], 0.001);
    assert!(infos.is_empty());
    let _ = ran;
    assert!(Compiler::new().arrays(&[], &[]).is_err());
    assert!(Compiler::new().bytes(&[]).is_err() && Compiler::new().file("").is_err());
    assert!(Compiler::new().file("no\0file.obj").is_err() && Compiler::new().name("a\0b").bytes(b"v").is_err());
    assert!(Mesh::borrow(&[]).is_err() && Mesh::from_bytes(&[]).is_err() && Mesh::verify(&[]).is_err());
    assert!(Hull::new(&[], 0.0).is_err());
    let mesh = cube();
    mesh.query(&Pose::IDENTITY, &[], &[], &mut [], &QueryDef::default()).unwrap();
    assert!(mesh.query_triangles(&[0.0; 6], 1.0, &mut []).unwrap() == 12);
    assert_eq!(mesh.node_count(), 0);
    assert!(Springs::new(&mesh, &SpringsDef::default()).is_err());
    assert!(World::new_in(&mut [], &WorldDef::default()).is_err());
    assert!(World::new_in(&mut [MaybeUninit::uninit(); 8], &WorldDef::default()).unwrap_err() == Error::MEMORY);
}

#[test]
fn lists_longer_than_their_room() {
    let mut world = World::new(&WorldDef::default().max_contacts(64).max_bodies(20)).unwrap();
    let mesh = cube();
    for number in 0..20 {
        world.add_body(&mesh, &Pose::at([0.2 * f64::from(number), 0.0, 0.0])).unwrap();
    }
    let rod = Segment { a: [0.0; 3], b: [4.0, 0.0, 0.0], radius: 0.002 };
    let tool = world.add_tool(&[rod]).unwrap();
    for height in [0.12, 0.11, 0.1021, 0.1019] {
        tool.set_pose(&mut world, &Pose::at([0.0, 0.05, height])).unwrap();
        world.step(0.001).unwrap();
    }
    let all = tool.contacts(&world).unwrap();
    assert_eq!(all.len(), 20);
    let mut three = [Contact::default(); 3];
    assert_eq!(tool.contacts_into(&world, &mut three), Ok(20));
    assert_eq!(three[..], all[..3]);
}

#[test]
fn damaged_bytes() {
    let mesh = cube();
    let bytes = mesh.bytes().to_vec();
    assert_eq!(Mesh::from_bytes(&bytes).unwrap().vertices(), mesh.vertices());
    for end in [1, 7, 8, 64, bytes.len() - 1] {
        assert!(Mesh::from_bytes(&bytes[..end]).is_err());
    }
    for at in (0..bytes.len()).step_by(7) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        if let Ok(opened) = Mesh::from_bytes(&damaged) {
            opened.query_one(&ROD).unwrap();
        }
    }
    let mut aligned: Vec<u64> = bytes.chunks(8).map(|eight| u64::from_ne_bytes(eight.try_into().unwrap())).collect();
    assert_eq!(Mesh::verify(bytes_of(&mut aligned)), Ok(()));
    bytes_of(&mut aligned)[bytes.len() / 2] ^= 1;
    let fault = Mesh::verify(bytes_of(&mut aligned)).unwrap_err();
    assert!(fault.code == Error::CHECKSUM.code() && !fault.section().is_empty());
    assert!(fault.to_string().contains("a checksum does not match"), "{fault}");
    let mut shifted = vec![0; bytes.len() + 8];
    let odd = (shifted.as_ptr() as usize).wrapping_neg() % 8 + 1;
    shifted[odd..odd + bytes.len()].copy_from_slice(&bytes);
    assert_eq!(Mesh::borrow(&shifted[odd..odd + bytes.len()]).unwrap_err(), Error::ALIGN);
}

#[test]
fn springs_of_another_mesh() {
    let (mesh, other) = (soft_cube(), soft_cube());
    let mut world = World::new(&WorldDef::default()).unwrap();
    let def = DeformableDef::default();
    let body = world.add_deformable(&mesh, &Pose::IDENTITY, &def, &[]).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    let mut wrong = Springs::new(&other, &SpringsDef::default()).unwrap();
    assert_eq!(body.step_springs(&mut world, Some(&mut wrong), 0.001), Err(Error::ARGUMENT));
    assert_eq!(body.step_springs(&mut world, None, 0.001), Err(Error::ARGUMENT));
    let mut springs = Springs::new(&mesh, &SpringsDef::default()).unwrap();
    drop((wrong, other));
    for _ in 0..5 {
        world.step(0.001).unwrap();
        let (ran, infos) = world.step_springs(&mut [(body, Some(&mut springs))], 0.001);
        ran.unwrap();
        assert_eq!(infos[0].nodes as usize, springs.count());
        assert!(body.step_springs(&mut world, Some(&mut springs), f64::NAN).is_err());
    }
    let heavy = [Load::default().force([f64::NAN, 0.0, 0.0])];
    assert_eq!(springs.step(0.001, &heavy), Err(Error::FINITE));
    assert!(springs.set_nodes(u32::MAX, &[[0.0; 3]], &[]).is_err());
    drop((springs, mesh));
    press(&mut world, tool);
    assert!(!body.loads(&world).unwrap().is_empty());
    body.remove(&mut world).unwrap();
    world.step(0.001).unwrap();
    tool.hit(&world).unwrap();
}

#[test]
fn positions_lent_by_a_body() {
    let mesh = cube();
    let mut world = World::new(&WorldDef::default().law(law::BED).strip(dynpoint::strip_kind::SHADOW)).unwrap();
    let def = DeformableDef::default().response(response::DISPLACE);
    let body = world.add_deformable(&mesh, &Pose::IDENTITY, &def, &[]).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    press(&mut world, tool);
    let before = body.vertices(&world).unwrap();
    tool.hit(&world).unwrap();
    assert_eq!(before.len(), 8);
}

#[test]
fn panics_pass_through_c() {
    let mut world = World::new(&WorldDef::default()).unwrap();
    world.add_body(&cube(), &Pose::IDENTITY).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    press(&mut world, tool);
    tool.set_shaper(&mut world, |_, _, _| panic!("of the shaper")).unwrap();
    let panic = catch_unwind(AssertUnwindSafe(|| world.step(0.001))).unwrap_err();
    assert_eq!(*panic.downcast::<&str>().unwrap(), "of the shaper");
    assert_eq!(tool.wrench(&world).unwrap().force, [0.0; 3]);
    tool.set_shaper(&mut world, |info, dt, wrench| {
        assert_eq!((dt, wrench.force), (0.001, info.wrench.force));
        wrench.force = [0.0, 2.0, f64::NAN];
    })
    .unwrap();
    world.step(0.001).unwrap();
    assert_eq!(tool.wrench(&world).unwrap().force, [0.0; 3]);
    tool.set_shaper(&mut world, |_, _, wrench| wrench.force = [0.0, 2.0, 0.0]).unwrap();
    world.step(0.001).unwrap();
    assert_eq!(tool.wrench(&world).unwrap().force, [0.0, 2.0, 0.0]);

    let other = world.add_tool(&[ROD]).unwrap();
    other.set_pose(&mut world, &above()).unwrap();
    for tool in [tool, other] {
        tool.set_shaper(&mut world, |_, _, _| panic!("of two")).unwrap();
    }
    assert!(catch_unwind(AssertUnwindSafe(|| world.step(0.001))).is_err());
    for tool in [tool, other] {
        tool.remove_shaper(&mut world).unwrap();
    }
    world.step(0.001).unwrap();

    let compile = |compiler: Compiler<'_>| catch_unwind(AssertUnwindSafe(|| compiler.arrays(&CORNERS, &BOX)));
    assert!(compile(Compiler::new().progress(|_, _| panic!("of the progress"))).is_err());
    let stopped = compile(Compiler::new().progress(|_, _| false)).unwrap();
    assert_eq!(stopped.unwrap_err().error, Error::CANCELLED);
    let polygon = b"OFF\n4 1 0\n0 0 0\n1 1 0\n1 0 0\n0 1 0\n4 0 1 2 3\n";
    let mut notes = Vec::new();
    Compiler::new().note(|note| notes.push(note)).bytes(polygon).unwrap();
    assert!(!notes.is_empty() && !notes[0].text.is_empty());
    let noted = catch_unwind(|| Compiler::new().note(|_| panic!("of the note")).bytes(polygon).is_ok());
    assert!(noted.is_err());
}

#[test]
fn shapers_are_dropped_once() {
    struct Counted(Arc<AtomicUsize>);
    impl Drop for Counted {
        fn drop(&mut self) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }
    let dropped = Arc::new(AtomicUsize::new(0));
    let mut world = World::new(&WorldDef::default()).unwrap();
    world.add_body(&cube(), &Pose::IDENTITY).unwrap();
    let (tool, other) = (world.add_tool(&[ROD]).unwrap(), world.add_tool(&[ROD]).unwrap());
    let shape = |world: &mut World<'static>, tool: Tool| {
        let counted = Counted(dropped.clone());
        tool.set_shaper(world, move |_, _, wrench| {
            let _ = &counted;
            wrench.torque = [0.0; 3];
        })
        .unwrap();
    };
    shape(&mut world, tool);
    shape(&mut world, tool);
    press(&mut world, tool);
    assert_eq!(dropped.load(Ordering::Relaxed), 1);
    tool.remove_shaper(&mut world).unwrap();
    assert_eq!(dropped.load(Ordering::Relaxed), 2);
    shape(&mut world, tool);
    tool.remove(&mut world).unwrap();
    world.step(0.001).unwrap();
    assert_eq!(dropped.load(Ordering::Relaxed), 3);
    shape(&mut world, other);
    world = std::thread::spawn(move || {
        world.step(0.001).unwrap();
        world
    })
    .join()
    .unwrap();
    drop(world);
    assert_eq!(dropped.load(Ordering::Relaxed), 4);
}

#[test]
fn blocks_and_bytes_of_the_callers() {
    let mesh = cube();
    let mut numbers = vec![0_u64; mesh.bytes().len() / 8];
    let bytes = bytes_of(&mut numbers);
    bytes.copy_from_slice(mesh.bytes());
    let lent = Mesh::borrow(bytes).unwrap();
    let def = WorldDef::default();
    let room = |bytes: usize| vec![MaybeUninit::<u64>::uninit(); bytes.div_ceil(8)];
    let (mut block, mut soft) = (room(World::bytes(&def).unwrap()), room(0));
    let deformable = DeformableDef::default();
    soft.resize(Body::deformable_bytes(&lent, &deformable).unwrap().div_ceil(8), MaybeUninit::uninit());
    let mut world = World::new_in(&mut block, &def).unwrap();
    world.add_deformable_in(&mut soft, &lent, &Pose::IDENTITY, &deformable, &[]).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    press(&mut world, tool);
    assert!(tool.wrench(&world).unwrap().force[2] > 0.5);
}

#[test]
fn defs_that_ask_for_too_much() {
    for def in [
        WorldDef::default().certificate_bytes(u64::MAX),
        WorldDef::default().max_bodies(0),
        WorldDef::default().max_tools(u32::MAX),
        WorldDef::default().method(77),
        WorldDef::default().certificate_bytes(1 << 40).max_tools(65535),
    ] {
        let refused = World::new(&def).unwrap_err();
        assert!(refused == Error::ARGUMENT || refused == Error::MEMORY, "{refused}");
    }
    assert_eq!(WorldDef::default().max_bodies, 16);
}

#[test]
fn who_may_be_sent_and_shared() {
    fn sent<T: Send>() {}
    fn shared<T: Sync>() {}
    sent::<(Mesh<'_>, Hull<'_>, World<'_>, Springs<'_>, Guard, WorldDef, DeformableDef, Error)>();
    shared::<(Mesh<'_>, Hull<'_>, WorldDef, Error)>();
    let mesh = cube();
    let distances: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| mesh.query_one(&ROD).unwrap().distance)).collect();
        threads.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert!(distances.iter().all(|one| *one == distances[0]));
}

/// Addresses for as many items, all 0, which take no memory until they are written.
fn items<T>(count: usize) -> &'static mut [T] {
    extern "C" {
        fn mmap(at: *mut u8, bytes: usize, protection: i32, flags: i32, file: i32, offset: i64) -> *mut u8;
    }
    // SAFETY: private, anonymous and without a reserve (0x4022); the items are numbers.
    unsafe {
        let start = mmap(std::ptr::null_mut(), count * size_of::<T>(), 3, 0x4022, -1, 0);
        assert!(start as isize != -1, "no addresses for {count} items");
        std::slice::from_raw_parts_mut(start.cast(), count)
    }
}

#[test]
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn counts_beyond_32_bits() {
    let many = (1 << 32) + 1;
    let mesh = soft_cube();
    let mut world = World::new(&WorldDef::default().max_contacts(4)).unwrap();
    let body = world.add_deformable(&mesh, &Pose::IDENTITY, &DeformableDef::default(), &[]).unwrap();
    let tool = world.add_tool(&[ROD]).unwrap();
    press(&mut world, tool);
    let positions = items::<[f32; 3]>(many);
    assert_eq!(body.set_vertices(&mut world, 0, positions, -1.0), Err(Error::LIMIT));
    assert_eq!(body.set_vertex_list(&mut world, items(many), positions, -1.0), Err(Error::LIMIT));
    assert_eq!(body.set_nodes(&mut world, positions), Err(Error::ARGUMENT));
    assert_eq!(body.set_answered_loads(&mut world, items(many)), Err(Error::LIMIT));
    assert_eq!(tool.set_segments(&mut world, items(many)), Err(Error::LIMIT));
    assert_eq!(world.add_tool(items(many)), Err(Error::LIMIT));
    let mut springs = Springs::new(&mesh, &SpringsDef::default()).unwrap();
    assert_eq!(springs.step(0.001, items(many)), Err(Error::LIMIT));
    assert_eq!(springs.set_nodes(0, positions, &[]), Err(Error::LIMIT));
    assert_eq!(springs.nodes_into(positions, &mut []), Err(Error::LIMIT));
    let (ends, hits, def) = (items(many), items::<Hit>(many), QueryDef::default());
    assert_eq!(mesh.query(&Pose::IDENTITY, ends, &[], hits, &def), Err(Error::LIMIT));
    assert_eq!(Hull::new(items(many), 0.0).unwrap_err(), Error::LIMIT);
    let net = SpringNetDef::default().kind(dynpoint::net::VOLUME);
    let fixed = Compiler::new().springs(net, &[], items(many)).arrays(&CORNERS, &BOX);
    assert_eq!(fixed.unwrap_err().error, Error::LIMIT);
    assert_eq!(Compiler::new().arrays(items(many), &BOX).unwrap_err().error, Error::LIMIT);
    assert_eq!(tool.contacts_into(&world, items(many)), tool.contacts(&world).map(|all| all.len()));
}

#[test]
fn texts() {
    let error = World::new(&WorldDef::default().max_bodies(0)).unwrap_err();
    assert_eq!(error.name(), "DPT_E_ARGUMENT");
    assert_eq!(error.to_string(), "an argument is NULL or outside its stated range");
    assert_eq!(dynpoint::version(), env!("DYNPOINT_VERSION"));
}
