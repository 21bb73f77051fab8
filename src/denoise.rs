//! Intel Open Image Denoise, where it is installed: a library that is opened at run time, and never needed.
//!
//! What it makes of a picture is a guess at what the picture tends to, from one render; it goes beside the picture,
//! never in its place. Albedo and normals are denoised by themselves first, so that their noise leaves no mark
//! (`cleanAux` of its documentation, <https://www.openimagedenoise.org/documentation.html>).
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};

use libloading::Library;

/// Names of the library, of version 2, the first that opens.
const NAMES: &[&str] = &[
    "libOpenImageDenoise.so.2",
    "libOpenImageDenoise.so",
    "libOpenImageDenoise.2.dylib",
    "libOpenImageDenoise.dylib",
    "OpenImageDenoise.dll",
];

/// Environment variable with the path of the library.
pub const PATH_VARIABLE: &str = "PENUMBRA_OIDN";

/// `OIDN_DEVICE_TYPE_CPU`: the same bits wherever it runs.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;

type Device = *mut c_void;
type Filter = *mut c_void;

/// The functions that are used, as the library's header declares them.
#[derive(Clone, Copy)]
struct Functions {
    new_device: unsafe extern "C" fn(c_int) -> Device,
    set_device_int: unsafe extern "C" fn(Device, *const c_char, c_int),
    commit_device: unsafe extern "C" fn(Device),
    device_error: unsafe extern "C" fn(Device, *mut *const c_char) -> c_int,
    release_device: unsafe extern "C" fn(Device),
    new_filter: unsafe extern "C" fn(Device, *const c_char) -> Filter,
    set_image: unsafe extern "C" fn(Filter, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize),
    set_bool: unsafe extern "C" fn(Filter, *const c_char, bool),
    commit_filter: unsafe extern "C" fn(Filter),
    execute_filter: unsafe extern "C" fn(Filter),
    release_filter: unsafe extern "C" fn(Filter),
}

/// The library.
pub struct Denoiser {
    functions: Functions,
    /// What the functions are of.
    _library: Library,
}

/// Planes of three floats per pixel, rows from the top.
pub struct Noisy<'a> {
    /// Pixels per row.
    pub width: usize,
    /// Scene-linear radiance.
    pub color: &'a [f32],
    /// Albedo of what is seen, 0 to 1.
    pub albedo: &'a [f32],
    /// Normals of it, in any space.
    pub normal: &'a [f32],
}

impl Denoiser {
    /// Opens the library: the one that [`PATH_VARIABLE`] names, else the system's.
    ///
    /// # Errors
    /// A sentence that says what was looked for.
    pub fn open() -> Result<Self, String> {
        let named = std::env::var_os(PATH_VARIABLE).map(|path| path.to_string_lossy().into_owned());
        let names: Vec<&str> = named.as_deref().map_or_else(|| NAMES.to_vec(), |name| vec![name]);
        let missing = || {
            let what = named.as_deref().unwrap_or(NAMES[0]);
            format!("Open Image Denoise 2 is not there ({what}; {PATH_VARIABLE} names another place)")
        };
        // SAFETY: opening a library runs what it does at its start; this one is known to do nothing else.
        let library = names.iter().find_map(|name| unsafe { Library::new(*name) }.ok()).ok_or_else(missing)?;
        macro_rules! function {
            ($name:literal) => {
                // SAFETY: the types are those of the header of version 2, whose functions kept theirs since 2.0.
                *unsafe { library.get($name) }.map_err(|_| missing())?
            };
        }
        let functions = Functions {
            new_device: function!(b"oidnNewDevice\0"),
            set_device_int: function!(b"oidnSetDeviceInt\0"),
            commit_device: function!(b"oidnCommitDevice\0"),
            device_error: function!(b"oidnGetDeviceError\0"),
            release_device: function!(b"oidnReleaseDevice\0"),
            new_filter: function!(b"oidnNewFilter\0"),
            set_image: function!(b"oidnSetSharedFilterImage\0"),
            set_bool: function!(b"oidnSetFilterBool\0"),
            commit_filter: function!(b"oidnCommitFilter\0"),
            execute_filter: function!(b"oidnExecuteFilter\0"),
            release_filter: function!(b"oidnReleaseFilter\0"),
        };
        Ok(Self { functions, _library: library })
    }

