// SPDX-License-Identifier: BSD-3-Clause
//! Compiles the C sources, or links libraries that are installed: in DYNPOINT_LIB_DIR, or where pkg-config finds them.
use std::{env, path::Path, process::Command};

fn has(feature: &str) -> bool {
    env::var_os(format!("CARGO_FEATURE_{feature}")).is_some()
}

fn main() {
    println!("cargo:rerun-if-env-changed=DYNPOINT_LIB_DIR");
    println!("cargo:rerun-if-changed=c");
    if has("INSTALLED") {
        link_installed();
    } else {
        compile();
    }
}

/// The files say themselves how they are to be compiled (docs/ffi.md); a debug build of them is of no use to anyone.
fn compile() {
    let mut sources = cc::Build::new();
    sources.file("c/dynpoint.c").opt_level(2).warnings(false);
    if has("COMPILE") {
        sources.file("c/dynpoint_compile.c");
    }
    sources.compile("dynpoint");
    if env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family.contains("unix")) {
        println!("cargo:rustc-link-lib=m");
    }
    println!("cargo:include={}", Path::new(&env::var("CARGO_MANIFEST_DIR").unwrap()).join("c").display());
}

fn link_installed() {
    let mut names = vec!["dynpoint"];
    for (feature, name) in [
        ("COMPILE", "dynpoint_compile"),
        ("HOST", "dynpoint_drivers"),
        ("HOST", "dynpoint_host"),
        ("URDF", "dynpoint_urdf"),
        ("CONVEX", "dynpoint_convex"),
    ] {
        if has(feature) {
            names.push(name);
        }
    }
    if let Ok(folder) = env::var("DYNPOINT_LIB_DIR") {
        println!("cargo:rustc-link-search=native={folder}");
    } else {
        for name in &names {
            let name = format!("lib{name}");
            match Command::new("pkg-config").args(["--variable=libdir", &name]).output() {
                Ok(said) if said.status.success() => {
                    println!("cargo:rustc-link-search=native={}", String::from_utf8_lossy(&said.stdout).trim())
                }
                _ => {
                    panic!("{name} is not installed: pkg-config does not know it, and DYNPOINT_LIB_DIR names no folder")
                }
            }
        }
    }
    for name in names {
        println!("cargo:rustc-link-lib=dylib={name}");
    }
}
