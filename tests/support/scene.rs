//! Small scenes by hand, and their pictures.

use penumbra::desc::{
    Attribute, CameraDesc, ColorInput, InstanceDesc, LightDesc, LightKind, LightLinks, MaterialDesc, MeshDesc,
    ObjectInfo, ProjectionDesc, RoundsDesc, ScalarInput, SceneDesc, ShapeRef, Visibility,
};
use penumbra::error::Place;
use penumbra::film::{PassSet, Picture};
use penumbra::math::{DAffine3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;

/// A scene that is built piece by piece.
#[derive(Clone, Default)]
pub struct Builder {
    /// What was built so far.
    pub desc: SceneDesc,
}

impl Builder {
    /// A Lambert surface of `albedo`.
    pub fn lambert(&mut self, albedo: f64) -> u32 {
        self.material(MaterialDesc {
            base_color: ColorInput::constant([albedo; 3]),
            specular: ScalarInput::constant(0.0),
            roughness: ScalarInput::constant(1.0),
            ..MaterialDesc::default()
        })
    }

    /// Any material.
    pub fn material(&mut self, material: MaterialDesc) -> u32 {
        let name = format!("material {}", self.desc.materials.len());
        self.desc.materials.push(MaterialDesc { name: name.as_str().into(), ..material });
        self.desc.materials.len() as u32 - 1
    }

    /// A mesh placed by `transform`.
    pub fn mesh(&mut self, points: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, material: u32, transform: DAffine3) {
        let mesh = MeshDesc { points, triangles, ..MeshDesc::default() };
        self.instance(mesh, material, transform);
    }

    /// Any mesh placed by `transform`.
    pub fn instance(&mut self, mesh: MeshDesc, material: u32, transform: DAffine3) {
        self.desc.meshes.push(mesh.into());
        self.place(ShapeRef::Mesh(self.desc.meshes.len() as u32 - 1), material, transform);
    }

    /// Strands or balls, where their points say.
    #[allow(dead_code)] // Not every test that includes this file has strands.
    pub fn rounds(&mut self, rounds: RoundsDesc, material: u32) {
        self.desc.rounds.push(rounds.into());
        self.place(ShapeRef::Rounds(self.desc.rounds.len() as u32 - 1), material, DAffine3::IDENTITY);
    }

    fn place(&mut self, shape: ShapeRef, material: u32, transform: DAffine3) {
        let name = format!("object {}", self.desc.instances.len());
        self.desc.instances.push(InstanceDesc {
            name: name.as_str().into(),
            place: Place::default(),
            asset: "asset".into(),
            shape,
            transform,
            motion: Vec::new(),
            materials: vec![Some(material)],
            color: None,
            object_index: self.desc.instances.len() as u32 + 1,
            info: ObjectInfo::default(),
            visibility: Visibility::ALL,
            links: LightLinks::default(),
            shaped: None,
            holdout: false,
            catcher: false,
            terminator: None,
        });
    }

    /// The parallelogram `corner`, `corner + a`, `corner + a + b`, `corner + b`, cut along a diagonal.
    pub fn quad(&mut self, corner: [f64; 3], a: [f64; 3], b: [f64; 3], material: u32) {
        let [corner, a, b] = [corner, a, b].map(DVec3::from);
        let points = [corner, corner + a, corner + a + b, corner + b];
        let points = points.map(|p| p.as_vec3().to_array()).to_vec();
        self.mesh(points, vec![[0, 1, 2], [0, 2, 3]], material, DAffine3::IDENTITY);
    }

    /// A horizontal square about the origin, facing up, cut so that no edge is near its middle.
    pub fn ground(&mut self, half: f64, material: u32) {
        let h = half as f32;
        let points = vec![[-h, 0.0, h], [3.0 * h, 0.0, h], [-h, 0.0, -3.0 * h]];
        self.mesh(points, vec![[0, 1, 2]], material, DAffine3::IDENTITY);
    }

    /// A unit sphere of `2 n²` triangles, with smooth normals if `smooth`.
    pub fn sphere(&mut self, n: u32, smooth: bool, material: u32, transform: DAffine3) {
        let mut points = Vec::new();
        for i in 0..=n {
            for j in 0..2 * n {
                let (theta, phi) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                let (theta, phi) = (theta * std::f64::consts::PI, phi * std::f64::consts::PI);
                points.push([theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()].map(|v| v as f32));
            }
        }
        let at = |i: u32, j: u32| i * 2 * n + j % (2 * n);
        let triangles = (0..n)
            .flat_map(|i| (0..2 * n).map(move |j| (i, j)))
            .flat_map(|(i, j)| [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]])
            .collect();
        let normals = smooth.then(|| Attribute::Point(points.clone()));
        self.instance(MeshDesc { points, triangles, normals, ..MeshDesc::default() }, material, transform);
    }

    /// A lamp.
    pub fn light(&mut self, kind: LightKind, transform: DAffine3) {
        let name = format!("lamp {}", self.desc.lights.len());
        self.desc.lights.push(LightDesc::new(name.as_str(), Place::default(), transform, kind));
    }

    /// A dome of constant radiance.
    pub fn dome(&mut self, radiance: f64) {
        self.light(LightKind::Dome { radiance: [radiance; 3], image: None }, DAffine3::IDENTITY);
    }

    /// An orthographic camera one metre from `target`, which looks along `forward` at a square of
    /// half side `half`.
    pub fn look(&mut self, target: [f64; 3], forward: [f64; 3], half: f64) {
        let (target, forward) = (DVec3::from(target), DVec3::from(forward).normalize());
        let right = forward.any_orthonormal_vector();
        let transform = DAffine3::from_cols(right, right.cross(forward), -forward, target - forward);
        self.desc.cameras.push(CameraDesc {
            name: "camera".into(),
            place: Place::default(),
            transform,
            projection: ProjectionDesc::Orthographic { half_width: half, half_height: half },
            clip_near: 0.0,
            clip_far: f64::INFINITY,
            shift: [0.0; 2],
            lens: None,
            shutter: [0.0; 2],
            shutter_curve: Vec::new(),
            rolling_shutter: None,
            zoom: Vec::new(),
            exposure: 1.0,
            motion: Vec::new(),
        });
    }
}

/// Settings with `spp` samples of the passes `passes`.
pub fn settings(passes: &str, spp: u32) -> Settings {
    Settings { spp, passes: PassSet::parse(passes).unwrap(), ..Settings::default() }
}

/// The picture of `desc`, `size` pixels on each side.
pub fn picture(desc: &SceneDesc, size: u32, settings: &Settings) -> Picture {
    let view = View { camera: None, size: Some([size, size]) };
    let prepared = prepare(desc.clone(), &view, settings).unwrap();
    penumbra::render::render(&prepared.scene, settings, &()).unwrap().film.develop()
}

/// Mean over the picture of channel `channel` of `layer`.
pub fn mean(picture: &Picture, layer: &str, channel: usize) -> f64 {
    let layer = picture.layer(layer).unwrap_or_else(|| panic!("no layer {layer}"));
    let values: Vec<f64> =
        layer.data.iter().skip(channel).step_by(layer.channels.len()).map(|v| f64::from(*v)).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// Asserts that `value` is `expected` to a relative `tolerance`.
pub fn close(what: &str, value: f64, expected: f64, tolerance: f64) {
    let error = (value - expected).abs() / expected.abs().max(1e-12);
    assert!(error <= tolerance, "{what}: {value} instead of {expected}, off by {:.4}%", 100.0 * error);
}
