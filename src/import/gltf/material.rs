//! Materials: metallic-roughness and its KHR extensions, field by field.

use super::covered::cover;
use super::document::label;
use super::json::{Material, MetallicRoughness, SpecularGlossiness, TextureInfo};
use super::texture::Lookup;
use crate::desc::{
    AlphaMode, AnisotropyDesc, AnisotropyLaw, Channel, CoatDesc, ColorInput, ColorSpace, IridescenceDesc, MaterialDesc,
    NormalInput, ScalarInput, SheenDesc, TranslucentDesc, VolumeDesc,
};
use crate::error::{Place, Warnings};

/// Reflectance at normal incidence of a dielectric of index 1.5.
const F0_OF_1_5: f64 = 0.04;

/// Converts the material at `index`; `None` for the material of primitives that name none.
pub(super) fn convert(
    index: Option<usize>,
    json: &Material,
    textures: &mut Lookup<'_>,
    place: &Place,
    warnings: &mut Warnings,
) -> MaterialDesc {
    let (name, here, material_index) = match index {
        Some(i) => {
            let name = json.name.clone().filter(|name| !name.is_empty()).unwrap_or_else(|| format!("material_{i}"));
            (name, place.at(label("material", i, json.name.as_deref())), i as u32 + 1)
        }
        None => ("default".into(), place.at("default material"), 0),
    };
    let mut material = Converter { textures, place: &here, warnings }.material(json);
    material.name = name.into();
    material.material_index = material_index;
    material.place = here;
    material
}

struct Converter<'a, 'b> {
    textures: &'a mut Lookup<'b>,
    place: &'a Place,
    warnings: &'a mut Warnings,
}

impl Converter<'_, '_> {
    fn material(&mut self, json: &Material) -> MaterialDesc {
        let x = &json.extensions;
        let cutoff = json.alpha_cutoff;
        let mut material = MaterialDesc {
            alpha_mode: match json.alpha_mode.as_deref() {
                Some("MASK") => AlphaMode::Mask { cutoff },
                Some("BLEND") => AlphaMode::Blend,
                _ => AlphaMode::Opaque,
            },
            double_sided: json.double_sided,
            // Bad numbers stay: they are mended and told where the light is prepared.
            emission: ColorInput::textured(
                json.emissive_factor,
                self.textures.get(json.emissive_texture.as_ref(), ColorSpace::Srgb),
            ),
            emission_strength: x.emissive_strength.as_ref().map_or(1.0, |e| e.emissive_strength),
            normal: self.normal(json.normal_texture.as_ref()),
            occlusion: json.occlusion_texture.as_ref().and_then(|info| {
                let texture = self.textures.get(Some(info), ColorSpace::Linear)?;
                let strength = self.unit(info.strength, "occlusion strength");
                Some(ScalarInput::textured(strength, Some((texture, Channel::R))))
            }),
            unlit: x.unlit.is_some(),
            dispersion: x.dispersion.as_ref().map_or(0.0, |d| d.dispersion.max(0.0)),
            ..MaterialDesc::default()
        };
        self.metallic_roughness(&json.pbr_metallic_roughness, &mut material);
        self.dielectric(json, &mut material);
        self.layers(json, &mut material);
        if let Some(old) = &x.specular_glossiness {
            self.specular_glossiness(old, &mut material);
        }
        cover(&mut material);
        material
    }

    fn metallic_roughness(&mut self, pbr: &MetallicRoughness, material: &mut MaterialDesc) {
        let [r, g, b, a] = pbr.base_color_factor;
        let base = pbr.base_color_texture.as_ref();
        material.base_color = self.unit_color([r, g, b], base, "base color");
        material.alpha = self.alpha(a, base);
        let packed = pbr.metallic_roughness_texture.as_ref();
        material.metallic = self.scalar(pbr.metallic_factor, packed, Channel::B, "metallic");
        material.roughness = self.scalar(pbr.roughness_factor, packed, Channel::G, "roughness");
    }

