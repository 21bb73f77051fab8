//! The command line: `penumbra render SCENE -o OUT.exr`.

mod cli;

/// Composing a USD stage is millions of small allocations; so is a large glTF document.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    cli::run()
}
