//! Time.

/// CPU seconds of this thread.
pub fn thread_seconds() -> f64 {
    seconds(3)
}

/// CPU seconds of all threads of this process, since its start.
pub fn process_seconds() -> f64 {
    seconds(2)
}

/// Seconds by one of POSIX's clocks, as Linux numbers them.
#[cfg(target_os = "linux")]
fn seconds(clock: i32) -> f64 {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanoseconds: std::ffi::c_long,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
    }
    let mut time = Timespec { seconds: 0, nanoseconds: 0 };
    // SAFETY: the call fills in the struct.
    unsafe { clock_gettime(clock, &mut time) };
    time.seconds as f64 + 1e-9 * time.nanoseconds as f64
}

/// Seconds of the wall, where those clocks are not at hand.
#[cfg(not(target_os = "linux"))]
fn seconds(_clock: i32) -> f64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
