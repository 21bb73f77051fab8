//! Laws that every emitter obeys, and irradiance against closed forms.
//!
//! Each light has a file with its cases; [`laws`] says what must hold for all of them.

mod random;
mod select;
