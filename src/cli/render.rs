//! `penumbra render`: a scene to a multi-layer EXR, with a PNG preview if asked for.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use penumbra::denoise::Denoiser;
use penumbra::desc::{ProductDesc, SceneDesc};
use penumbra::error::{Place, Warnings};
use penumbra::film::{Quantity, SampleId};
use penumbra::job;
use penumbra::output::{exr, png};
use penumbra::render::{Costs, Rendered};
use penumbra::scene::{Cache, Prepared, prepare_with};
use penumbra::settings::Settings;

use super::files::{Files, save};
use super::progress::{Reporter, catch_interrupts, clock, interrupted, rendering};
use super::resume::Begun;
use super::shots::{self, Shot};
use super::{Outcome, costs, environment, given, resume, say, scene};

pub fn command() -> Command {
    let path = |name: &'static str| Arg::new(name).long(name).value_parser(value_parser!(PathBuf));
    let command =
        Command::new("render")
            .about("Render a scene to a multi-layer EXR")
            .args(scene::args())
            .arg(
                path("output")
                    .short('o')
                    .value_name("OUT.exr")
                    .help("The EXR file to write; needed unless a USD stage names one"),
            )
            .arg(path("preview").value_name("OUT.png").help("Also write Combined as an sRGB PNG"))
            .args(given::view_args())
            .arg(
                Arg::new("frames")
                    .long("frames")
                    .value_name("A-B[xSTEP]")
                    .value_parser(parse_frames)
                    .allow_hyphen_values(true)
                    .conflicts_with("frame")
                    .help("Render several frames; #### in file names, or the end of the stem, becomes the number"),
            )
            .args(environment::args())
            .arg(
                Arg::new("progress")
                    .long("progress")
                    .value_name("KIND")
                    .value_parser(["bar", "json", "none"])
                    .default_value("bar")
                    .help("How progress is told on stderr; the bar only on a terminal"),
            )
            .args(resume::args())
            .arg(Arg::new("denoise").long("denoise").action(ArgAction::SetTrue).conflicts_with("debug-sample").help(
                "Also write the layer Denoised: Combined through Intel Open Image Denoise, which must be installed",
            ))
            .arg(costs::arg())
            .arg(Arg::new("strict").long("strict").action(ArgAction::SetTrue).help("Take warnings for errors"))
            .arg(
                Arg::new("debug-sample")
                    .long("debug-sample")
                    .value_name("X,Y,I")
                    .value_parser(parse_sample)
                    .help("Trace sample I of pixel (X, Y) alone and print what it gave; writes nothing"),
            );
    command.args(given::setting_args())
}

pub fn run(args: &ArgMatches) -> anyhow::Result<Outcome> {
    let settings = given::settings(args, command);
    let is_usd = scene::path(args).extension().is_some_and(|e| e.to_string_lossy().to_lowercase().starts_with("usd"));
    if !args.contains_id("output") && !args.contains_id("debug-sample") && !is_usd {
        let kind = clap::error::ErrorKind::MissingRequiredArgument;
        command().bin_name("penumbra render").error(kind, "-o OUT.exr is missing").exit();
    }
    // Import, trees and pyramids run on as many threads as the render.
    if let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(settings.threads as usize).build_global() {
        bail!("can't start {} threads: {error}", settings.threads);
    }
    let frames: Vec<Option<f64>> = match args.get_one::<Frames>("frames") {
        Some(frames) => frames.iter().map(Some).collect(),
        None => vec![args.get_one::<f64>("frame").copied()],
    };
    if args.get_flag("denoise") {
        // What is missing is said before hours of work.
        Denoiser::open().map_err(|what| anyhow!("--denoise: {what}"))?;
    }
    catch_interrupts();
    let mut told = Warnings::new();
    for frame in frames {
        if interrupted() {
            return Ok(Outcome::Interrupted);
        }
        if let Outcome::Interrupted = render_frame(args, &settings, frame, &mut told)? {
            return Ok(Outcome::Interrupted);
        }
    }
    Ok(Outcome::Done)
}

