// SPDX-License-Identifier: BSD-3-Clause
use crate::block::first_of;
use crate::error::{check, count_of};
use crate::{sys, text, CompileDef, Error, Mesh, Result, SpringNetDef, SpringRegion};
use std::any::Any;
use std::ffi::{c_char, c_int, c_void, CStr, CString};
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::path::Path;

/// The bytes that a compiler made.
pub(crate) struct Compiled(sys::dpt_compiled);

// SAFETY: bytes that belong to it alone; who frees them is no matter (compile.h).
unsafe impl Send for Compiled {}
// SAFETY: nothing is done to them by a shared reference.
unsafe impl Sync for Compiled {}

impl Drop for Compiled {
    fn drop(&mut self) {
        // SAFETY: they are the compiler's, and are freed once.
        unsafe { sys::dpt_compiled_free(&mut self.0) };
    }
}

/// What the compiler says of a source, and where: a line from 1, or 0 and a byte from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Line of the source, from 1; 0 if the place is not a line.
    pub line: u64,
    /// Offset in the source, if line is 0.
    pub byte: u64,
    /// The reason, without the file's name.
    pub text: String,
}

/// Why a source was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompileError {
    /// Of what kind it is.
    pub error: Error,
    /// What is wrong, and where.
    pub note: Note,
}

impl std::fmt::Display for CompileError {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Note { line, byte, text } = &self.note;
        match (line, byte) {
            _ if text.is_empty() => write!(to, "{}", self.error),
            (0, 0) => write!(to, "{text}"),
            (0, byte) => write!(to, "byte {byte}: {text}"),
            (line, _) => write!(to, "line {line}: {text}"),
        }
    }
}

impl std::error::Error for CompileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}

impl From<Error> for CompileError {
    fn from(error: Error) -> Self {
        Self { error, note: Note { line: 0, byte: 0, text: String::new() } }
    }
}

impl Note {
    fn of(diag: &sys::dpt_diag) -> Self {
        let text = diag.text.map(|character| character as u8);
        Self { line: diag.line, byte: diag.byte, text: text::of_bytes(&text).into() }
    }
}

type Progress<'c> = dyn FnMut(&str, f64) -> bool + 'c;

/// What C calls back to.
#[derive(Default)]
struct Calls<'c> {
    progress: Option<Box<Progress<'c>>>,
    note: Option<Box<dyn FnMut(Note) + 'c>>,
    panic: Option<Box<dyn Any + Send>>,
}

/// The compiler: it turns a mesh, from a file or from arrays, into a [`Mesh`] that can be felt.
///
/// ```
/// use dynpoint::{Compiler, Error};
///
/// let source = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let mesh = Compiler::new().unit(0.001).name("flat.obj").bytes(source).unwrap();
/// assert_eq!(mesh.triangles().0.len(), 1);
/// assert_eq!(mesh.vertices()[1], [0.001, 0.0, 0.0]);
///
/// let refused = Compiler::new().name("flat.obj").bytes(b"v 0 0 zero\n").unwrap_err();
/// assert_eq!((refused.error, refused.note.line), (Error::SYNTAX, 1));
/// ```
#[derive(Default)]
pub struct Compiler<'c> {
    def: CompileDef,
    nodes: &'c [[f64; 3]],
    cells: &'c [[u32; 4]],
    net: Option<(SpringNetDef, &'c [SpringRegion], &'c [u32])>,
    name: Option<String>,
    calls: Calls<'c>,
}

impl<'c> Compiler<'c> {
    /// With the defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Settings of the compiler: all fields but pointers, which have methods here.
    #[must_use]
    pub fn def(mut self, def: CompileDef) -> Self {
        self.def = def;
        self
    }

    /// Metres for one unit of the source: 0.001 for millimetres.
    #[must_use]
    pub fn unit(mut self, metres: f64) -> Self {
        self.def.scale = metres;
        self
    }

    /// The most threads to use.
    #[must_use]
    pub fn threads(mut self, threads: u32) -> Self {
        self.def.threads = threads;
        self
    }

    /// The name that bytes have as a file: its extension tells the format where the content does not.
    #[must_use]
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Embed the vertices in tetrahedra: nodes in units of the source, and four of them a cell.
    #[must_use]
    pub fn cells(mut self, nodes: &'c [[f64; 3]], cells: &'c [[u32; 4]]) -> Self {
        (self.nodes, self.cells) = (nodes, cells);
        self
    }

    /// Make masses and springs; `fixed` are vertices of the source.
    #[must_use]
    pub fn springs(mut self, net: SpringNetDef, regions: &'c [SpringRegion], fixed: &'c [u32]) -> Self {
        self.net = Some((net, regions, fixed));
        self
    }

    /// A function that is told what is done, and the share of it that is: `false` stops the compiler with
    /// [`Error::CANCELLED`].
    #[must_use]
    pub fn progress(mut self, progress: impl FnMut(&str, f64) -> bool + 'c) -> Self {
        self.calls.progress = Some(Box::new(progress));
        self
    }

    /// A function that gets what you should know of a source that compiles.
    #[must_use]
    pub fn note(mut self, note: impl FnMut(Note) + 'c) -> Self {
        self.calls.note = Some(Box::new(note));
        self
    }

