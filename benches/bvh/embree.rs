//! Embree 4 through its C interface, loaded at run time from wherever it is installed.

use std::ffi::{c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicIsize, Ordering};

use libloading::{Library, Symbol};
use penumbra::math::Ray;

use super::meshes::{Mesh, Scene};

type Handle = *mut c_void;

const TRIANGLE: c_int = 0;
const INSTANCE: c_int = 121;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;
const FLOAT3X4_COLUMNS: c_int = 0x9234;

/// `RTCRayHit`; longer than any build of the library has it.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instances: [u32; 16],
}

/// A loaded library with its calls for the hot loop.
pub struct Embree {
    /// Never unloaded, for its worker threads may outlive the last scene.
    library: ManuallyDrop<Library>,
    intersect: unsafe extern "C" fn(Handle, *mut RayHit, *const c_void),
    occluded: unsafe extern "C" fn(Handle, *mut RayHit, *const c_void),
}

/// A committed scene.
pub struct EmbreeScene {
    embree: Arc<Embree>,
    device: Handle,
    scene: Handle,
    parts: Vec<Handle>,
    bytes: Arc<AtomicIsize>,
}

/// The library: at `path` if given, else where `PENUMBRA_EMBREE` says, else inside the `bpy`
/// package of a Python at hand.
pub fn find(path: Option<PathBuf>) -> Option<PathBuf> {
    let named = path.or_else(|| std::env::var_os("PENUMBRA_EMBREE").map(PathBuf::from));
    if named.is_some() {
        return named;
    }
    let ask = "import importlib.util as u; print(u.find_spec('bpy').submodule_search_locations[0])";
    [".venv/bin/python", "python3"].iter().find_map(|python| {
        let output = Command::new(python).args(["-c", ask]).output().ok().filter(|o| o.status.success())?;
        let package = PathBuf::from(String::from_utf8(output.stdout).ok()?.trim());
        [package.join("lib"), package].iter().find_map(|folder| library_in(folder))
    })
}

fn library_in(folder: &Path) -> Option<PathBuf> {
    let mut files: Vec<_> = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.sort();
    files.into_iter().find(|f| f.file_name().is_some_and(|n| n.to_string_lossy().starts_with("libembree4.so")))
}

impl Embree {
    /// Loads the library.
    pub fn load(path: &Path) -> Result<Arc<Self>, libloading::Error> {
        // SAFETY: Embree's own initializers; the signatures are those of embree4/rtcore.h.
        unsafe {
            let library = Library::new(path)?;
            let intersect = *library.get(b"rtcIntersect1\0")?;
            let occluded = *library.get(b"rtcOccluded1\0")?;
            Ok(Arc::new(Self { library: ManuallyDrop::new(library), intersect, occluded }))
        }
    }

    /// A function of the library.
    fn get<F>(&self, name: &str) -> Symbol<'_, F> {
        // SAFETY: callers name the type that embree4/rtcore.h declares.
        unsafe { self.library.get(name.as_bytes()) }.unwrap_or_else(|e| panic!("Embree lacks {name}: {e}"))
    }

    /// Builds `scene` with `threads` threads. The meshes must outlive the result.
    pub fn build(self: &Arc<Self>, scene: &Scene, threads: usize, robust: bool) -> EmbreeScene {
        let bytes = Arc::new(AtomicIsize::new(0));
        // SAFETY: signatures as in embree4/rtcore.h; the buffers stay in place while in use.
        unsafe {
            let config = std::ffi::CString::new(format!("threads={threads}")).expect("no NUL");
            let device = self.get::<unsafe extern "C" fn(*const c_char) -> Handle>("rtcNewDevice")(config.as_ptr());
            self.get::<unsafe extern "C" fn(Handle, unsafe extern "C" fn(*mut c_void, isize, bool) -> bool, *mut c_void)>(
                "rtcSetDeviceMemoryMonitorFunction",
            )(device, count_bytes, Arc::as_ptr(&bytes).cast_mut().cast());
            let mut built =
                EmbreeScene { embree: self.clone(), device, scene: std::ptr::null_mut(), parts: Vec::new(), bytes };
            built.parts = scene.meshes.iter().map(|mesh| built.mesh(mesh, robust)).collect();
            let alone = scene.instances.len() == 1 && scene.instances[0].1 == penumbra::math::Affine3A::IDENTITY;
            if alone {
                built.scene = built.parts.remove(0);
                return built;
            }
            built.scene = built.new_scene(robust);
            for (mesh, transform) in &scene.instances {
                let geometry =
                    self.get::<unsafe extern "C" fn(Handle, c_int) -> Handle>("rtcNewGeometry")(device, INSTANCE);
                self.get::<unsafe extern "C" fn(Handle, Handle)>("rtcSetGeometryInstancedScene")(
                    geometry,
                    built.parts[*mesh as usize],
                );
                let columns = transform.to_cols_array();
                self.get::<unsafe extern "C" fn(Handle, u32, c_int, *const f32)>("rtcSetGeometryTransform")(
                    geometry,
                    0,
                    FLOAT3X4_COLUMNS,
                    columns.as_ptr(),
                );
                built.attach(built.scene, geometry);
            }
            self.get::<unsafe extern "C" fn(Handle)>("rtcCommitScene")(built.scene);
            built
        }
    }
}

