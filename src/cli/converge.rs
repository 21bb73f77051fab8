//! `penumbra converge`: error against seconds, of one scene in many ways.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use penumbra::compare::pass_of;
use penumbra::converge::{Configuration, Kind, Measured, Reference, Task, configurations};
use penumbra::denoise::Denoiser;
use penumbra::desc::SceneDesc;
use penumbra::job;
use penumbra::output::exr;
use penumbra::output::report::converge::{self as report, Circumstances};
use penumbra::output::report::converge_page;
use penumbra::scene::{Cache, Prepared, View, prepare_with};
use penumbra::settings::{SETTINGS, Settings};

use super::{Outcome, environment, given, say, scene};

/// The picture's width where neither the user nor the file says one: enough to see, and cheap to render often.
const WIDTH: u32 = 256;

/// Samples of an own reference, over those of the ways.
const REFERENCE_FACTOR: u32 = 32;

pub fn command() -> Command {
    let list = |name: &'static str| Arg::new(name).long(name).value_delimiter(',');
    Command::new("converge")
        .about("Measure what accuracy costs: error against seconds of a scene in many ways")
        .args(scene::args())
        .args(given::view_args())
        .args(environment::args())
        .arg(
            Arg::new("reference")
                .long("reference")
                .value_name("R.exr")
                .value_parser(value_parser!(PathBuf))
                .help("What the picture should be, as Cycles' or a long render [default: rendered, from two seeds]"),
        )
        .arg(
            Arg::new("reference-spp")
                .long("reference-spp")
                .value_name("N")
                .value_parser(value_parser!(u32).range(1..))
                .conflicts_with("reference")
                .help(format!("Samples of the reference [default: {REFERENCE_FACTOR} times --spp]")),
        )
        .arg(Arg::new("pass").long("pass").value_name("NAME").default_value("combined").help("Pass to look at"))
        .arg(list("samplers").value_name("LIST|all").help("Samplers to try beside the one that is set"))
        .arg(
            Arg::new("try")
                .long("try")
                .value_name("NAME=VALUE[,...]")
                .action(ArgAction::Append)
                .help("A way more: settings as they are typed, as max-bounces=3,ao-samples=2; any number"),
        )
        .arg(list("only").value_name("LIST").help("Ways to measure, by the names in the table [default: all]"))
        .arg(
            Arg::new("seeds")
                .long("seeds")
                .value_name("N")
                .value_parser(value_parser!(u32).range(2..=64))
                .default_value("3")
                .help("Renders of each way, whose differences are the noise"),
        )
        .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print JSON"))
        .arg(
            Arg::new("html")
                .long("html")
                .value_name("DIR")
                .value_parser(value_parser!(PathBuf))
                .help("Write index.html (plot, table, pictures at equal time) and error.svg in this folder"),
        )
        .args(given::setting_args())
}

/// The scene, and what its renders have in common.
struct Bench<'a> {
    desc: SceneDesc,
    view: View,
    base: Settings,
    cache: Cache,
    args: &'a ArgMatches,
    layer: String,
    denoiser: Option<Denoiser>,
}

