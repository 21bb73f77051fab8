//! Every value of a scene as JSON, for tests that compare them with another program's: `--values`.
//!
//! Numbers are those of `SceneDesc`, in its space (y up) and units (metres, radiance, radians). A matrix
//! has 16 numbers, the images of the x, y and z axis and of the origin, four each: the layout of USD and
//! of glTF alike.

use penumbra::desc::{
    Attribute, CameraDesc, ConeDesc, DecayLaw, FramingDesc, InstanceDesc, LightDesc, LightKind, LightLinks, LinkSet,
    MeshDesc, Motion, ProductDesc, ProjectionDesc, RenderDesc, RoundsDesc, SceneDesc, ShapeRef, ShapingDesc,
    Visibility,
};
use penumbra::error::Place;
use penumbra::math::{DAffine3, DMat4};
use serde_json::{Value, json};

use super::materials;

/// All of `scene`.
pub fn describe(scene: &SceneDesc) -> Value {
    json!({
        "meshes": scene.meshes.iter().map(|desc| mesh(desc)).collect::<Vec<_>>(),
        "rounds": scene.rounds.iter().map(|desc| rounds(desc)).collect::<Vec<_>>(),
        "instances": scene.instances.iter().map(|i| instance(i, scene)).collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(|l| light(l, scene)).collect::<Vec<_>>(),
        "materials": scene.materials.iter().map(|m| materials::describe(m, scene)).collect::<Vec<_>>(),
        "cameras": scene.cameras.iter().map(camera).collect::<Vec<_>>(),
        "render": render(&scene.render),
    })
}

fn render(render: &RenderDesc) -> Value {
    let mut value = framing(&render.framing);
    value["passes"] = json!(render.passes.iter().map(|pass| &**pass).collect::<Vec<_>>());
    value["product"] = json!(render.product.as_deref());
    let product = |product: &ProductDesc| {
        let mut value = framing(&product.framing);
        value["name"] = json!(&*product.name);
        value["passes"] = json!(product.passes.iter().map(|pass| &**pass).collect::<Vec<_>>());
        value
    };
    value["products"] = json!(render.products.iter().map(product).collect::<Vec<_>>());
    value
}

fn framing(framing: &FramingDesc) -> Value {
    json!({
        "camera": framing.camera.as_deref(),
        "resolution": framing.resolution,
        "pixel_aspect": framing.pixel_aspect,
        "conform": format!("{:?}", framing.conform).to_lowercase(),
        "window": framing.window,
    })
}

fn node(place: &Place) -> Option<&str> {
    place.node.as_deref()
}

fn matrix(transform: &DAffine3) -> [f64; 16] {
    DMat4::from(*transform).to_cols_array()
}

fn mesh(mesh: &MeshDesc) -> Value {
    json!({
        "name": &*mesh.name,
        "place": node(&mesh.place),
        "points": mesh.points,
        "triangles": mesh.triangles,
        "normals": mesh.normals.as_ref().map(attribute),
        "uvs": mesh.uvs.iter().map(attribute).collect::<Vec<_>>(),
        "colors": mesh.colors.as_ref().map(attribute),
        "attributes": mesh.attributes.iter()
            .map(|named| json!({ "name": &*named.name, "values": attribute(&named.values) }))
            .collect::<Vec<_>>(),
        "material_slots": mesh.material_slots,
        "motion": motion(&mesh.motion),
    })
}

fn rounds(rounds: &RoundsDesc) -> Value {
    json!({
        "name": &*rounds.name,
        "place": node(&rounds.place),
        "points": rounds.points,
        "radii": rounds.radii,
        "strands": rounds.strands.iter().map(|s| json!({ "end": s.end, "closed": s.closed })).collect::<Vec<_>>(),
        "uvs": rounds.uvs,
        "colors": rounds.colors,
        "attributes": rounds.attributes.iter()
            .map(|(name, values)| json!({ "name": &**name, "values": values }))
            .collect::<Vec<_>>(),
        "material_slots": rounds.material_slots,
        "motion": motion(&rounds.motion),
        "radii_motion": rounds.radii_motion,
    })
}

fn motion(motion: &[Motion<Vec<[f32; 3]>>]) -> Vec<Value> {
    motion.iter().map(|m| json!({ "time": m.time, "points": m.value })).collect()
}

fn poses(motion: &[Motion<DAffine3>]) -> Vec<Value> {
    motion.iter().map(|m| json!({ "time": m.time, "matrix": matrix(&m.value) })).collect()
}

fn attribute<T: serde::Serialize>(attribute: &Attribute<T>) -> Value {
    match attribute {
        Attribute::Point(values) => json!({ "per": "point", "values": values }),
        Attribute::Corner(values) => json!({ "per": "corner", "values": values }),
    }
}

fn instance(instance: &InstanceDesc, scene: &SceneDesc) -> Value {
    let material = |index: &Option<u32>| {
        let material = &scene.materials[(*index)? as usize];
        Some(json!({ "index": index, "name": &*material.name, "place": node(&material.place) }))
    };
    json!({
        "name": &*instance.name,
        "place": node(&instance.place),
        "mesh": match instance.shape { ShapeRef::Mesh(i) => Some(i), ShapeRef::Rounds(_) => None },
        "rounds": match instance.shape { ShapeRef::Rounds(i) => Some(i), ShapeRef::Mesh(_) => None },
        "matrix": matrix(&instance.transform),
        "motion": poses(&instance.motion),
        "materials": instance.materials.iter().map(material).collect::<Vec<_>>(),
        "color": instance.color,
        "attributes": instance.info.attributes.iter().map(|(name, value)| (name.to_string(), json!(value)))
            .collect::<serde_json::Map<_, _>>(),
        "visibility": visibility(instance.visibility),
        "links": links(&instance.links, scene),
        "shaped": instance.shaped.as_ref().map(|shaped| json!({
            "matrix": matrix(&shaped.transform),
            "shaping": shaping(&shaped.shaping, scene),
        })),
    })
}

