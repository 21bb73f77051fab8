//! Reports for people and machines: tables for the terminal, JSON, pages that open from disk.

pub mod compare;
pub mod compare_page;
pub mod converge;
pub mod converge_page;
mod embed;
mod plot;
