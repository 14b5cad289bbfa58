// SPDX-License-Identifier: BSD-3-Clause
//! The scene of ../touch.c in Rust, with the same arguments and output.
use dynpoint::{Compiler, Error, Mesh, Pose, Segment, World, WorldDef, Wrench};
use std::{hint::black_box, time::Instant};

const RINGS: usize = 24;
const SIDES: usize = 48;
const TICKS: usize = 10000;

/// The place k of SIDES on the unit circle.
fn circle(k: usize) -> (f64, f64) {
    let t = (k % (SIDES / 4)) as f64 / (SIDES / 4) as f64;
    let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
    [(c, s), (-s, c), (-c, -s), (s, -c)][k / (SIDES / 4) % 4]
}

fn ball() -> Mesh<'static> {
    let (mut vertices, mut corners) = (Vec::new(), Vec::new());
    for r in 0..=RINGS {
        for k in 0..SIDES {
            let ((z, rho), (x, y)) = (circle(r), circle(k));
            vertices.push([0.05 * rho * x, 0.05 * rho * y, 0.05 * z]);
            let (a, b, down) = ((r * SIDES + k) as u32, (r * SIDES + (k + 1) % SIDES) as u32, SIDES as u32);
            if r < RINGS {
                corners.extend([[a, a + down, b], [b, a + down, b + down]]);
            }
        }
    }
    Compiler::new().arrays(&vertices, &corners).expect("compile")
}

fn path(tick: usize) -> Pose {
    let fold = |n: i32| f64::from((tick as i32 % (2 * n) - n).abs());
    let u = (fold(2000) - 1000.0) * 0.00005;
    Pose {
        position: [(fold(1500) - 750.0) * 0.00002, (fold(1100) - 550.0) * 0.00002, 0.05 + fold(500) * 0.00001],
        orientation: [(1.0 - u * u) / (1.0 + u * u), 0.0, 2.0 * u / (1.0 + u * u), 0.0],
    }
}

/// Seconds of the ticks alone.
fn feel(mesh: &Mesh<'static>, poses: &[Pose], wrenches: &mut [Wrench]) -> Result<f64, Error> {
    let mut world = World::new(&WorldDef::default())?;
    let body = world.add_body(mesh, &Pose::IDENTITY)?;
    let settings = body.settings(&world)?.static_friction(0.3).kinetic_friction(0.3);
    body.set_settings(&mut world, &settings)?;
    let tool = world.add_tool(&[Segment { a: [-0.025, 0.0, 0.0], b: [0.025, 0.0, 0.0], radius: 0.002 }])?;
    let began = Instant::now();
    for (pose, wrench) in poses.iter().zip(wrenches) {
        tool.set_pose(&mut world, black_box(pose))?;
        world.step(0.001)?;
        *wrench = tool.wrench(&world)?;
    }
    Ok(began.elapsed().as_secs_f64())
}

fn main() {
    let rounds = std::env::args().nth(1).map_or(1, |rounds| rounds.parse().expect("a number of rounds"));
    let (mesh, poses) = (ball(), (0..TICKS).map(path).collect::<Vec<_>>());
    let mut wrenches = vec![Wrench::default(); TICKS];
    let least = (0..rounds).map(|_| feel(&mesh, &poses, &mut wrenches).expect("feel")).fold(1e9, f64::min);
    let bytes = wrenches.iter().flat_map(|one| one.force.into_iter().chain(one.torque)).flat_map(f64::to_le_bytes);
    let hash = bytes.fold(14695981039346656037_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(1099511628211));
    println!("{hash:016x} {TICKS} {least:.6}");
}