    fn dielectric(&mut self, json: &Material, material: &mut MaterialDesc) {
        let x = &json.extensions;
        if let Some(specular) = &x.specular {
            material.specular =
                self.scalar(specular.specular_factor, specular.specular_texture.as_ref(), Channel::A, "specular");
            material.specular_color =
                self.color(specular.specular_color_factor, specular.specular_color_texture.as_ref());
        }
        match x.ior.as_ref().map(|ior| ior.ior) {
            // "An ior of 0": reflectance 1 times the specular colour, the bridge from
            // specular-glossiness. The same reflectance at index 1.5 takes a colour of 1/0.04.
            Some(0.0) => {
                for c in &mut material.specular_color.factor {
                    *c /= F0_OF_1_5;
                }
            }
            Some(ior) if ior >= 1.0 => material.ior = ScalarInput::constant(ior),
            Some(ior) => {
                self.warnings.push(self.place, format!("index of refraction {ior} is below 1; 1 is used"));
                material.ior = ScalarInput::constant(1.0);
            }
            None => {}
        }
        if let Some(t) = &x.transmission {
            let texture = t.transmission_texture.as_ref();
            material.transmission = self.scalar(t.transmission_factor, texture, Channel::R, "transmission");
        }
        if let Some(t) = &x.diffuse_transmission {
            let [share, color] = [&t.diffuse_transmission_texture, &t.diffuse_transmission_color_texture];
            material.translucent = Some(TranslucentDesc {
                weight: self.scalar(t.diffuse_transmission_factor, share.as_ref(), Channel::A, "diffuse transmission"),
                color: self.unit_color(
                    t.diffuse_transmission_color_factor,
                    color.as_ref(),
                    "diffuse transmission color",
                ),
            });
        }
        if let Some(volume) = &x.volume {
            let thickness = volume.thickness_texture.as_ref();
            let distance = volume.attenuation_distance.filter(|d| *d > 0.0).unwrap_or(f64::INFINITY);
            material.volume = Some(VolumeDesc {
                thickness: self.linear(volume.thickness_factor.max(0.0), thickness, Channel::G),
                attenuation_distance: distance,
                attenuation_color: volume.attenuation_color.map(|c| self.unit(c, "attenuation color")),
                adds: false,
            });
        }
    }

    fn layers(&mut self, json: &Material, material: &mut MaterialDesc) {
        let x = &json.extensions;
        material.coat = x.clearcoat.as_ref().map(|coat| CoatDesc {
            weight: self.scalar(coat.clearcoat_factor, coat.clearcoat_texture.as_ref(), Channel::R, "clearcoat"),
            roughness: self.scalar(
                coat.clearcoat_roughness_factor,
                coat.clearcoat_roughness_texture.as_ref(),
                Channel::G,
                "clearcoat roughness",
            ),
            ior: ScalarInput::constant(1.5),
            tint: ColorInput::constant([1.0; 3]),
            normal: self.normal(coat.clearcoat_normal_texture.as_ref()),
        });
        material.sheen = x.sheen.as_ref().map(|sheen| SheenDesc {
            color: self.unit_color(sheen.sheen_color_factor, sheen.sheen_color_texture.as_ref(), "sheen color"),
            roughness: self.scalar(
                sheen.sheen_roughness_factor,
                sheen.sheen_roughness_texture.as_ref(),
                Channel::A,
                "sheen roughness",
            ),
        });
        material.iridescence = x.iridescence.as_ref().map(|film| IridescenceDesc {
            weight: self.scalar(film.iridescence_factor, film.iridescence_texture.as_ref(), Channel::R, "iridescence"),
            ior: ScalarInput::constant(film.iridescence_ior.max(1.0)),
            thickness_min: film.iridescence_thickness_minimum.max(0.0),
            thickness_max: film.iridescence_thickness_maximum.max(0.0),
            thickness: self.scalar(
                1.0,
                film.iridescence_thickness_texture.as_ref(),
                Channel::G,
                "iridescence thickness",
            ),
            on_metal: true,
        });
        material.anisotropy = x.anisotropy.as_ref().map(|a| AnisotropyDesc {
            strength: ScalarInput::constant(self.unit(a.anisotropy_strength, "anisotropy strength")),
            rotation: ScalarInput::constant(a.anisotropy_rotation),
            texture: self.textures.get(a.anisotropy_texture.as_ref(), ColorSpace::Linear),
            tangent: None,
            law: AnisotropyLaw::Gltf,
        });
    }

