//! `penumbra info`: what was read from a scene.

mod lights;
mod materials;
mod values;

use std::collections::HashMap;
use std::time::Instant;

use clap::{Arg, ArgAction, ArgMatches, Command};
use penumbra::desc::{ProjectionDesc, SceneDesc, ShapeRef};
use penumbra::error::Warnings;
use serde_json::{Value, json};

use super::{Outcome, say};

pub fn command() -> Command {
    Command::new("info")
        .about("Show what a scene holds: meshes, instances, materials, cameras, lights with their units")
        .args(super::scene::args())
        .arg(
            Arg::new("frame")
                .long("frame")
                .value_name("F")
                .value_parser(super::scene::parse_frame)
                .allow_negative_numbers(true)
                .help("Frame to read"),
        )
        .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print JSON"))
        .arg(
            Arg::new("values")
                .long("values")
                .action(ArgAction::SetTrue)
                .requires("json")
                .help("With --json: every matrix, point and light value, too"),
        )
}

pub fn run(args: &ArgMatches) -> anyhow::Result<Outcome> {
    let start = Instant::now();
    let (scene, warnings) = super::scene::load(args, args.get_one("frame").copied(), false)?;
    let read_s = start.elapsed().as_secs_f64();
    let is_json = args.get_flag("json");
    let mut info = describe(&scene, &warnings, if is_json { usize::MAX } else { MOST_MESHES });
    if args.get_flag("values") {
        info["values"] = values::describe(&scene);
    }
    if is_json {
        info["read_s"] = json!(read_s);
        say::out(format!("{info:#}\n"));
    } else {
        say::out(page(&info, scene.meshes.len()));
    }
    // The process ends: to let go of a large scene piece by piece takes longer than to read a small one.
    std::mem::forget(scene);
    Ok(Outcome::Done)
}

/// Everything that both forms of the report say, with at most `most` meshes.
fn describe(scene: &SceneDesc, warnings: &Warnings, most: usize) -> Value {
    let mut users: HashMap<ShapeRef, u64> = HashMap::new();
    for instance in &scene.instances {
        *users.entry(instance.shape).or_default() += 1;
    }
    let users = |shape: ShapeRef| users.get(&shape).copied().unwrap_or_default();
    let meshes: Vec<Value> = scene
        .meshes
        .iter()
        .zip(0..)
        .take(most)
        .map(|(mesh, i)| {
            json!({
                "name": &*mesh.name,
                "points": mesh.points.len(),
                "triangles": mesh.triangles.len(),
                "normals": mesh.normals.is_some(),
                "uv_sets": mesh.uvs.len(),
                "tangents": mesh.tangents.is_some(),
                "colors": mesh.colors.is_some(),
                "instances": users(ShapeRef::Mesh(i)),
            })
        })
        .collect();
    let rounds: Vec<Value> = scene
        .rounds
        .iter()
        .zip(0..)
        .map(|(rounds, i)| {
            json!({
                "name": &*rounds.name,
                "points": rounds.points.len(),
                "strands": rounds.strands.len(),
                "uv_sets": rounds.uvs.len(),
                "colors": rounds.colors.is_some(),
                "instances": users(ShapeRef::Rounds(i)),
            })
        })
        .collect();
    json!({
        "scene": scene.place.to_string(),
        "triangles": scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>(),
        "instanced_triangles": scene.instances.iter().filter_map(|i| scene.mesh(i)).map(|m| m.triangles.len()).sum::<usize>(),
        "meshes": meshes,
        "rounds": rounds,
        "instances": scene.instances.len(),
        "materials": scene.materials.iter().map(|m| json!({ "name": &*m.name })).collect::<Vec<_>>(),
        "textures": scene.textures.len(),
        "images": scene.images.iter().map(|image| json!({
            "name": &*image.name,
            "size": [image.width, image.height],
            "channels": image.channels,
            "bytes": image.pixels.bytes(),
        })).collect::<Vec<_>>(),
        "cameras": scene.cameras.iter().map(|camera| {
            let mut value = json!({ "name": &*camera.name, "node": camera.place.node.as_deref() });
            match camera.projection {
                ProjectionDesc::Perspective { fov_y, aspect } => {
                    value["fov_y_deg"] = json!(fov_y.to_degrees());
                    value["aspect"] = json!(aspect);
                }
                ProjectionDesc::Orthographic { half_width, half_height } => {
                    value["size_m"] = json!([2.0 * half_width, 2.0 * half_height]);
                }
                ProjectionDesc::Equirectangular { longitude, latitude } => {
                    value["longitude_deg"] = json!(longitude.map(f64::to_degrees));
                    value["latitude_deg"] = json!(latitude.map(f64::to_degrees));
                }
            }
            value
        }).collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(|light| lights::describe(light, scene)).collect::<Vec<_>>(),
        "light_groups": lights::groups(scene),
        "emissive_materials": scene.materials.iter()
            .filter(|m| !m.unlit && m.emission_strength > 0.0 && m.emission.factor.iter().any(|&c| c > 0.0))
            .map(|m| json!({
                "name": &*m.name,
                "value": m.emission.factor.map(|c| c * m.emission_strength),
                "textured": m.emission.texture.is_some(),
                "unit": "W/(m2 sr)",
            }))
            .collect::<Vec<_>>(),
        "variants": scene.variants,
        "warnings": warnings.iter().filter(|w| !w.is_note).map(ToString::to_string).collect::<Vec<_>>(),
        "notes": warnings.iter().filter(|w| w.is_note).map(ToString::to_string).collect::<Vec<_>>(),
    })
}