    /// Radiance without noise, as far as it can be told; on so many threads, 0 for all.
    ///
    /// # Errors
    /// What the library complains of.
    ///
    /// # Panics
    /// Where the planes are not of one size.
    pub fn denoised(&self, noisy: &Noisy<'_>, threads: u32) -> Result<Vec<f32>, String> {
        let Noisy { width, color, albedo, normal } = *noisy;
        assert!(color.len() == albedo.len() && color.len() == normal.len() && color.len().is_multiple_of(3 * width));
        let device = OpenDevice::new(self.functions, threads)?;
        let albedo = device.run(width, &[("albedo", albedo)], &[])?;
        let normal = device.run(width, &[("normal", normal)], &[])?;
        device.run(width, &[("color", color), ("albedo", &albedo), ("normal", &normal)], &["hdr", "cleanAux"])
    }
}

/// A device, released at the end.
struct OpenDevice {
    functions: Functions,
    device: Device,
}

impl Drop for OpenDevice {
    fn drop(&mut self) {
        // SAFETY: made by `new_device`, released once.
        unsafe { (self.functions.release_device)(self.device) };
    }
}

impl OpenDevice {
    fn new(functions: Functions, threads: u32) -> Result<Self, String> {
        // SAFETY: a device type of the header; null is an error.
        let device = unsafe { (functions.new_device)(CPU) };
        if device.is_null() {
            return Err("Open Image Denoise can't use this processor".to_owned());
        }
        let device = Self { functions, device };
        // SAFETY: the device is live, the name ends in 0.
        unsafe {
            (functions.set_device_int)(device.device, c"numThreads".as_ptr(), c_int::try_from(threads).unwrap_or(0));
            (functions.commit_device)(device.device);
        }
        device.complaint().map_or(Ok(device), Err)
    }

    fn complaint(&self) -> Option<String> {
        let mut message = std::ptr::null();
        // SAFETY: the device is live; the message is a string of the library that lasts until its next call.
        let code = unsafe { (self.functions.device_error)(self.device, &mut message) };
        (code != 0).then(|| {
            // SAFETY: as above; null is none.
            let text = if message.is_null() { c"no reason" } else { unsafe { CStr::from_ptr(message) } };
            format!("Open Image Denoise: {}", text.to_string_lossy())
        })
    }

    /// Runs the filter for path tracing on planes of these names, with these flags on.
    fn run(&self, width: usize, planes: &[(&str, &[f32])], flags: &[&str]) -> Result<Vec<f32>, String> {
        let f = self.functions;
        let length = planes[0].1.len();
        let height = length / (3 * width);
        let mut output = vec![0.0_f32; length];
        let text = |name: &str| CString::new(name).unwrap_or_default();
        // SAFETY: filter and device are live until released. Every plane has `3 * width * height` floats (`denoised`
        // asserts it) and outlives the filter, which only reads those that are given as input; `output` is written by
        // the filter alone until it is released.
        unsafe {
            let filter = (f.new_filter)(self.device, c"RT".as_ptr());
            let image = |name: &str, at: *mut f32| {
                (f.set_image)(filter, text(name).as_ptr(), at.cast(), FLOAT3, width, height, 0, 0, 0);
            };
            for (name, plane) in planes {
                image(name, plane.as_ptr().cast_mut());
            }
            image("output", output.as_mut_ptr());
            for flag in flags {
                (f.set_bool)(filter, text(flag).as_ptr(), true);
            }
            (f.commit_filter)(filter);
            (f.execute_filter)(filter);
            (f.release_filter)(filter);
        }
        self.complaint().map_or(Ok(output), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only where the library is installed; tests/python has one and says where.
    #[test]
    fn noise_about_a_constant_goes_away() {
        let Ok(denoiser) = Denoiser::open() else { return };
        let (width, height) = (64, 48);
        let noise = |i: usize| ((i as u32).wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32 - 0.5;
        let n = 3 * width * height;
        let color: Vec<f32> = (0..n).map(|i| 0.5 + 0.4 * noise(i)).collect();
        let (albedo, normal) = (vec![0.5; n], vec![0.0; n]);
        let clean = denoiser.denoised(&Noisy { width, color: &color, albedo: &albedo, normal: &normal }, 1).unwrap();
        let spread = |values: &[f32]| values.iter().map(|v| (v - 0.5).powi(2)).sum::<f32>() / n as f32;
        assert!(spread(&clean) < 0.01 * spread(&color), "{} {}", spread(&clean), spread(&color));
    }
}
