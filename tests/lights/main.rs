//! Laws that every emitter obeys, and irradiance against closed forms.
//!
//! Each light has a file with its cases; [`laws`] says what must hold for all of them.

#[path = "../support/chi2.rs"]
mod chi2;
mod cylinder;
mod disk;
mod distant;
mod dome;
mod laws;
mod mesh;
mod plane;
mod point;
mod profile;
mod quadrature;
mod random;
mod rect;
mod select;
mod sphere;
mod sun;
