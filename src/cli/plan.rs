//! `penumbra plan`: which effects a scene calls for, which not, and why.

use anyhow::Context;
use clap::{Arg, ArgAction, ArgMatches, Command};
use penumbra::job;
use penumbra::plan::{Plan, Row};
use penumbra::scene::{View, prepare};
use serde_json::{Value, json};

use super::{Outcome, environment, given, say, scene};

/// Width of a reason in the table; JSON has all of it.
const REASON: usize = 62;

pub fn command() -> Command {
    let flag = |name: &'static str| Arg::new(name).long(name).action(ArgAction::SetTrue);
    Command::new("plan")
        .about("Show which effects a scene calls for, which not, and why; and what each costs")
        .args(scene::args())
        .args(given::view_args())
        .args(environment::args())
        .arg(flag("json").help("Print JSON"))
        .arg(flag("brief").conflicts_with("json").help("Leave out why what is not simulated is not"))
        .arg(flag("no-probe").help("Leave out the measurement of times, which takes some seconds"))
        .args(given::setting_args())
}

pub fn run(args: &ArgMatches) -> anyhow::Result<Outcome> {
    let settings = given::settings(args, command);
    rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads as usize)
        .build_global()
        .with_context(|| format!("can't start {} threads", settings.threads))?;
    let (mut desc, mut warnings) = scene::load(args, args.get_one("frame").copied(), false)?;
    environment::apply(args, &mut desc)?;
    let camera = args.get_one("camera").cloned();
    let view: View = job::view(camera, args.get_one("size").copied(), &desc, &mut warnings);
    let mut prepared = prepare(desc.clone(), &view, &settings)?;
    warnings.extend(prepared.warnings.clone());
    for warning in warnings.iter() {
        say::err(format!("{}: {warning}", if warning.is_note { "note" } else { "warning" }));
    }
    let mut plan = Plan::of(&desc, &prepared, &settings);
    if !args.get_flag("no-probe") {
        plan.measured(&penumbra::render::costs(&mut prepared.scene, &settings)?);
    }
    if args.get_flag("json") {
        say::out(format!("{:#}\n", as_json(&plan, &prepared.camera, prepared.scene.size)));
    } else {
        say::out(table(&plan, !args.get_flag("brief")));
    }
    Ok(Outcome::Done)
}

fn as_json(plan: &Plan, camera: &str, size: [u32; 2]) -> Value {
    let row = |row: &Row| {
        json!({
            "subject": row.subject,
            "effect": row.effect,
            "on": row.on,
            "because": row.because,
            "adds": row.adds,
            "bytes": row.bytes,
            "share": row.cost.map(|cost| cost[0]),
            "share_error": row.cost.map(|cost| cost[1]),
        })
    };
    json!({
        "camera": camera,
        "size": size,
        "seconds_a_sample": plan.sample,
        "effects": plan.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

/// By subject; without `all` what is not simulated comes in one line at the end.
fn table(plan: &Plan, all: bool) -> String {
    let mut text = String::new();
    if let Some(sample) = plan.sample {
        text += &format!("a sample takes a thread {:.2} microseconds\n", 1e6 * sample);
    }
    let mut subject = "";
    for row in plan.rows.iter().filter(|row| row.on || all) {
        if row.subject != subject {
            subject = row.subject;
            text += &format!("\n{subject}\n");
        }
        text += &line(row);
    }
    if !all {
        let off: Vec<&str> = plan.rows.iter().filter(|row| !row.on).map(|row| row.effect).collect();
        text += &format!("\nnot called for: {}\n", off.join(", "));
    }
    text
}

fn line(row: &Row) -> String {
    let mark = if row.on { "on" } else { "-" };
    let mut costs = Vec::new();
    if let Some([share, error]) = row.cost {
        let (share, error) = (100.0 * share, 200.0 * error);
        costs.push(match share > error {
            true => format!("{share:.1} % of the time (within {error:.1})"),
            false => format!("less than {:.1} % of the time", share.max(0.0) + error),
        });
    }
    costs.extend(row.bytes.map(|bytes| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))));
    costs.extend(Some(row.adds.clone()).filter(|adds| !adds.is_empty()));
    let because = shortened(&row.because);
    format!("  {mark:<3}{:<29} {because:<REASON$} {}", row.effect, costs.join("; ")).trim_end().to_owned() + "\n"
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(REASON) {
        None => text.to_owned(),
        Some(_) => text.chars().take(REASON - 1).chain(['…']).collect(),
    }
}
