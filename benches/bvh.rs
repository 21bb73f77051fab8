//! Rays per second on one thread, ours and Embree's, with the same rays in the same process.
//!
//! `cargo bench --ignore-rust-version --bench bvh -- [--mesh NAME] [--set NAME] [--isa NAME|all] [--rounds N]
//! [--embree LIBRARY] [--robust] [--no-build]`
//!
//! Both shoot each set in turn, round after round; the ratio is the median of the rounds' ratios,
//! so that a disturbance of the machine meets both. Times are of the thread's CPU clock.

#![allow(unsafe_code)]

use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use penumbra::bvh::{Blas, Bvh, Instance, Isa};
use penumbra::math::Ray;

#[path = "bvh/embree.rs"]
mod embree;
#[path = "bvh/meshes.rs"]
mod meshes;
#[path = "bvh/rays.rs"]
mod rays;
#[path = "bvh/rng.rs"]
mod rng;

use embree::{Embree, EmbreeScene};
use meshes::Scene;
use rays::{RaySet, ray_sets};

struct Options {
    meshes: Vec<String>,
    set: Option<String>,
    isas: Vec<Isa>,
    rounds: usize,
    embree: Option<PathBuf>,
    robust: bool,
    build: bool,
}

fn options() -> Options {
    let mut options = Options {
        meshes: Scene::NAMES.map(String::from).to_vec(),
        set: None,
        isas: vec![Isa::best()],
        rounds: 9,
        embree: None,
        robust: false,
        build: true,
    };
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut value = || args.next().unwrap_or_else(|| panic!("{arg} needs a value"));
        match arg.as_str() {
            "--mesh" => options.meshes = value().split(',').map(String::from).collect(),
            "--set" => options.set = Some(value()),
            "--isa" => {
                let name = value();
                options.isas = Isa::available().iter().copied().filter(|i| name == "all" || i.name() == name).collect();
                assert!(!options.isas.is_empty(), "this machine has no {name}");
            }
            "--rounds" => options.rounds = value().parse().expect("a number of rounds"),
            "--embree" => options.embree = Some(value().into()),
            "--robust" => options.robust = true,
            "--no-build" => options.build = false,
            // What cargo adds.
            "--bench" => {}
            other => panic!("unknown option {other}"),
        }
    }
    options
}

fn main() {
    let options = options();
    let library = embree::find(options.embree.clone());
    let embree = match library.as_deref().map(Embree::load) {
        Some(Ok(embree)) => Some(embree),
        Some(Err(error)) => {
            println!("Embree is skipped: {error}");
            None
        }
        None => {
            println!("Embree is skipped: no library found (--embree, PENUMBRA_EMBREE, or Python with bpy)");
            None
        }
    };
    for name in &options.meshes {
        let scene = Scene::new(name);
        println!("\n{}: {} triangles", scene.name, scene.triangles());
        if options.build {
            build_table(&scene, embree.as_ref());
        }
        let ours: Vec<Bvh> = options.isas.iter().map(|&isa| build(&scene).with_isa(isa).expect("available")).collect();
        let theirs = embree.as_ref().map(|e| e.build(&scene, 1, options.robust));
        for set in ray_sets(&scene, &ours[0]) {
            if options.set.as_ref().is_none_or(|s| s == set.name) {
                compare(&set, &ours, theirs.as_ref(), options.rounds);
            }
        }
    }
}

fn build(scene: &Scene) -> Bvh {
    let blases = scene.meshes.iter().map(|m| Arc::new(Blas::build(&m.points, &m.triangles))).collect();
    let instances = scene
        .instances
        .iter()
        .map(|&(blas, object_to_render)| Instance { blas, object_to_render, motion: None, mask: 1 })
        .collect();
    Bvh::build(blases, instances)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Seconds to build on one and two threads, and bytes per triangle.
fn build_table(scene: &Scene, embree: Option<&Arc<Embree>>) {
    const ROUNDS: usize = 3;
    let stored: usize = scene.meshes.iter().map(|m| m.triangles.len()).sum();
    let clock = |f: &mut dyn FnMut()| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        let seconds = (0..ROUNDS).map(|_| clock(&mut || drop(black_box(pool.install(|| build(scene))))));
        print!("  build on {threads} thread(s): {:.3} s", median(seconds.collect()));
        if let Some(embree) = embree {
            let seconds = (0..ROUNDS).map(|_| clock(&mut || drop(embree.build(scene, threads, false))));
            print!(", Embree {:.3} s", median(seconds.collect()));
        }
        println!();
    }
    print!("  bytes per stored triangle: {:.1}", build(scene).bytes() as f64 / stored as f64);
    if let Some(embree) = embree {
        print!(", Embree {:.1}", embree.build(scene, 1, false).bytes() as f64 / stored as f64);
    }
    println!();
}

