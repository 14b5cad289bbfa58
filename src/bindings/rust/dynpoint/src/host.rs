// SPDX-License-Identifier: BSD-3-Clause
use crate::block::first_of;
use crate::compiler::path_of;
use crate::error::{check, count_of};
use crate::{sys, text, BodySettings, DeviceInfo, DeviceState, Error, ForceInfo, Hit, HostBody, HostDef, HostInfo};
use crate::{LoopStats, Mesh, Pose, Result, Segment, Wrench};
use std::any::Any;
use std::ffi::{c_char, c_void, CString};
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::path::Path;
use std::ptr::{null, null_mut, NonNull};
use std::sync::{Arc, Mutex, PoisonError};

/// Why a host did not open, or a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostError {
    /// Of what kind it is.
    pub error: Error,
    /// The file, its place and the reason, in one line.
    pub text: String,
}

impl std::fmt::Display for HostError {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.write_str(if self.text.is_empty() { self.error.text() } else { &self.text })
    }
}

impl std::error::Error for HostError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}

impl From<Error> for HostError {
    fn from(error: Error) -> Self {
        Self { error, text: String::new() }
    }
}

/// Room for what a call has to say.
struct Said(sys::dpt_host_error);

impl Said {
    fn new() -> Self {
        let size = std::mem::size_of::<sys::dpt_host_error>() as u32;
        Self(sys::dpt_host_error { size, code: 0, text: [0; 1000] })
    }

    fn text(&self) -> String {
        text::of_bytes(&self.0.text.map(|character| character as u8)).into()
    }

    fn check(&self, code: sys::dpt_result) -> Result<(), HostError> {
        check(code).map_err(|error| HostError { error, text: self.text() })
    }
}

/// One tick, for a function that is called after each: `wrench` is at the hand, before the guard.
pub struct Felt<'t> {
    /// The device's sample.
    pub state: &'t DeviceState,
    /// s, since the sample before.
    pub dt: f64,
    /// What is felt.
    pub wrench: Wrench,
    /// Whether the tick gave a force; [`Error::NOT_READY`] while the clutch is down.
    pub result: Result<()>,
    host: *mut sys::dpt_host,
}

impl Felt<'_> {
    /// The nearest pair of the tool and all bodies.
    pub fn hit(&self) -> Result<Hit> {
        // SAFETY: the host is in a tick of this thread.
        unsafe { hit_of(self.host) }
    }

    /// What the tool feels, and why.
    pub fn force_info(&self) -> Result<ForceInfo> {
        // SAFETY: as above.
        unsafe { force_info_of(self.host) }
    }
}