unsafe extern "C" fn count_bytes(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: the counter outlives the device.
    unsafe { &*user.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::Relaxed);
    true
}

impl EmbreeScene {
    unsafe fn new_scene(&self, robust: bool) -> Handle {
        unsafe {
            let scene = self.embree.get::<unsafe extern "C" fn(Handle) -> Handle>("rtcNewScene")(self.device);
            if robust {
                self.embree.get::<unsafe extern "C" fn(Handle, c_int)>("rtcSetSceneFlags")(scene, 4);
            }
            scene
        }
    }

    unsafe fn attach(&self, scene: Handle, geometry: Handle) {
        unsafe {
            self.embree.get::<unsafe extern "C" fn(Handle)>("rtcCommitGeometry")(geometry);
            self.embree.get::<unsafe extern "C" fn(Handle, Handle) -> u32>("rtcAttachGeometry")(scene, geometry);
            self.embree.get::<unsafe extern "C" fn(Handle)>("rtcReleaseGeometry")(geometry);
        }
    }

    unsafe fn mesh(&self, mesh: &Mesh, robust: bool) -> Handle {
        type SetBuffer = unsafe extern "C" fn(Handle, c_int, u32, c_int, *const c_void, usize, usize, usize);
        unsafe {
            let geometry = self.embree.get::<unsafe extern "C" fn(Handle, c_int) -> Handle>("rtcNewGeometry")(
                self.device,
                TRIANGLE,
            );
            let set = self.embree.get::<SetBuffer>("rtcSetSharedGeometryBuffer");
            let (points, triangles) = (&mesh.points, &mesh.triangles);
            set(geometry, BUFFER_VERTEX, 0, FLOAT3, points.as_ptr().cast(), 0, 12, points.len());
            set(geometry, BUFFER_INDEX, 0, UINT3, triangles.as_ptr().cast(), 0, 12, triangles.len());
            let scene = self.new_scene(robust);
            self.attach(scene, geometry);
            self.embree.get::<unsafe extern "C" fn(Handle)>("rtcCommitScene")(scene);
            scene
        }
    }

    /// Memory that Embree reports.
    pub fn bytes(&self) -> usize {
        self.bytes.load(Ordering::Relaxed).max(0) as usize
    }

    fn ray(ray: &Ray) -> RayHit {
        RayHit {
            origin: ray.o.to_array(),
            t_near: 0.0,
            direction: ray.d.to_array(),
            time: 0.0,
            t_far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: u32::MAX,
            geometry: u32::MAX,
            instances: [u32::MAX; 16],
        }
    }

    /// Distance of the nearest hit.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<f32> {
        let mut query = Self::ray(ray);
        // SAFETY: a committed scene and a ray of the right layout.
        unsafe { (self.embree.intersect)(self.scene, &mut query, std::ptr::null()) };
        (query.geometry != u32::MAX).then_some(query.t_far)
    }

    /// Whether anything is hit.
    #[inline]
    pub fn any(&self, ray: &Ray) -> bool {
        let mut query = Self::ray(ray);
        // SAFETY: as above; only the part that is the ray is touched.
        unsafe { (self.embree.occluded)(self.scene, &mut query, std::ptr::null()) };
        query.t_far < 0.0
    }
}

impl Drop for EmbreeScene {
    fn drop(&mut self) {
        let release = |name: &str, handle: Handle| {
            // SAFETY: each handle is released once.
            unsafe { self.embree.get::<unsafe extern "C" fn(Handle)>(name)(handle) };
        };
        release("rtcReleaseScene", self.scene);
        self.parts.iter().for_each(|&part| release("rtcReleaseScene", part));
        release("rtcReleaseDevice", self.device);
    }
}
