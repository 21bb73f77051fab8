//! Laws that every emitter obeys, and irradiance against closed forms.
//!
//! Each light has a file with its cases; [`laws`] says what must hold for all of them.

mod authored;
#[path = "../support/chi2.rs"]
mod chi2;
mod cylinder;
mod disk;
mod distant;
mod dome;
mod extremes;
mod laws;
mod mesh;
mod plane;
mod point;
mod profile;
mod quadrature;
mod random;
mod rect;
mod rounds;
#[path = "../support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;
mod select;
mod sphere;
mod sun;
