// SPDX-License-Identifier: BSD-3-Clause
use crate::block::{first_of, first_of_mut, slice};
use crate::error::{check, room_of};
use crate::{sys, Error, Hit, MeshFault, MeshInfo, Pose, QueryDef, Result, Segment};
use core::{marker::PhantomData, ptr::NonNull};

#[cfg(feature = "alloc")]
use {crate::block::Block, alloc::sync::Arc, core::any::Any};

/// A compiled mesh, the content of a .dpa file. It does not change: threads and worlds share it.
///
/// One that owns its bytes is `Mesh<'static>` and counted; a clone is the same mesh. One of borrowed bytes has their
/// lifetime.
#[derive(Clone)]
pub struct Mesh<'a> {
    raw: NonNull<sys::dpt_mesh>,
    bytes: usize,
    #[cfg(feature = "alloc")]
    _owner: Option<Arc<dyn Any + Send + Sync>>,
    lent: PhantomData<&'a [u8]>,
}

// SAFETY: an open mesh is read-only (mesh.h).
unsafe impl Send for Mesh<'_> {}
// SAFETY: as above.
unsafe impl Sync for Mesh<'_> {}

impl<'a> Mesh<'a> {
    /// Open bytes where they are, as in flash or in a mapped file, and check all of them. They must be aligned to 8.
    pub fn borrow(bytes: &'a [u8]) -> Result<Self> {
        // SAFETY: the bytes are there and stay for 'a.
        unsafe { Self::open(bytes.as_ptr(), bytes.len()) }
    }

    /// # Safety
    /// The bytes are there, and neither move nor change for as long as the mesh is.
    unsafe fn open(bytes: *const u8, size: usize) -> Result<Self> {
        let mut mesh = core::ptr::null();
        // SAFETY: as above.
        check(unsafe { sys::dpt_mesh_open(bytes.cast(), size, &mut mesh) })?;
        let raw = NonNull::new(mesh.cast_mut()).ok_or(Error::ARGUMENT)?;
        Ok(Self {
            raw,
            bytes: size,
            #[cfg(feature = "alloc")]
            _owner: None,
            lent: PhantomData,
        })
    }

    /// Check bytes, and say where they are damaged.
    pub fn verify(bytes: &[u8]) -> Result<(), MeshFault> {
        let mut fault = MeshFault::empty();
        // SAFETY: bytes and fault are there.
        match unsafe { sys::dpt_mesh_verify(bytes.as_ptr().cast(), bytes.len(), fault.raw_mut()) } {
            sys::DPT_OK => Ok(()),
            code => {
                fault.code = code;
                Err(fault)
            }
        }
    }

    /// The mesh, for calls of [`crate::sys`].
    pub fn as_raw(&self) -> *const sys::dpt_mesh {
        self.raw.as_ptr()
    }

    /// The bytes of the mesh, as of a .dpa file.
    pub fn bytes(&self) -> &[u8] {
        // SAFETY: the mesh is its bytes, which stay.
        unsafe { slice(self.as_raw().cast(), self.bytes) }
    }

    /// What the compiler found in the source, what it repaired, and what the mesh holds.
    pub fn info(&self) -> Result<MeshInfo> {
        let mut info = MeshInfo::empty();
        // SAFETY: the info has its size.
        check(unsafe { sys::dpt_mesh_get_info(self.as_raw(), info.raw_mut()) })?;
        Ok(info)
    }

    /// All vertices, m.
    pub fn vertices(&self) -> &[[f32; 3]] {
        let (mut start, mut count) = (core::ptr::null(), 0);
        // SAFETY: an open mesh; the array lies in its bytes.
        unsafe {
            sys::dpt_mesh_get_vertices(self.as_raw(), &mut start, &mut count);
            slice(start.cast(), count as usize)
        }
    }

    /// The corners of all triangles, as indices of vertices, and the number of each triangle in the source.
    pub fn triangles(&self) -> (&[[u32; 3]], &[u32]) {
        let (mut corners, mut numbers, mut count) = (core::ptr::null(), core::ptr::null(), 0);
        // SAFETY: as above.
        unsafe {
            sys::dpt_mesh_get_triangles(self.as_raw(), &mut corners, &mut numbers, &mut count);
            (slice(corners.cast(), count as usize), slice(numbers, count as usize))
        }
    }

    /// The number in the source of each vertex.
    pub fn vertex_sources(&self) -> Result<&[u32]> {
        let (mut sources, mut count) = (core::ptr::null(), 0);
        // SAFETY: as above.
        unsafe {
            check(sys::dpt_mesh_get_vertex_sources(self.as_raw(), &mut sources, &mut count))?;
            Ok(slice(sources, count as usize))
        }
    }

    /// The corners of a triangle by its number in the source, m.
    pub fn triangle(&self, number: u32) -> Result<[[f64; 3]; 3]> {
        let mut corners = [[0.0; 3]; 3];
        // SAFETY: room for nine numbers.
        check(unsafe { sys::dpt_mesh_get_triangle(self.as_raw(), number, corners.as_mut_ptr().cast()) })?;
        Ok(corners)
    }