/// CPU seconds of this thread.
#[cfg(target_os = "linux")]
fn thread_seconds() -> f64 {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanoseconds: std::ffi::c_long,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
    }
    const CLOCK_THREAD_CPUTIME_ID: i32 = 3;
    let mut time = Timespec { seconds: 0, nanoseconds: 0 };
    // SAFETY: the call fills in the struct.
    unsafe { clock_gettime(CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.seconds as f64 + 1e-9 * time.nanoseconds as f64
}

/// Seconds, where the thread's own clock is not at hand.
#[cfg(not(target_os = "linux"))]
fn thread_seconds() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Seconds that `shoot` takes for all rays, and the number of hits.
#[inline(always)]
fn time(rays: &[Ray], shoot: impl Fn(&Ray) -> bool) -> (f64, usize) {
    let start = thread_seconds();
    let hits = rays.iter().filter(|ray| shoot(ray)).count();
    (thread_seconds() - start, black_box(hits))
}

fn time_ours(bvh: &Bvh, set: &RaySet) -> f64 {
    if set.any {
        time(&set.rays, |ray| bvh.any_hit(ray, u64::MAX)).0
    } else {
        time(&set.rays, |ray| black_box(bvh.closest_hit(ray, u64::MAX)).is_some()).0
    }
}

fn time_theirs(scene: &EmbreeScene, set: &RaySet) -> f64 {
    if set.any {
        time(&set.rays, |ray| scene.any(ray)).0
    } else {
        time(&set.rays, |ray| black_box(scene.closest(ray)).is_some()).0
    }
}

fn compare(set: &RaySet, ours: &[Bvh], theirs: Option<&EmbreeScene>, rounds: usize) {
    let mega = |seconds: f64| set.rays.len() as f64 / seconds * 1e-6;
    let mut our_times = vec![Vec::new(); ours.len()];
    let mut their_times = Vec::new();
    for _ in 0..rounds {
        for (bvh, times) in ours.iter().zip(&mut our_times) {
            times.push(time_ours(bvh, set));
        }
        if let Some(scene) = theirs {
            their_times.push(time_theirs(scene, set));
        }
    }
    print!("  {:<13}", set.name);
    for (bvh, times) in ours.iter().zip(&our_times) {
        print!("{:>8}{:7.2} Mrays/s", bvh.isa().name(), mega(median(times.clone())));
        if theirs.is_some() {
            let ratios = their_times.iter().zip(times).map(|(theirs, ours)| theirs / ours);
            print!(" = {:.2}x", median(ratios.collect()));
        }
    }
    if let Some(scene) = theirs {
        print!("   Embree {:6.2} Mrays/s", mega(median(their_times)));
        let (presence, distance) = disagreements(set, &ours[0], scene);
        print!("   differ: {presence} in hit or miss, {distance} in distance");
    }
    println!();
}

/// Rays for which one finds a hit and the other none, and those whose distances differ by more than rounding.
fn disagreements(set: &RaySet, ours: &Bvh, theirs: &EmbreeScene) -> (usize, usize) {
    let (mut presence, mut distance) = (0, 0);
    for ray in &set.rays {
        if set.any {
            presence += usize::from(ours.any_hit(ray, u64::MAX) != theirs.any(ray));
            continue;
        }
        match (ours.closest_hit(ray, u64::MAX).map(|h| h.t), theirs.closest(ray)) {
            (Some(a), Some(b)) => {
                let rounding = 1e-4 * b + 1e-6 * ray.o.abs().max_element();
                distance += usize::from((a - b).abs() > rounding);
            }
            (a, b) => presence += usize::from(a.is_some() != b.is_some()),
        }
    }
    (presence, distance)
}