    /// KHR_materials_pbrSpecularGlossiness as a dielectric of index 1.5 whose reflectance at normal
    /// incidence, 0.04 × specular colour, is the specular factor.
    fn specular_glossiness(&mut self, old: &SpecularGlossiness, material: &mut MaterialDesc) {
        let [r, g, b, a] = old.diffuse_factor;
        let diffuse = old.diffuse_texture.as_ref();
        material.base_color = self.unit_color([r, g, b], diffuse, "diffuse");
        material.alpha = self.alpha(a, diffuse);
        material.metallic = ScalarInput::constant(0.0);
        material.ior = ScalarInput::constant(1.5);
        material.specular = ScalarInput::constant(1.0);
        let specular = old.specular_factor.map(|c| self.unit(c, "specular") / F0_OF_1_5);
        material.specular_color = self.color(specular, old.specular_glossiness_texture.as_ref());
        material.roughness = ScalarInput::constant(1.0 - self.unit(old.glossiness_factor, "glossiness"));
        if old.specular_glossiness_texture.as_ref().is_some_and(|info| info.index.is_some()) {
            let what = "KHR_materials_pbrSpecularGlossiness: the texture's glossiness is left out, its factor is used";
            self.warnings.push(self.place, what);
        }
    }

    fn color(&mut self, factor: [f64; 3], texture: Option<&TextureInfo>) -> ColorInput {
        ColorInput::textured(factor.map(|c| c.max(0.0)), self.textures.get(texture, ColorSpace::Srgb))
    }

    fn unit_color(&mut self, factor: [f64; 3], texture: Option<&TextureInfo>, what: &str) -> ColorInput {
        let factor = factor.map(|c| self.unit(c, what));
        self.color(factor, texture)
    }

    /// Alpha shares the colour's texture; the transfer function leaves it alone.
    fn alpha(&mut self, factor: f64, texture: Option<&TextureInfo>) -> ScalarInput {
        let texture = self.textures.get(texture, ColorSpace::Srgb);
        ScalarInput::textured(self.unit(factor, "alpha"), texture.map(|texture| (texture, Channel::A)))
    }

    fn scalar(&mut self, factor: f64, texture: Option<&TextureInfo>, channel: Channel, what: &str) -> ScalarInput {
        let factor = self.unit(factor, what);
        self.linear(factor, texture, channel)
    }

    fn linear(&mut self, factor: f64, texture: Option<&TextureInfo>, channel: Channel) -> ScalarInput {
        let texture = self.textures.get(texture, ColorSpace::Linear);
        ScalarInput::textured(factor, texture.map(|texture| (texture, channel)))
    }

    fn normal(&mut self, info: Option<&TextureInfo>) -> Option<NormalInput> {
        let texture = self.textures.get(info, ColorSpace::Linear)?;
        Some(NormalInput::Map { texture, scale: info?.scale })
    }

    /// `value` held to 0 to 1, with a warning where that changes it.
    fn unit(&mut self, value: f64, what: &str) -> f64 {
        let clamped = value.clamp(0.0, 1.0);
        if clamped != value {
            self.warnings.push(self.place, format!("{what} {value} is outside of 0 to 1; {clamped} is used"));
        }
        clamped
    }
}