fn render_frame(
    args: &ArgMatches,
    settings: &Settings,
    frame: Option<f64>,
    told: &mut Warnings,
) -> anyhow::Result<Outcome> {
    let is_debug = args.contains_id("debug-sample");
    // A name that was typed is checked before anything is read.
    let typed = if args.contains_id("output") { Some(Files::of(args, frame, None)?) } else { None };
    let start = Instant::now();
    let (mut desc, mut warnings) = scene::load(args, frame, settings.passes.needs(Quantity::Vector))?;
    let import = start.elapsed();
    let shots = shots::of(args, frame, &desc, &mut warnings)?;
    let files = match typed {
        None if !is_debug => {
            let alone = || desc.render.product.as_deref().map(|name| (name, &desc.render.product_place));
            let first = shots[0].pictures.first().map(|(_, product)| (&*product.name, &product.place));
            Some(Files::of(args, frame, first.or_else(alone))?)
        }
        typed => typed.filter(|_| !is_debug),
    };
    environment::apply(args, &mut desc)?;
    let last = shots.len() - 1;
    let mut cache = if last > 0 { Cache::new() } else { Cache::default() };
    for (i, shot) in shots.iter().enumerate() {
        let mut desc = if i == last { std::mem::take(&mut desc) } else { desc.clone() };
        desc.render = shot.render(&desc.render);
        let files = if i == 0 { files.as_ref() } else { None };
        let job = Job { args, frame, shot, files, import };
        if let Outcome::Interrupted = job.render(desc, settings, &mut cache, warnings.clone(), told)? {
            if i < last {
                say::err(format!("not rendered: {}", names(&shots[i + 1..])));
            }
            return Ok(Outcome::Interrupted);
        }
    }
    Ok(Outcome::Done)
}

/// Where the pictures of `shots` would go.
fn names(shots: &[Shot]) -> String {
    let outs = shots.iter().flat_map(|shot| &shot.pictures).map(|(out, _)| out.display().to_string());
    outs.collect::<Vec<_>>().join(", ")
}

/// One render of a frame, and the pictures of it.
struct Job<'a> {
    args: &'a ArgMatches,
    frame: Option<f64>,
    shot: &'a Shot,
    /// Where the first picture and its preview go, of the first render of a frame.
    files: Option<&'a Files>,
    /// Time that reading the scene took.
    import: Duration,
}