pub fn run(args: &ArgMatches) -> anyhow::Result<Outcome> {
    let mut base = given::settings(args, command);
    if base.error.is_some() || base.time.is_some() {
        bail!("--error and --time stop a render early: here samples grow up to --spp and both are measured");
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(base.threads as usize)
        .build_global()
        .with_context(|| format!("can't start {} threads", base.threads))?;
    let pass = args.get_one::<String>("pass").expect("has a default");
    let layer = pass_of(pass);
    add_pass(&mut base, pass)?;
    let (mut desc, mut warnings) = scene::load(args, args.get_one("frame").copied(), false)?;
    environment::apply(args, &mut desc)?;
    let view = job::view(args.get_one("camera").cloned(), args.get_one("size").copied(), &desc, &mut warnings);
    for warning in warnings.iter() {
        say::err(format!("{}: {warning}", if warning.is_note { "note" } else { "warning" }));
    }
    let denoiser = (layer == "Combined").then(Denoiser::open);
    let denoiser = match denoiser {
        Some(Err(what)) => {
            say::err(format!("note: nothing is denoised: {what}"));
            None
        }
        other => other.and_then(Result::ok),
    };
    let mut bench = Bench { desc, view, base, cache: Cache::new(), args, layer, denoiser };
    let ways = bench.ways()?;
    let mut prepared = bench.prepare(&bench.base.clone())?;
    if bench.view.size.is_none() {
        // As high as wide as the picture would have been.
        let [width, height] = prepared.whole.map(u64::from);
        let small = (u64::from(WIDTH) * height / width.max(1)).max(1);
        bench.view.size = Some([WIDTH, small as u32]);
        prepared = bench.prepare(&bench.base.clone())?;
    }
    let reference = bench.reference(&prepared)?;
    let all = bench.measure(&ways, &reference)?;
    let (scene, size) = (scene::path(args).display().to_string(), prepared.scene.size);
    let circumstances = Circumstances {
        scene: &scene,
        camera: &prepared.camera,
        layer: &bench.layer,
        size,
        seeds: args.get_one("seeds").copied().unwrap_or(2),
        threads: rayon::current_num_threads(),
        reference: &reference,
    };
    if args.get_flag("json") {
        say::out(format!("{:#}\n", report::json(&all, &circumstances)));
    } else {
        say::out(report::table(&all, &circumstances));
    }
    if let Some(folder) = args.get_one::<PathBuf>("html") {
        std::fs::create_dir_all(folder).with_context(|| format!("{}: the folder can't be made", folder.display()))?;
        converge_page::write(folder, &all, &circumstances)?;
        say::err(format!("{}: open it in a browser", folder.join("index.html").display()));
    }
    Ok(Outcome::Done)
}

/// Makes sure that `pass` is rendered.
fn add_pass(settings: &mut Settings, pass: &str) -> anyhow::Result<()> {
    let passes = settings.passes.to_string();
    if !passes.split(',').any(|own| own == pass) {
        set(settings, "passes", &format!("{passes},{pass}")).map_err(|what| anyhow!("--pass {pass}: {what}"))?;
    }
    Ok(())
}

fn set(settings: &mut Settings, name: &str, value: &str) -> Result<(), String> {
    let def = SETTINGS.iter().find(|def| def.name == name).ok_or_else(|| format!("there is no setting '{name}'"))?;
    def.set(settings, value)
}

impl Bench<'_> {
    /// What to measure: the base first.
    fn ways(&self) -> anyhow::Result<Vec<Configuration>> {
        let samplers: Vec<String> = self.args.get_many("samplers").into_iter().flatten().cloned().collect();
        for name in samplers.iter().filter(|name| *name != "all") {
            set(&mut self.base.clone(), "sampler", name).map_err(|what| anyhow!("--samplers {name}: {what}"))?;
        }
        let mut ways = configurations(&self.base, &samplers, &self.layer);
        if self.denoiser.is_some() {
            let passes = format!("{},denoising_albedo,denoising_normal", self.base.passes);
            let changes = vec![("passes".to_owned(), passes)];
            ways.push(Configuration { name: "denoised".to_owned(), kind: Kind::Denoised, changes });
        }
        for text in self.args.get_many::<String>("try").into_iter().flatten() {
            let change = |part: &str| {
                let (name, value) = part.split_once('=').ok_or_else(|| anyhow!("--try {text}: expected NAME=VALUE"))?;
                Ok((name.trim().replace('-', "_"), value.trim().to_owned()))
            };
            let changes = text.split(',').map(change).collect::<anyhow::Result<Vec<_>>>()?;
            ways.push(Configuration { name: text.clone(), kind: Kind::Way, changes });
        }
        if let Some(only) = self.args.get_many::<String>("only") {
            let only: Vec<&String> = only.collect();
            let names: Vec<&str> = ways.iter().map(|way| way.name.as_str()).collect();
            if let Some(unknown) = only.iter().find(|name| !names.contains(&name.as_str())) {
                bail!("--only {unknown}: not one of {}", names.join(", "));
            }
            ways.retain(|way| way.kind == Kind::Base || only.contains(&&way.name));
        }
        for way in &ways {
            way.apply(&self.base).map_err(|what| anyhow!("{}: {what}", way.name))?;
        }
        Ok(ways)
    }

    fn prepare(&mut self, settings: &Settings) -> anyhow::Result<Prepared> {
        Ok(prepare_with(self.desc.clone(), &self.view, settings, &mut self.cache)?)
    }

    /// The one that the user has, or two long renders of the base.
    fn reference(&mut self, prepared: &Prepared) -> anyhow::Result<Reference> {
        let size = prepared.scene.size;
        if let Some(path) = self.args.get_one::<PathBuf>("reference") {
            let picture = exr::read(Path::new(path))?;
            let reference =
                Reference::of(vec![picture], &self.layer, path.display().to_string()).map_err(|what| anyhow!(what))?;
            let [width, height] = size;
            if [reference.width, reference.height] != size {
                let (own_width, own_height) = (reference.width, reference.height);
                bail!("{}: {own_width}x{own_height} pixels, the picture has {width}x{height}", path.display());
            }
            return Ok(reference);
        }
        let spp = self.args.get_one("reference-spp").copied();
        let spp = spp.unwrap_or_else(|| self.base.spp.saturating_mul(REFERENCE_FACTOR)).div_ceil(2);
        say::err(format!("reference: two renders of {spp} samples"));
        let mut pictures = Vec::new();
        for seed in 0..2 {
            // Seeds of the ways follow that of the base; these are far from them.
            let seed = self.base.seed.wrapping_add(0x5eed_0000 + seed);
            let settings = Settings { spp, seed, adaptive: false, ..self.base.clone() };
            let scene = self.prepare(&settings)?.scene;
            pictures.push(penumbra::render::render(&scene, &settings, &())?.film.develop());
        }
        let origin = format!("two renders of its own, {spp} samples each");
        Reference::of(pictures, &self.layer, origin).map_err(|what| anyhow!(what))
    }

    fn measure(&mut self, ways: &[Configuration], reference: &Reference) -> anyhow::Result<Vec<Measured>> {
        let seeds = self.args.get_one("seeds").copied().unwrap_or(2);
        let (mut all, mut of_base) = (Vec::new(), Vec::new());
        for way in ways {
            say::err(format!("{} ...", way.name));
            let settings = way.apply(&self.base).map_err(|what| anyhow!("{}: {what}", way.name))?;
            let prepared = self.prepare(&settings)?;
            let layer = self.layer.clone();
            let task = Task { layer: &layer, reference, seeds, denoiser: self.denoiser.as_ref() };
            let (curve, first) = task.measure(&prepared.scene, &settings, way.kind == Kind::Denoised)?;
            if way.kind == Kind::Base {
                of_base.clone_from(&first);
            }
            let is_base = matches!(way.kind, Kind::Way | Kind::Without) && first == of_base;
            all.push(Measured { configuration: way.clone(), curve, is_base });
        }
        Ok(all)
    }
}
