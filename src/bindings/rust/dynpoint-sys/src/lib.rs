// SPDX-License-Identifier: BSD-3-Clause
//! Declarations of dynpoint: all that its libraries export, made from the headers.
//!
//! The crate compiles the core from one C file, and with the feature `compile` the compiler of meshes from another. With
//! `installed` it links the libraries of the system instead; `host`, `urdf` and `convex` declare what those alone have.
//! Sizes and offsets are held to the library's list of layouts while the crate is compiled.
//!
//! Rules of the calls are those of C; the comments are the headers'. The crate `dynpoint` has a safe layer.
#![no_std]
#![allow(non_camel_case_types)]

include!("abi.rs");