type FeltFunction = dyn FnMut(&Felt<'_>) + Send;

/// What C calls back to.
struct Calls {
    felt: Box<FeltFunction>,
    panic: Option<Box<dyn Any + Send>>,
}

struct OwnBody {
    mesh: Mesh<'static>,
    pose: Pose,
    settings: Option<BodySettings>,
    body: HostBody,
}

/// What is felt with a device, and how: a scene by its name or path, or bodies of your own.
#[derive(Default)]
pub struct HostOptions {
    def: HostDef,
    texts: [Option<CString>; 6],
    tips: Vec<CString>,
    info: Option<DeviceInfo>,
    bodies: Vec<OwnBody>,
    segments: Vec<Segment>,
    felt: Option<Box<FeltFunction>>,
    refused: Option<Error>,
}

macro_rules! texts {
    ($($(#[$text:meta])* $name:ident $at:literal),*) => {
        $($(#[$text])*
        #[must_use]
        pub fn $name(mut self, $name: impl AsRef<Path>) -> Self {
            match path_of($name.as_ref()) {
                Ok(text) => self.texts[$at] = Some(text),
                Err(error) => self.refused = Some(error),
            }
            self
        })*
    };
}

impl HostOptions {
    /// With the defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Settings: all fields but pointers, which have methods here.
    #[must_use]
    pub fn def(mut self, def: HostDef) -> Self {
        self.def = def;
        self
    }

    texts! {
        /// A name of [`Host::scenes`], or the path of a scene file, of a compiled mesh or arm.
        scene 0,
        /// The device by its name, such as `serial:/dev/ttyACM0`.
        device 1,
        /// Path of a compiled arm, whose tool is used.
        tool 2,
        /// Path of the device's dynamics.
        identified 3,
        /// Path of a recording of all ticks.
        record 4,
        /// How the tool's jaws move, as `dynpoint run --jaw` takes it.
        jaw 5
    }

    /// A tip of the tool, as `dynpoint run --tip` takes it.
    #[must_use]
    pub fn tip(mut self, tip: &str) -> Self {
        match CString::new(tip) {
            Ok(tip) => self.tips.push(tip),
            Err(_) => self.refused = Some(Error::ARGUMENT),
        }
        self
    }

    /// The device of a loop of your own, which calls [`Host::tick`].
    #[must_use]
    pub fn info(mut self, info: DeviceInfo) -> Self {
        self.info = Some(info);
        self
    }

    /// A body of your own instead of a scene.
    #[must_use]
    pub fn body(mut self, mesh: &Mesh<'static>, pose: Pose, settings: Option<BodySettings>, body: HostBody) -> Self {
        self.bodies.push(OwnBody { mesh: mesh.clone(), pose, settings, body });
        self
    }

    /// A segment of the tool, in its frame, instead of the scene's own.
    #[must_use]
    pub fn segment(mut self, segment: Segment) -> Self {
        self.segments.push(segment);
        self
    }

    /// A function that is called after each tick. It must not wait. Where it panics the run ends, and the panic comes
    /// out of it.
    #[must_use]
    pub fn felt(mut self, felt: impl FnMut(&Felt<'_>) + Send + 'static) -> Self {
        self.felt = Some(Box::new(felt));
        self
    }

    /// Open the scene and its device.
    pub fn open(self) -> Result<Host, HostError> {
        if let Some(error) = self.refused {
            return Err(error.into());
        }
        let mut def = self.def;
        let text = |at: usize| self.texts[at].as_ref().map_or(null(), |text| text.as_ptr());
        (def.scene, def.device, def.tool) = (text(0), text(1), text(2));
        (def.identified, def.record, def.jaw) = (text(3), text(4), text(5));
        let mut tips: Vec<*const c_char> = self.tips.iter().map(|tip| tip.as_ptr()).collect();
        tips.push(null());
        def.tips = if self.tips.is_empty() { null() } else { tips.as_ptr() };
        def.info = self.info.as_ref().map_or(null(), DeviceInfo::raw);
        let bodies: Vec<HostBody> = self.bodies.iter().map(|own| own.raw()).collect();
        def.bodies = first_of(&bodies).cast();
        def.body_count = count_of(bodies.len())?;
        def.segments = first_of(&self.segments).cast();
        def.segment_count = count_of(self.segments.len())?;
        let calls = self.felt.map(|felt| NonNull::from(Box::leak(Box::new(Calls { felt, panic: None }))));
        if let Some(calls) = calls {
            def.felt = Some(felt);
            def.user = calls.as_ptr().cast();
        }
        let (mut raw, mut said) = (null_mut(), Said::new());
        // SAFETY: all of it is there for the call, and what stays longer the host has.
        let result = unsafe { sys::dpt_host_open(def.raw(), &mut raw, &mut said.0) };
        let raw = NonNull::new(raw);
        // Whatever has come of it, the host frees what C called back to.
        let host = Host {
            raw,
            note: said.text(),
            calls,
            meshes: self.bodies.into_iter().map(|own| own.mesh).collect(),
            stop: Arc::new(Mutex::new(raw.map(Stoppable))),
        };
        said.check(result)?;
        Ok(host)
    }
}

impl OwnBody {
    /// With addresses of what is in `self`.
    fn raw(&self) -> HostBody {
        let mut body = self.body;
        body.mesh = self.mesh.as_raw();
        body.pose = self.pose.raw();
        body.settings = self.settings.as_ref().map_or(null(), BodySettings::raw);
        body
    }
}

struct Stoppable(NonNull<sys::dpt_host>);

// SAFETY: a host may be stopped from any thread (host.h); the lock keeps it from being closed meanwhile.
unsafe impl Send for Stoppable {}

/// It ends a run, from any thread.
#[derive(Clone)]
pub struct HostStopper(Arc<Mutex<Option<Stoppable>>>);

impl HostStopper {
    /// End the present run, or the next one if none is running. Nothing, once the host is closed.
    pub fn stop(&self) {
        if let Some(host) = &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            // SAFETY: it is open as long as the lock is held.
            unsafe { sys::dpt_host_stop(host.0.as_ptr()) };
        }
    }
}

/// A scene that is felt with a device, and safely so: coupling, passivity and guard. It belongs to one thread at a time.
///
/// ```
/// use dynpoint::{Host, HostDef, HostOptions};
///
/// # fn main() -> Result<(), dynpoint::HostError> {
/// let def = HostDef::default().ticks(500);
/// let mut host = HostOptions::new().scene("liver").device("sim:?hand=press").def(def).open()?;
/// let stats = host.run()?;
/// println!("{} ticks, at most {} N", stats.ticks, host.info()?.force_max);
/// # Ok(())
/// # }
/// ```
pub struct Host {
    raw: Option<NonNull<sys::dpt_host>>,
    note: String,
    calls: Option<NonNull<Calls>>,
    meshes: Vec<Mesh<'static>>,
    stop: Arc<Mutex<Option<Stoppable>>>,
}

// SAFETY: a host belongs to one thread at a time, whichever that is (host.h); its function may be sent.
unsafe impl Send for Host {}

impl Host {
    /// The names of scenes that the library makes itself.
    pub fn scenes() -> impl Iterator<Item = &'static str> {
        // SAFETY: any number is allowed, and the text is a constant.
        (0..)
            .map(|index| unsafe { text::of_constant(sys::dpt_host_get_scene(index)) })
            .take_while(|name| !name.is_empty())
    }

    /// What a person should know of a scene that opened; or nothing.
    pub fn note(&self) -> &str {
        &self.note
    }

    /// The host, for calls of [`crate::sys`]. It must not be closed by them.
    pub fn as_raw(&self) -> *mut sys::dpt_host {
        self.raw.map_or(null_mut(), NonNull::as_ptr)
    }

    /// How to end a run.
    pub fn stopper(&self) -> HostStopper {
        HostStopper(self.stop.clone())
    }

    /// Serve the device in this thread: until it is stopped, after the def's ticks, or when the device is lost.
    pub fn run(&mut self) -> Result<LoopStats, HostError> {
        let (mut stats, mut said) = (LoopStats::empty(), Said::new());
        // SAFETY: the host is open.
        let result = unsafe { sys::dpt_host_run(self.as_raw(), stats.raw_mut(), &mut said.0) };
        self.pass_panic_on();
        said.check(result)?;
        Ok(stats)
    }

    /// One tick of a loop of your own, of a host without a device. The wrench is to be sent in any case.
    pub fn tick(&mut self, state: &DeviceState, now_ns: u64) -> (Wrench, Result<()>) {
        let mut wrench = Wrench::empty();
        // SAFETY: as above.
        let result = unsafe { sys::dpt_host_tick(self.as_raw(), state.raw(), now_ns, wrench.raw_mut()) };
        self.pass_panic_on();
        (wrench, check(result))
    }

    /// What is so now, and what has happened since it was opened.
    pub fn info(&self) -> Result<HostInfo> {
        let mut info = HostInfo::empty();
        // SAFETY: the info has its size.
        check(unsafe { sys::dpt_host_get_info(self.as_raw(), info.raw_mut()) })?;
        Ok(info)
    }

    /// The nearest pair of the tool and all bodies.
    pub fn hit(&self) -> Result<Hit> {
        // SAFETY: the host is this thread's.
        unsafe { hit_of(self.as_raw()) }
    }

    /// What the tool feels, and why.
    pub fn force_info(&self) -> Result<ForceInfo> {
        // SAFETY: as above.
        unsafe { force_info_of(self.as_raw()) }
    }

    /// Meshes of bodies of your own.
    pub fn meshes(&self) -> &[Mesh<'static>] {
        &self.meshes
    }

    /// Close it, and tell what of a recording could not be written; dropping it closes it too.
    pub fn close(mut self) -> Result<String, HostError> {
        let mut said = Said::new();
        let result = self.end(&mut said.0);
        said.check(result)?;
        Ok(said.text())
    }

    fn end(&mut self, said: *mut sys::dpt_host_error) -> sys::dpt_result {
        *self.stop.lock().unwrap_or_else(PoisonError::into_inner) = None;
        // SAFETY: it does not run, and nobody stops it any more; NULL is allowed.
        unsafe { sys::dpt_host_close(self.raw.take().map_or(null_mut(), NonNull::as_ptr), said) }
    }

    fn pass_panic_on(&mut self) {
        // SAFETY: C has returned, so that nobody else has a reference.
        if let Some(panic) = self.calls.and_then(|mut calls| unsafe { calls.as_mut() }.panic.take()) {
            resume_unwind(panic);
        }
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        self.end(null_mut());
        if let Some(calls) = self.calls {
            // SAFETY: it is of a box, and the host is closed.
            drop(unsafe { Box::from_raw(calls.as_ptr()) });
        }
    }
}

impl std::fmt::Debug for Host {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(to, "Host at {:?}", self.raw)
    }
}

/// # Safety
/// The host is open, and this thread's.
unsafe fn hit_of(host: *mut sys::dpt_host) -> Result<Hit> {
    let mut hit = Hit::empty();
    // SAFETY: as above.
    check(unsafe {
        sys::dpt_tool_get_hit(sys::dpt_host_get_world(host), sys::dpt_host_get_tool(host), hit.raw_mut())
    })?;
    Ok(hit)
}

/// # Safety
/// As above.
unsafe fn force_info_of(host: *mut sys::dpt_host) -> Result<ForceInfo> {
    let mut info = ForceInfo::empty();
    // SAFETY: as above.
    check(unsafe {
        sys::dpt_tool_get_force_info(sys::dpt_host_get_world(host), sys::dpt_host_get_tool(host), info.raw_mut())
    })?;
    Ok(info)
}

/// What C calls back to: a panic stops the host, and waits until C has returned.
///
/// # Safety
/// `user` is of calls that are there, and the rest of C's own for the call.
unsafe extern "C" fn felt(
    user: *mut c_void,
    host: *mut sys::dpt_host,
    sample: *const sys::dpt_loop_sample,
    result: sys::dpt_result,
    wrench: *const sys::dpt_wrench,
) {
    // SAFETY: as above; a state of an older library is shorter.
    let (calls, told, dt, wrench) =
        unsafe { (&mut *user.cast::<Calls>(), (*sample).state, (*sample).dt, *wrench.cast::<Wrench>()) };
    if calls.panic.is_some() {
        return;
    }
    let mut state = DeviceState::empty();
    let mine = state.size;
    // SAFETY: as above.
    unsafe {
        let bytes = ((*told).size.min(mine)) as usize;
        std::ptr::copy_nonoverlapping(told.cast::<u8>(), state.raw_mut().cast::<u8>(), bytes);
    }
    state.size = mine;
    let tick = Felt { state: &state, dt, wrench, result: check(result), host };
    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| (calls.felt)(&tick))) {
        calls.panic = Some(panic);
        // SAFETY: the host is open.
        unsafe { sys::dpt_host_stop(host) };
    }
}