    /// The normals at the corners of a triangle by its number in the source.
    pub fn vertex_normals(&self, number: u32) -> Result<[[f64; 3]; 3]> {
        let mut normals = [[0.0; 3]; 3];
        // SAFETY: room for nine numbers.
        check(unsafe { sys::dpt_mesh_get_vertex_normals(self.as_raw(), number, normals.as_mut_ptr().cast()) })?;
        Ok(normals)
    }

    /// How many nodes move the vertices, where they are embedded in a coarser mesh; else 0.
    pub fn node_count(&self) -> usize {
        let (mut nodes, mut weights, mut count) = (core::ptr::null(), core::ptr::null(), 0);
        // SAFETY: an open mesh.
        unsafe { sys::dpt_mesh_get_embedding(self.as_raw(), &mut nodes, &mut weights, &mut count) };
        count as usize
    }

    /// The nearest pairs of many segments and the mesh at `pose`: `ends` are ax, ay, az, bx, by, bz each. `radii` may be
    /// empty: all are 0. [`Error::FINITE`]: one or more are stale, and all others are answered.
    pub fn query(&self, pose: &Pose, ends: &[[f64; 6]], radii: &[f64], hits: &mut [Hit], def: &QueryDef) -> Result<()> {
        if hits.len() != ends.len() || (!radii.is_empty() && radii.len() != ends.len()) {
            return Err(Error::ARGUMENT);
        }
        if let Some(hit) = hits.first_mut() {
            *hit = Hit::empty();
        }
        // SAFETY: all arrays have as many items; the first hit has its size.
        check(unsafe {
            sys::dpt_query_segments(
                self.as_raw(),
                pose.raw(),
                first_of(ends).cast(),
                first_of(radii),
                ends.len(),
                first_of_mut(hits).cast(),
                def.raw(),
            )
        })
    }

    /// The nearest pair of one segment and the mesh, in its frame.
    pub fn query_one(&self, segment: &Segment) -> Result<Hit> {
        let ([ax, ay, az], [bx, by, bz]) = (segment.a, segment.b);
        let mut hit = [Hit::empty()];
        let (ends, radii) = ([[ax, ay, az, bx, by, bz]], [segment.radius]);
        self.query(&Pose::IDENTITY, &ends, &radii, &mut hit, &QueryDef::default())?;
        Ok(hit[0])
    }

    /// The triangles that may be within `reach` of a segment, by their numbers in the source. It says how many there
    /// are, which may be more than there is room for.
    pub fn query_triangles(&self, ends: &[f64; 6], reach: f64, triangles: &mut [u32]) -> Result<usize> {
        let mut count = 0;
        // SAFETY: no more is written than there is room for.
        check(unsafe {
            sys::dpt_query_triangles(
                self.as_raw(),
                core::ptr::null(),
                ends.as_ptr(),
                reach,
                first_of_mut(triangles),
                room_of(triangles.len()),
                &mut count,
            )
        })?;
        Ok(count as usize)
    }
}

#[cfg(feature = "alloc")]
impl Mesh<'static> {
    /// Copy bytes of a .dpa file, in any machine's byte order, and open the copy.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let block = Block::copy_of(bytes).map_err(|why| if bytes.is_empty() { Error::TRUNCATED } else { why })?;
        if cfg!(target_endian = "big") {
            // SAFETY: the copy is ours alone.
            check(unsafe { sys::dpt_mesh_convert(block.start(), block.bytes(), core::ptr::null_mut()) })?;
        }
        Self::own(block.start(), block.bytes(), block)
    }

    /// Read a .dpa file.
    #[cfg(feature = "std")]
    pub fn read(path: impl AsRef<std::path::Path>) -> Result<Self> {
        Self::from_bytes(&std::fs::read(path).map_err(|_| Error::OPEN)?)
    }

    /// `start` and `size` are of the bytes that `owner` holds.
    pub(crate) fn own(start: *const u8, size: usize, owner: impl Any + Send + Sync) -> Result<Self> {
        // SAFETY: the owner keeps them until the last clone goes.
        let mut mesh = unsafe { Mesh::open(start, size) }?;
        mesh._owner = Some(Arc::new(owner));
        Ok(mesh)
    }
}

impl core::fmt::Debug for Mesh<'_> {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "Mesh of {} bytes", self.bytes)
    }
}

impl core::fmt::Display for MeshFault {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "{} ({}, byte {})", Error(self.code), self.section(), self.byte)
    }
}

impl core::error::Error for MeshFault {}

impl Pose {
    /// Where the frame is the world's.
    pub const IDENTITY: Self = Self::at([0.0; 3]);

    /// At a place, not turned.
    pub const fn at(position: [f64; 3]) -> Self {
        Self { position, orientation: [1.0, 0.0, 0.0, 0.0] }
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}
