// SPDX-License-Identifier: BSD-3-Clause
//! Scenes and devices in Rust: what is felt, and what users get wrong.
use dynpoint::{Compiler, DeviceInfo, DeviceState, Error, Host, HostBody, HostDef, HostOptions, Pose, Segment};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::{mpsc, Arc, Mutex};

fn pressing(ticks: u64) -> HostOptions {
    HostOptions::new().scene("liver").device("sim:?hand=press").def(HostDef::default().ticks(ticks))
}

#[test]
fn a_scene_is_felt() {
    assert!(Host::scenes().any(|name| name == "liver"));
    let told = Arc::new(Mutex::new((0, 0.0_f64)));
    let mine = told.clone();
    let felt = move |tick: &dynpoint::Felt<'_>| {
        let mut told = mine.lock().unwrap();
        let strong = tick.wrench.force.iter().map(|one| one * one).sum::<f64>().sqrt();
        *told = (told.0 + 1, told.1.max(strong));
        assert!(tick.dt > 0.0 && tick.state.fresh > 0 && tick.hit().is_ok() && tick.force_info().is_ok());
    };
    let mut host = pressing(3000).felt(felt).open().unwrap();
    assert_eq!(host.run().unwrap().ticks, 3000);
    let (ticks, strongest) = *told.lock().unwrap();
    let info = host.info().unwrap();
    assert_eq!((ticks, strongest), (info.ticks, info.force_max));
    assert!(strongest > 0.5 && info.trouble().is_empty(), "{strongest}");
    assert_eq!(host.close().unwrap(), "");
}

#[test]
fn bodies_and_a_loop_of_ones_own() {
    let corners = [[-0.1, -0.1, -0.1], [0.1, -0.1, -0.1], [0.0, -0.1, 0.1], [0.0, 0.0, 0.0]];
    let mesh = Compiler::new().arrays(&corners, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]).unwrap();
    let mut info = DeviceInfo::default();
    (info.pose_dofs, info.wrench_dofs, info.rate, info.force_max) = (3, 3, 1000.0, 3.0);
    (info.mass, info.damping, info.delay) = (0.1, 0.5, 0.0005);
    (info.workspace_min, info.workspace_max) = ([-0.1; 3], [0.1; 3]);
    let rod = Segment { a: [0.0; 3], b: [0.0, 0.05, 0.0], radius: 0.002 };
    let options = HostOptions::new().info(info).body(&mesh, Pose::IDENTITY, None, HostBody::default()).segment(rod);
    drop(mesh);
    let mut host = options.open().unwrap();
    assert_eq!(host.meshes().len(), 1);
    let mut strongest = 0.0_f64;
    for tick in 0..600_u64 {
        let mut state = DeviceState::default();
        (state.status, state.fresh, state.sequence, state.time_ns) = (3, 1, tick, 1_000_000 * tick);
        state.pose = Pose::at([0.0, 0.05 - 0.0001 * tick as f64, 0.0]);
        let (wrench, result) = host.tick(&state, 1_000_000 * tick);
        result.unwrap();
        strongest = strongest.max(wrench.force[1]);
    }
    assert!(strongest > 0.1 && strongest <= 3.0 && host.hit().unwrap().distance < 0.01, "{strongest}");
    let mut state = DeviceState::default();
    state.pose.position[0] = f64::NAN;
    assert_eq!(host.tick(&state, 0).0.force, [0.0; 3]);
    assert_eq!(host.run().unwrap_err().error, Error::ARGUMENT);
}

#[test]
fn stopped_from_another_thread() {
    let (began, begins) = mpsc::channel();
    let felt = move |_: &dynpoint::Felt<'_>| {
        let _ = began.send(());
    };
    let mut host = pressing(0).felt(felt).open().unwrap();
    let stopper = host.stopper();
    let other = stopper.clone();
    let stopping = std::thread::spawn(move || {
        begins.recv().unwrap();
        other.stop();
    });
    assert!(host.run().unwrap().ticks > 0);
    stopping.join().unwrap();
    drop(host);
    stopper.stop();
}

#[test]
fn a_panic_ends_the_run() {
    let mut host = pressing(0).felt(|_| panic!("of the tick")).open().unwrap();
    let panic = catch_unwind(AssertUnwindSafe(|| host.run())).unwrap_err();
    assert_eq!(*panic.downcast::<&str>().unwrap(), "of the tick");
    assert_eq!(host.info().unwrap().ticks, 1);
}

#[test]
fn what_does_not_open() {
    let text = |options: HostOptions| options.open().unwrap_err().to_string();
    assert!(text(HostOptions::new().scene("lover").device("sim")).contains("lover"));
    assert!(text(HostOptions::new().scene("liver").device("nothing:")).contains("nothing"));
    assert_eq!(HostOptions::new().open().unwrap_err().error, Error::ARGUMENT);
    assert_eq!(HostOptions::new().scene("li\0ver").open().unwrap_err().error, Error::ARGUMENT);
    assert!(pressing(1).def(HostDef::default().stiffness(f64::NAN)).open().is_err());
    assert!(pressing(1).felt(|_| ()).record("/no/such/folder/run.dpr").open().is_err());
    assert!(pressing(1).segment(Segment { radius: -1.0, ..Segment::default() }).open().is_err());
}