    /// Compile a file: OBJ, STL, PLY or OFF.
    pub fn file(self, path: impl AsRef<Path>) -> Result<Mesh<'static>, CompileError> {
        let path = path_of(path.as_ref())?;
        // SAFETY: the path is a text that stays for the call.
        self.compile(|def, out, diag| unsafe { sys::dpt_compile_file(path.as_ptr(), def, out, diag) })
    }

    /// Compile the bytes of a file.
    pub fn bytes(self, source: &[u8]) -> Result<Mesh<'static>, CompileError> {
        // SAFETY: there are as many bytes.
        self.compile(|def, out, diag| unsafe {
            sys::dpt_compile_bytes(source.as_ptr().cast(), source.len(), def, out, diag)
        })
    }

    /// Compile arrays: vertices, and three of them a triangle.
    pub fn arrays(self, vertices: &[[f64; 3]], corners: &[[u32; 3]]) -> Result<Mesh<'static>, CompileError> {
        // SAFETY: there are as many of both.
        self.compile(|def, out, diag| unsafe {
            sys::dpt_compile_arrays(
                vertices.as_ptr().cast(),
                vertices.len(),
                corners.as_ptr().cast(),
                corners.len(),
                def,
                out,
                diag,
            )
        })
    }

    fn compile(
        mut self,
        call: impl FnOnce(*const sys::dpt_compile_def, *mut sys::dpt_compiled, *mut sys::dpt_diag) -> sys::dpt_result,
    ) -> Result<Mesh<'static>, CompileError> {
        let name = self.name.take().map(CString::new).transpose().map_err(|_| Error::ARGUMENT)?;
        let mut net = self.net;
        let mut def = self.def;
        def.nodes = first_of(self.nodes).cast();
        def.node_count = count_of(self.nodes.len())?;
        def.cells = first_of(self.cells).cast();
        def.cell_count = count_of(self.cells.len())?;
        if let Some((net, regions, fixed)) = &mut net {
            net.regions = first_of(regions).cast();
            net.region_count = count_of(regions.len())?;
            net.fixed = first_of(fixed);
            net.fixed_count = count_of(fixed.len())?;
            def.springs = net.raw();
        }
        def.name = name.as_ref().map_or(std::ptr::null(), |name| name.as_ptr());
        let calls: *mut Calls<'_> = &mut self.calls;
        // SAFETY: the calls are there.
        let (has_progress, has_note) = unsafe { ((*calls).progress.is_some(), (*calls).note.is_some()) };
        def.progress = if has_progress { Some(progress) } else { None };
        def.user = calls.cast();
        def.note = if has_note { Some(note) } else { None };
        def.note_user = calls.cast();
        let mut out = Compiled(sys::dpt_compiled { bytes: std::ptr::null_mut(), size: 0 });
        let size = std::mem::size_of::<sys::dpt_diag>() as u32;
        let mut diag = sys::dpt_diag { size, code: 0, line: 0, byte: 0, text: [0; 160] };
        let result = call(def.raw(), &mut out.0, &mut diag);
        // SAFETY: C has returned, so that nobody else has a reference.
        if let Some(panic) = unsafe { (*calls).panic.take() } {
            resume_unwind(panic);
        }
        match check(result) {
            Ok(()) => Ok(Mesh::own(out.0.bytes.cast(), out.0.size, out)?),
            Err(error) => Err(CompileError { error, note: Note::of(&diag) }),
        }
    }
}

/// What C calls back to: a panic waits until C has returned.
///
/// # Safety
/// `user` is of calls that are there, with a function of this kind.
unsafe extern "C" fn progress(user: *mut c_void, step: *const c_char, done: f64) -> c_int {
    // SAFETY: as above; the step is a text that stays for the call.
    let (calls, step) = unsafe { (&mut *user.cast::<Calls<'_>>(), CStr::from_ptr(step)) };
    let Some(function) = calls.progress.as_mut() else { return 0 };
    match catch_unwind(AssertUnwindSafe(|| function(&step.to_string_lossy(), done))) {
        Ok(is_to_go_on) => c_int::from(!is_to_go_on),
        Err(panic) => {
            calls.panic = Some(panic);
            1
        }
    }
}

/// # Safety
/// As of `progress`.
unsafe extern "C" fn note(user: *mut c_void, diag: *const sys::dpt_diag) {
    // SAFETY: as above; the note is there for the call.
    let (calls, note) = unsafe { (&mut *user.cast::<Calls<'_>>(), Note::of(&*diag)) };
    let (None, Some(function)) = (&calls.panic, calls.note.as_mut()) else { return };
    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| function(note))) {
        calls.panic = Some(panic);
    }
}

/// A path as C takes it.
pub(crate) fn path_of(path: &Path) -> Result<CString> {
    #[cfg(unix)]
    let bytes = std::os::unix::ffi::OsStrExt::as_bytes(path.as_os_str());
    #[cfg(not(unix))]
    let bytes = path.to_str().ok_or(Error::ARGUMENT)?.as_bytes();
    CString::new(bytes).map_err(|_| Error::ARGUMENT)
}