/// So many meshes are listed for people.
const MOST_MESHES: usize = 100;

/// The report for people, on a scene of so many `meshes`.
fn page(info: &Value, meshes: usize) -> String {
    let mut page = String::new();
    let mut line = |text: String| page += &(text + "\n");
    let list = |key: &str| info[key].as_array().map_or(&[][..], Vec::as_slice);
    line(info["scene"].as_str().unwrap_or_default().to_string());
    line(format!(
        "  {} triangles in {} meshes, {} when instanced by {} instances",
        info["triangles"], meshes, info["instanced_triangles"], info["instances"]
    ));
    let listed = list("meshes");
    for mesh in listed {
        line(format!(
            "  mesh {}: {} points, {} triangles, {} instances",
            mesh["name"], mesh["points"], mesh["triangles"], mesh["instances"]
        ));
    }
    if meshes > listed.len() {
        line(format!("  and {} meshes more; --json lists all", meshes - listed.len()));
    }
    for rounds in list("rounds").iter().take(MOST_MESHES) {
        let what = match rounds["strands"].as_u64() {
            Some(0) => "balls".to_string(),
            _ => format!("points in {} strands", rounds["strands"]),
        };
        line(format!("  {}: {} {what}, {} instances", rounds["name"], rounds["points"], rounds["instances"]));
    }
    if list("rounds").len() > MOST_MESHES {
        line(format!("  and {} sets of strands or balls more", list("rounds").len() - MOST_MESHES));
    }
    let names: Vec<String> = list("materials").iter().map(|m| m["name"].to_string()).collect();
    line(format!("  {} materials: {}", names.len(), names.join(", ")));
    for image in list("images") {
        line(format!(
            "  image {}: {}x{}, {} channels, {} bytes",
            image["name"], image["size"][0], image["size"][1], image["channels"], image["bytes"]
        ));
    }
    for camera in list("cameras") {
        let lens = camera.get("fov_y_deg").map_or_else(
            || format!("orthographic, {} x {} m", camera["size_m"][0], camera["size_m"][1]),
            |fov| format!("perspective, {:.2} degrees from bottom to top", fov.as_f64().unwrap_or_default()),
        );
        let node = camera["node"].as_str().filter(|node| camera["name"] != *node);
        let node = node.map(|node| format!(" ({node})")).unwrap_or_default();
        line(format!("  camera {}{node}: {lens}", camera["name"]));
    }
    for light in list("lights") {
        line(format!("  {}", lights::line(light)));
    }
    if !list("light_groups").is_empty() {
        line(format!("  light groups: {}", joined(&info["light_groups"])));
    }
    for material in list("emissive_materials") {
        line(format!(
            "  emissive material {}: {} {}",
            material["name"],
            numbers(&material["value"]),
            material["unit"].as_str().unwrap_or_default()
        ));
    }
    if !list("variants").is_empty() {
        line(format!("  variants: {}", joined(&info["variants"])));
    }
    for warning in list("warnings") {
        line(format!("  warning: {}", warning.as_str().unwrap_or_default()));
    }
    for note in list("notes") {
        line(format!("  note: {}", note.as_str().unwrap_or_default()));
    }
    page
}

/// A list of texts in one line.
fn joined(value: &Value) -> String {
    let names = value.as_array().map(|list| list.iter().filter_map(Value::as_str).collect::<Vec<_>>());
    names.unwrap_or_default().join(", ")
}

fn numbers(value: &Value) -> String {
    let parts = value
        .as_array()
        .map(|list| list.iter().filter_map(Value::as_f64).map(|v| format!("{v:.4}")).collect::<Vec<_>>());
    parts.map(|parts| format!("({})", parts.join(", "))).unwrap_or_default()
}
