//! What the author of a renderer would fear, each with an answer in closed form or in `f64`.
//!
//! A file for each kind of trouble; [`row`] says what must hold for every row: the answer, from wherever in the world
//! the scene stands, and the same bits on any number of threads and on any instruction set. What was found is left under
//! `hard-cases/` in Cargo's folder for tests, from which `tests/cycles/hard_cases.py` writes docs/hard-cases.md; a row
//! that the page lacks fails, as does one of the page that is not here any more.

mod camera;
mod geometry;
#[path = "../support/glb.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod glb;
mod invariance;
mod light;
mod material;
mod numbers;
mod page;
mod random;
mod row;
#[path = "../support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;
mod truth;
