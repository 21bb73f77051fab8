//! The command line: `penumbra render SCENE -o OUT.exr`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
