//! The Python door: scenes and buffers in, pictures out, the interpreter free while rays are traced.
//!
//! `penumbra._engine` holds what is here; the package around it (`src/python/penumbra`) adds names and
//! type stubs. One abi3 module serves CPython 3.11 and later, Blender's included. No panic leaves it:
//! PyO3 turns one into an exception, and the render's own thread is joined for its.

// What PyO3's macros expand to.
#![allow(unsafe_code)]

mod job;
mod observer;
mod picture;
mod render;
mod scene;
mod tables;
mod viewport;

use pyo3::prelude::*;

/// The engine.
#[pymodule]
mod _engine {
    #[pymodule_export]
    use super::picture::Picture;
    #[pymodule_export]
    use super::render::render;
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::tables::{passes, settings};
    #[pymodule_export]
    use super::viewport::Viewport;

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

/// The exception for `error`: the class that Python has for it, with the message and its causes.
fn exception(error: &penumbra::error::Error) -> PyErr {
    use penumbra::error::Error;
    use pyo3::exceptions::{PyKeyboardInterrupt, PyNotImplementedError, PyOSError, PyValueError};
    let mut message = error.to_string();
    let mut cause = std::error::Error::source(error);
    while let Some(error) = cause {
        message.push_str(&format!(": {error}"));
        cause = error.source();
    }
    match error {
        Error::Unsupported { .. } => PyNotImplementedError::new_err(message),
        Error::Invalid { .. } => PyValueError::new_err(message),
        Error::Io { .. } => PyOSError::new_err(message),
        Error::Cancelled => PyKeyboardInterrupt::new_err(message),
    }
}
