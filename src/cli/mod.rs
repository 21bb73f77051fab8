//! The command line: parse, load, render, write, exit code. One file for each command.

mod compare;
mod converge;
mod costs;
mod environment;
mod files;
mod given;
mod info;
mod plan;
mod progress;
mod render;
mod resume;
mod say;
mod shots;

use std::process::ExitCode;

use clap::{ArgMatches, Command};

/// Exit code of a command that could not do what was asked.
const FAILED: u8 = 1;
/// Exit code of a render that was interrupted; what was computed is saved.
const INTERRUPTED: u8 = 130;

/// What became of a command that did not fail.
enum Outcome {
    Done,
    Interrupted,
}

/// Runs the program on the arguments of the process.
pub fn run() -> ExitCode {
    let matches = command().get_matches();
    let outcome = match matches.subcommand() {
        Some(("render", args)) => render::run(args),
        Some(("info", args)) => info::run(args),
        Some(("plan", args)) => plan::run(args),
        Some(("compare", args)) => compare::run(args),
        Some(("converge", args)) => converge::run(args),
        _ => unreachable!("clap requires one of the commands"),
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            say::err(format!("error: {error}"));
            for cause in error.chain().skip(1) {
                say::err(format!("  because: {cause}"));
            }
            ExitCode::from(FAILED)
        }
    }
}

fn command() -> Command {
    Command::new("penumbra")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Renders USD and glTF scenes to multi-layer EXR, with shadow and ambient occlusion passes")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(render::command())
        .subcommand(info::command())
        .subcommand(plan::command())
        .subcommand(compare::command())
        .subcommand(converge::command())
}

/// The arguments by which every command reads a scene.
mod scene {
    use std::path::{Path, PathBuf};

    use clap::{Arg, ArgAction, value_parser};

    use super::ArgMatches;
    use penumbra::desc::SceneDesc;
    use penumbra::error::{Result, Warnings};
    use penumbra::import::{self, ImportOptions, Interpolation, LightUnits, Purpose};

    pub fn args() -> [Arg; 6] {
        [
            Arg::new("scene")
                .value_name("SCENE")
                .required(true)
                .value_parser(value_parser!(PathBuf))
                .help("The scene: .usd, .usda, .usdc, .usdz, .gltf or .glb"),
            Arg::new("variant")
                .long("variant")
                .value_name("NAME|/Prim{set=choice}")
                .action(ArgAction::Append)
                .help("Variant to use instead of the file's own choice; of USD any number"),
            Arg::new("light-units")
                .long("light-units")
                .value_name("UNITS")
                .value_parser(["spec", "compat", "raw"])
                .default_value("spec")
                .help("How lamps of a glTF file are meant: candela and lux, or as Blender's exporter modes"),
            Arg::new("purpose")
                .long("purpose")
                .value_name("LIST")
                .value_delimiter(',')
                .value_parser(["render", "proxy", "guide"])
                .help(
                    "Purposes of USD prims to show beside those without one, as render,guide [default: those of the \
                     stage's render settings, else render]",
                ),
            Arg::new("interpolation")
                .long("interpolation")
                .value_name("TYPE")
                .value_parser(["linear", "held"])
                .default_value("linear")
                .help("What USD's time samples are between their times"),
            Arg::new("subdivision")
                .long("subdivision")
                .value_name("N")
                .value_parser(value_parser!(u32).range(0..=MOST_SUBDIVISION))
                .help(format!(
                    "How often USD's subdivision surfaces are refined [default: {}]",
                    ImportOptions::default().subdivision
                )),
        ]
    }

    /// Each level has four times the faces of that before.
    const MOST_SUBDIVISION: i64 = 8;

    fn purpose(name: &str) -> Purpose {
        match name {
            "proxy" => Purpose::Proxy,
            "guide" => Purpose::Guide,
            _ => Purpose::Render,
        }
    }

    /// A frame is a finite number.
    pub fn parse_frame(text: &str) -> std::result::Result<f64, String> {
        let frame: f64 = text.parse().map_err(|_| "must be a number".to_string())?;
        if frame.is_finite() { Ok(frame) } else { Err("must be finite".into()) }
    }

    pub fn path(args: &ArgMatches) -> &Path {
        args.get_one::<PathBuf>("scene").expect("required")
    }

    /// The scene at `frame`, with the warnings of its import; with `vectors` as [`ImportOptions`] says.
    pub fn load(args: &ArgMatches, frame: Option<f64>, vectors: bool) -> Result<(SceneDesc, Warnings)> {
        let light_units = match args.get_one::<String>("light-units").map(String::as_str) {
            Some("compat") => LightUnits::Compat,
            Some("raw") => LightUnits::Raw,
            _ => LightUnits::Spec,
        };
        let default = ImportOptions::default();
        let options = ImportOptions {
            frame,
            variants: args.get_many("variant").into_iter().flatten().cloned().collect(),
            light_units,
            purposes: args.get_many::<String>("purpose").map(|names| names.map(|name| purpose(name)).collect()),
            interpolation: match args.get_one::<String>("interpolation").map(String::as_str) {
                Some("held") => Interpolation::Held,
                _ => Interpolation::Linear,
            },
            subdivision: args.get_one("subdivision").copied().unwrap_or(default.subdivision),
            vectors,
            ..default
        };
        let mut warnings = Warnings::new();
        let scene = import::scene(path(args), &options, &mut warnings)?;
        Ok((scene, warnings))
    }
}
