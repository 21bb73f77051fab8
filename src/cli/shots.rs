//! The pictures that a scene asks for, by what they show: those that show the same are made by one render.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::ArgMatches;
use clap::parser::ValueSource;
use penumbra::desc::{FramingDesc, ProductDesc, RenderDesc, SceneDesc};
use penumbra::error::Warnings;

use super::files::{Files, is_of_kind};

/// One render.
pub struct Shot {
    /// What it shows.
    pub framing: FramingDesc,
    /// Passes of all its pictures, each once.
    pub passes: Vec<Arc<str>>,
    /// Where its pictures go, and what of it each is. Empty where it is one that goes where the user or the scene says
    /// of all.
    pub pictures: Vec<(PathBuf, ProductDesc)>,
}

impl Shot {
    /// `desc`'s own wishes with those of this shot.
    pub fn render(&self, desc: &RenderDesc) -> RenderDesc {
        RenderDesc { framing: self.framing.clone(), passes: self.passes.clone(), ..desc.clone() }
    }

    fn add(&mut self, out: PathBuf, product: &ProductDesc) {
        for pass in &product.passes {
            if !self.passes.contains(pass) {
                self.passes.push(pass.clone());
            }
        }
        self.pictures.push((out, product.clone()));
    }
}

/// The renders that `desc` calls for, in the order of their first pictures; one of what it says itself where it asks
/// for one picture, or the user has said otherwise. Never none.
///
/// # Errors
/// A picture that can't be written.
pub fn of(
    args: &ArgMatches,
    frame: Option<f64>,
    desc: &SceneDesc,
    warnings: &mut Warnings,
) -> anyhow::Result<Vec<Shot>> {
    let render = &desc.render;
    let alone = Shot { framing: render.framing.clone(), passes: render.passes.clone(), pictures: Vec::new() };
    let products = &render.products;
    if products.is_empty() || args.contains_id("debug-sample") {
        return Ok(vec![alone]);
    }
    if args.contains_id("output") || args.value_source("passes") == Some(ValueSource::CommandLine) {
        let what = format!("asks for {} pictures; one is written, as the command line says", products.len());
        warnings.note(&desc.place, what);
        return Ok(vec![alone]);
    }
    let (written, others): (Vec<_>, Vec<_>) =
        products.iter().partition(|product| is_of_kind(Path::new(&*product.name), "exr"));
    // Where none is left, that is no warning but the end.
    for product in others.into_iter().filter(|_| !written.is_empty()) {
        let what = format!("names the picture {}, but a render writes .exr files: it is left out", product.name);
        warnings.push(&product.place, what);
    }
    let mut shots: Vec<Shot> = Vec::new();
    for product in written {
        let out = Files::of(args, frame, Some((&product.name, &product.place)))?.out;
        let framing = typed(args, &product.framing);
        match shots.iter_mut().find(|shot| shot.framing == framing) {
            Some(shot) => shot.add(out, product),
            None => {
                let mut shot = Shot { framing, passes: Vec::new(), pictures: Vec::new() };
                shot.add(out, product);
                shots.push(shot);
            }
        }
    }
    Ok(if shots.is_empty() { vec![alone] } else { shots })
}

/// `framing` with what the user has typed instead.
fn typed(args: &ArgMatches, framing: &FramingDesc) -> FramingDesc {
    let camera = args.get_one::<String>("camera").map(|name| name.as_str().into());
    let resolution = args.get_one::<[u32; 2]>("size").copied();
    FramingDesc {
        camera: camera.or_else(|| framing.camera.clone()),
        resolution: resolution.or(framing.resolution),
        ..framing.clone()
    }
}