impl Job<'_> {
    /// `warnings` are those of the import.
    fn render(
        &self,
        desc: SceneDesc,
        settings: &Settings,
        cache: &mut Cache,
        mut warnings: Warnings,
        told: &mut Warnings,
    ) -> anyhow::Result<Outcome> {
        let args = self.args;
        let typed = args.get_one::<String>("camera").cloned();
        let view = job::view(typed, args.get_one("size").copied(), &desc, &mut warnings);
        let mut settings = match args.value_source("passes") {
            Some(ValueSource::CommandLine) => settings.clone(),
            _ => job::with_own_passes(settings, &desc, &mut warnings),
        };
        if args.get_flag("denoise") {
            settings = job::denoise::with_passes(&settings).map_err(|what| anyhow!("--denoise: {what}"))?;
        }
        let settings = &settings;
        let mut outs = self.outs();
        let mut begun = None;
        if let (Some(out), false) = (outs.next(), args.contains_id("debug-sample")) {
            let preview = self.files.and_then(|files| files.preview.as_deref());
            let others: Vec<&Path> = outs.chain(preview).collect();
            let identity = job::identity(&desc, &view, settings);
            begun = Some((out, Begun::of(args, out, &others, identity, settings)?));
        }
        if let Some((out, what)) = begun.as_ref().and_then(|(out, begun)| Some((out, begun.done()?))) {
            say::err(format!("{}: {what}", out.display()));
            return Ok(Outcome::Done);
        }
        let mut prepared = prepare_with(desc, &view, settings, cache)?;
        warnings.extend(prepared.warnings.clone());
        tell(&warnings, told);
        if args.get_flag("strict") && warnings.faults() > 0 {
            bail!("--strict: {} warnings about {}", warnings.faults(), scene::path(args).display());
        }
        if let Some(&[x, y, index]) = args.get_one::<[u64; 3]>("debug-sample") {
            return debug_sample(&prepared.scene, settings, x, y, index);
        }
        let Some((out, mut begun)) = begun else { return Ok(Outcome::Done) };
        rendering(true);
        let kind = args.get_one::<String>("progress").expect("has a default");
        let reporter = Reporter::new(kind, out, self.frame);
        let rendered = begun.render(&prepared.scene, settings, &reporter);
        reporter.finish();
        let (rendered, before) = rendered?;
        let costs = match args.get_flag("costs") && !rendered.interrupted {
            true => Some(penumbra::render::costs(&mut prepared.scene, settings)?),
            false => None,
        };
        let done = Done { prepared: &prepared, rendered: &rendered, before, begun: &begun, reporter: &reporter, costs };
        self.write(out, &done, settings, &mut warnings)
    }

    /// Where its pictures go.
    fn outs(&self) -> impl Iterator<Item = &Path> {
        let typed = self.files.map(|files| files.out.as_path());
        let first = typed.or(self.shot.pictures.first().map(|(out, _)| out.as_path()));
        first.into_iter().chain(self.shot.pictures.iter().skip(1).map(|(out, _)| out.as_path()))
    }

    /// Writes the pictures of what was rendered and its state, and says so.
    fn write(
        &self,
        out: &Path,
        done: &Done<'_>,
        settings: &Settings,
        warnings: &mut Warnings,
    ) -> anyhow::Result<Outcome> {
        let Done { prepared, rendered, before, begun, reporter, costs } = done;
        let (args, scene, film) = (self.args, &prepared.scene, &rendered.film);
        let place = Place::file(scene::path(args));
        let bad = film.non_finite();
        let mut late = Vec::new();
        if let Some(SampleId { x, y, index }) = bad.first {
            let count = bad.count;
            late.push(format!(
                "{count} samples were not finite and left out; the first: --debug-sample {x},{y},{index}"
            ));
        }
        let short = job::shortfalls(rendered, settings);
        late.extend(short.iter().cloned());
        for what in late {
            say::err(format!("warning: {what}"));
            warnings.push(&place, what);
        }
        let name = scene::path(args).display().to_string();
        let mut metadata =
            job::metadata(name, self.frame, prepared, rendered, settings, begun.identity.clone(), warnings);
        metadata.times = job::times(self.import, prepared, rendered);
        let of_costs = costs.iter().flat_map(|costs| &costs.list);
        metadata.costs = of_costs.map(|cost| (cost.name.clone(), [cost.share, cost.error])).collect();
        let mut picture = film.develop();
        if args.get_flag("denoise") {
            let done = Denoiser::open().and_then(|it| job::denoise::add(&it, &mut picture, settings.threads));
            if let Err(what) = done {
                say::err(format!("warning: --denoise: {what}; the rest of the picture is written"));
            }
        }
        let is_part = prepared.whole != scene.size || prepared.corner != [0; 2];
        let window = is_part.then_some(exr::Window { corner: prepared.corner, whole: prepared.whole });
        let pixel_aspect = self.shot.framing.pixel_aspect as f32;
        let options = exr::Options { half: settings.half, window, pixel_aspect, ..exr::Options::default() };
        let part = |product: &ProductDesc| {
            let mut names = scene.passes.layers_of(&product.passes);
            names.insert(job::denoise::LAYER.to_owned());
            picture.part(&names)
        };
        let pictures = &self.shot.pictures;
        let saved = match pictures.first() {
            None => save(out, &picture, &metadata, &options)?,
            Some((_, product)) => save(out, &part(product), &metadata, &options)?,
        };
        for (out, product) in pictures.iter().skip(1) {
            save(out, &part(product), &metadata, &options)?;
        }
        if let Some(preview) = self.files.and_then(|files| files.preview.as_ref()) {
            let layer = picture.layer("Combined").or(picture.layers.first()).map_or("", |layer| &layer.name);
            png::write(preview, &picture, layer).context("the EXR is written, the preview is not")?;
        }
        let goes_on = begun.keep(rendered);
        reporter.written(&metadata);
        if args.get_flag("strict") && bad.count > 0 {
            bail!("--strict: {} samples were not finite; {} is written", bad.count, saved.display());
        }
        if let (true, Some(what)) = (args.get_flag("strict"), short.first()) {
            bail!("--strict: {what}; {} is written", saved.display());
        }
        let spp = job::samples_per_pixel(film);
        if rendered.interrupted {
            let advice = if goes_on { "; --resume goes on from there" } else { "" };
            say::err(format!("interrupted at {spp:.1} samples per pixel: saved {}{advice}", saved.display()));
            return Ok(Outcome::Interrupted);
        }
        rendering(false);
        let seconds = clock(rendered.elapsed.as_secs_f64());
        let [width, height] = scene.size;
        let error = job::error_sentence(rendered).map(|error| format!(", {error}")).unwrap_or_default();
        let others = pictures.iter().skip(1).map(|(out, _)| format!(", {}", out.display())).collect::<String>();
        let (out, camera) = (out.display(), &prepared.camera);
        let first = if *before > 0.0 { format!(" ({before:.0} of them before)") } else { String::new() };
        say::err(format!("{out}{others}: {width}x{height}, camera {camera}, {spp:.0} spp{first}, {seconds}{error}"));
        if let Some(costs) = costs {
            costs::tell(costs, &metadata);
        }
        Ok(Outcome::Done)
    }
}