fn visibility(visibility: Visibility) -> Value {
    let Visibility { camera, diffuse, glossy, transmission, shadow } = visibility;
    json!({ "camera": camera, "diffuse": diffuse, "glossy": glossy, "transmission": transmission, "shadow": shadow })
}

fn links(links: &LightLinks, scene: &SceneDesc) -> Value {
    let set = |set: &LinkSet| {
        let places = set.instances.iter().map(|&i| node(&scene.instances[i as usize].place));
        json!({ if set.exclude { "exclude" } else { "include" }: places.collect::<Vec<_>>() })
    };
    json!({
        "group": links.group.as_deref(),
        "cast_shadow": links.cast_shadow,
        "shadow": {
            "color": links.shadow.color,
            "distance": links.shadow.distance,
            "falloff": links.shadow.falloff,
            "gamma": links.shadow.gamma,
        },
        "response": links.response,
        "receivers": links.receivers.as_ref().map(set),
        "blockers": links.blockers.as_ref().map(set),
    })
}

fn shaping(shaping: &ShapingDesc, scene: &SceneDesc) -> Value {
    let cone = |cone: ConeDesc| match cone {
        ConeDesc::Ramp { inner, outer } => json!({ "kind": "ramp", "inner": inner, "outer": outer }),
        ConeDesc::Blend { angle, blend } => json!({ "kind": "blend", "angle": angle, "blend": blend }),
        ConeDesc::Soft { angle, softness } => json!({ "kind": "soft", "angle": angle, "softness": softness }),
    };
    json!({
        "cone": shaping.cone.map(cone),
        "focus": shaping.focus,
        "focus_tint": shaping.focus_tint,
        "ies": shaping.ies.map(|ies| json!({
            "profile": &*scene.ies[ies.profile as usize].name,
            "angle_scale": ies.angle_scale,
            "keep_power": ies.keep_power,
        })),
    })
}

fn light(light: &LightDesc, scene: &SceneDesc) -> Value {
    let law = match light.decay.law {
        DecayLaw::Constant => json!("constant"),
        DecayLaw::Linear => json!("linear"),
        DecayLaw::Quadratic => json!("quadratic"),
        DecayLaw::Polynomial { kc, kl, kq } => json!([kc, kl, kq]),
    };
    let range = light.decay.range.is_finite().then_some(light.decay.range);
    json!({
        "name": &*light.name,
        "place": node(&light.place),
        "matrix": matrix(&light.transform),
        "motion": poses(&light.motion),
        "kind": kind(light.kind, scene),
        "shaping": shaping(&light.shaping, scene),
        "decay": { "law": law, "smooth": light.decay.smooth, "range": range },
        "visibility": visibility(light.visibility),
        "links": links(&light.links, scene),
    })
}

fn kind(kind: LightKind, scene: &SceneDesc) -> Value {
    let image = |image: Option<u32>| image.map(|i| scene.images[i as usize].name.to_string());
    match kind {
        LightKind::Point { intensity } => json!({ "kind": "point", "intensity": intensity }),
        LightKind::Sphere { radius, radiance, facing } => {
            json!({ "kind": "sphere", "radius": radius, "radiance": radiance, "facing": facing })
        }
        LightKind::Rect { width, height, radiance, spread, two_sided, image: texture } => json!({
            "kind": "rect", "width": width, "height": height, "radiance": radiance, "spread": spread,
            "two_sided": two_sided, "image": image(texture),
        }),
        LightKind::Disk { width, height, radiance, spread, two_sided } => json!({
            "kind": "disk", "width": width, "height": height, "radiance": radiance, "spread": spread,
            "two_sided": two_sided,
        }),
        LightKind::Cylinder { radius, length, radiance } => {
            json!({ "kind": "cylinder", "radius": radius, "length": length, "radiance": radiance })
        }
        LightKind::Distant { irradiance, angle } => {
            json!({ "kind": "distant", "irradiance": irradiance, "angle": angle })
        }
        LightKind::Dome { radiance, image: texture } => {
            json!({ "kind": "dome", "radiance": radiance, "image": image(texture) })
        }
        LightKind::Portal { width, height } => json!({ "kind": "portal", "width": width, "height": height }),
        LightKind::ShadedDome { shader } => json!({ "kind": "shaded dome", "shader": shader }),
    }
}

fn camera(camera: &CameraDesc) -> Value {
    let projection = match camera.projection {
        ProjectionDesc::Perspective { fov_y, aspect } => {
            json!({ "kind": "perspective", "fov_y": fov_y, "aspect": aspect })
        }
        ProjectionDesc::Orthographic { half_width, half_height } => {
            json!({ "kind": "orthographic", "half_width": half_width, "half_height": half_height })
        }
        ProjectionDesc::Equirectangular { longitude, latitude } => {
            json!({ "kind": "equirectangular", "longitude": longitude, "latitude": latitude })
        }
    };
    json!({
        "name": &*camera.name,
        "place": node(&camera.place),
        "matrix": matrix(&camera.transform),
        "motion": poses(&camera.motion),
        "projection": projection,
        "clip_near": camera.clip_near,
        "clip_far": camera.clip_far.is_finite().then_some(camera.clip_far),
        "shift": camera.shift,
        "lens": camera.lens.map(|lens| json!({
            "aperture_radius": lens.aperture_radius, "focus_distance": lens.focus_distance,
        })),
        "shutter": camera.shutter,
        "exposure": camera.exposure,
    })
}
