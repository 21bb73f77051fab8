//! The choice among many lights: noise and cost of the tree, of choice by power and of uniform choice,
//! and the time that whole pictures take.
//!
//! `cargo bench --ignore-rust-version --bench lights -- [quality] [cost] [mesh] [time]`; all without arguments.

#![allow(unsafe_code)]

use std::hint::black_box;
use std::time::Instant;

use penumbra::light::LightTree;

#[path = "lights/clock.rs"]
mod clock;
#[path = "lights/mesh.rs"]
mod mesh;
#[path = "../tests/support/scene.rs"]
#[allow(dead_code, reason = "made for the tests")]
mod scene;
#[path = "lights/scenes.rs"]
mod scenes;
#[path = "lights/time.rs"]
mod time;

use scenes::{Random, irradiance};

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let runs = |name: &str| asked.is_empty() || asked.iter().any(|a| a == name);
    if runs("quality") {
        quality();
    }
    if runs("cost") {
        cost();
    }
    if runs("mesh") {
        mesh::run();
    }
    if runs("time") {
        time::run();
    }
}

/// Variance of the unoccluded irradiance by one choice, in units of its square: the mean over receivers,
/// exact, since all odds are known.
fn quality() {
    println!("variance of one choice / mean²");
    println!("  {:<22}{:>8}{:>10}{:>10}{:>10}{:>10}", "lights", "count", "tree", "median", "power", "uniform");
    for count in [100, 10_000] {
        for scene in scenes::all(count, 100) {
            let tree = LightTree::new(&scene.lights).expect("lights shine");
            let total: f64 = scene.lights.iter().map(|l| f64::from(l.intensity)).sum();
            let (mut variances, mut by_power, mut uniform) = (Vec::new(), 0.0, 0.0);
            for at in &scene.receivers {
                let e: Vec<f64> = scene.lights.iter().map(|light| irradiance(light, at)).collect();
                let mean: f64 = e.iter().sum();
                let lit = || e.iter().enumerate().filter(|(_, e)| **e > 0.0);
                let variance =
                    |pmf: &dyn Fn(usize) -> f64| lit().map(|(i, e)| e * e / pmf(i)).sum::<f64>() / (mean * mean) - 1.0;
                if mean > 0.0 {
                    variances.push(variance(&|i| f64::from(tree.pmf(at, i as u32))));
                    by_power += variance(&|i| f64::from(scene.lights[i].intensity) / total);
                    uniform += variance(&|_| 1.0 / count as f64);
                }
            }
            variances.sort_by(f64::total_cmp);
            let n = variances.len() as f64;
            let tree: f64 = variances.iter().sum::<f64>() / n;
            println!(
                "  {:<22}{count:>8}{tree:>10.3}{:>10.3}{:>10.2}{:>10.2}",
                scene.name,
                variances[variances.len() / 2],
                by_power / n,
                uniform / n
            );
        }
    }
}

/// CPU seconds of this thread, which other work on the machine disturbs least.
fn cpu_seconds(mut f: impl FnMut()) -> f64 {
    let start = clock::thread_seconds();
    f();
    clock::thread_seconds() - start
}

/// Time of a build, a choice and a density.
fn cost() {
    println!("cost of the tree");
    for count in [10, 100, 10_000, 1_000_000] {
        let scene = scenes::all(count, 1000).pop().expect("a scene");
        let build = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            let times = (0..5).map(|_| {
                pool.install(|| {
                    let (wall, cpu) = (Instant::now(), clock::thread_seconds());
                    drop(black_box(LightTree::new(&scene.lights)));
                    if threads == 1 { clock::thread_seconds() - cpu } else { wall.elapsed().as_secs_f64() }
                })
            });
            times.fold(f64::MAX, f64::min)
        };
        let tree = LightTree::new(&scene.lights).expect("lights shine");
        let mut random = Random(3);
        let draws: Vec<(usize, f32)> = (0..200_000).map(|i| (i % scene.receivers.len(), random.unit())).collect();
        let mut items = Vec::new();
        let choice = (0..5)
            .map(|_| {
                items.clear();
                cpu_seconds(|| {
                    items.extend(draws.iter().filter_map(|&(r, u)| Some(tree.sample(&scene.receivers[r], u)?.item)));
                })
            })
            .fold(f64::MAX, f64::min);
        let pmf = (0..5)
            .map(|_| {
                cpu_seconds(|| {
                    let sum: f32 = items.iter().zip(&draws).map(|(&i, d)| tree.pmf(&scene.receivers[d.0], i)).sum();
                    black_box(sum);
                })
            })
            .fold(f64::MAX, f64::min);
        let nano = 1e9 / draws.len() as f64;
        println!(
            "  {count:>8} lights: build {:.4} s of CPU, {:.4} s on 2 threads, {:.1} bytes a light, choice {:6.0} ns, density {:6.0} ns",
            build(1),
            build(2),
            tree.bytes() as f64 / count as f64,
            choice * nano,
            pmf * nano
        );
    }
}