/// What a render gave, to be written.
struct Done<'a> {
    prepared: &'a Prepared,
    rendered: &'a Rendered,
    /// Samples per pixel that there were before.
    before: f64,
    begun: &'a Begun,
    reporter: &'a Reporter,
    costs: Option<Costs>,
}

/// Prints those of `warnings` that were not told for an earlier frame.
fn tell(warnings: &Warnings, told: &mut Warnings) {
    for warning in warnings.iter() {
        if told.add(warning.clone()) {
            let kind = if warning.is_note { "note" } else { "warning" };
            say::err(format!("{kind}: {warning}"));
        }
    }
}

/// Replays one sample.
fn debug_sample(
    scene: &penumbra::scene::Scene,
    settings: &Settings,
    x: u64,
    y: u64,
    index: u64,
) -> anyhow::Result<Outcome> {
    let [width, height] = scene.size.map(u64::from);
    if x >= width || y >= height {
        bail!("--debug-sample: pixel ({x}, {y}) is outside of the {width}x{height} picture");
    }
    let (x, y) = (x as u32, y as u32);
    let index = u32::try_from(index).map_or(index, |index| scene.passes.sequence_place(index));
    let sampler = penumbra::sampling::Sampler::new(settings.sampler, settings.seed).for_sample(x, y, index);
    let (sample, weight) = penumbra::integrator::sample(scene, settings, &sampler, x, y);
    say::out(format!("{sample:#?}\nfilter weight {weight}\n"));
    Ok(Outcome::Done)
}

/// Frames from the first to the last in steps.
#[derive(Clone, Copy, Debug)]
struct Frames {
    first: i64,
    last: i64,
    step: i64,
}

impl Frames {
    fn iter(&self) -> impl Iterator<Item = f64> + use<> {
        (self.first..=self.last).step_by(self.step as usize).map(|frame| frame as f64)
    }
}

fn parse_frames(text: &str) -> Result<Frames, String> {
    let (range, step) = text.split_once('x').unwrap_or((text, "1"));
    // The first character may be a sign.
    let dash = range.char_indices().skip(1).find(|(_, c)| *c == '-').map(|(i, _)| i);
    let (first, last) = dash.map_or((range, range), |i| (&range[..i], &range[i + 1..]));
    let number = |text: &str| text.parse::<i64>().map_err(|_| "expected A-B or A-BxSTEP, as 1-48x2".to_string());
    let frames = Frames { first: number(first)?, last: number(last)?, step: number(step)? };
    if frames.step < 1 || frames.last < frames.first {
        return Err("the step must be at least 1 and the last frame not before the first".into());
    }
    Ok(frames)
}

fn parse_sample(text: &str) -> Result<[u64; 3], String> {
    let parts: Result<Vec<u64>, _> = text.split(',').map(str::parse).collect();
    parts.ok().and_then(|parts| parts.try_into().ok()).ok_or_else(|| "expected X,Y,I, as 12,34,0".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_checked() {
        assert_eq!(parse_frames("1-7x3").unwrap().iter().collect::<Vec<_>>(), [1.0, 4.0, 7.0]);
        assert_eq!(parse_frames("5").unwrap().iter().count(), 1);
        assert_eq!(parse_frames("-5--3").unwrap().iter().collect::<Vec<_>>(), [-5.0, -4.0, -3.0]);
        assert!(parse_frames("7-1").is_err() && parse_frames("1-3x0").is_err());
    }
}
