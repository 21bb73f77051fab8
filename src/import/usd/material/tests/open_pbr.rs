//! MaterialX' open_pbr_surface.

use super::materialx::reflected;
use super::*;
use crate::desc::AnisotropyLaw;

#[test]
fn open_pbr_of_blender() {
    let read = mtlx(
        "ND_open_pbr_surface_surfaceshader",
        "float inputs:coat_weight = 0.5
         float inputs:coat_ior = 1.5
         float inputs:coat_darkening
         float inputs:emission_luminance = 3
         float inputs:fuzz_weight = 0.4
         float inputs:geometry_opacity = 0.5
         float3 inputs:geometry_normal
         float inputs:specular_roughness_anisotropy = 0.21
         float3 inputs:geometry_tangent.connect = </m/turned.outputs:out>
         float inputs:subsurface_weight = 0.2
         float inputs:thin_film_thickness = 0.3
         float inputs:thin_film_weight = 1",
        "def Shader \"turned\" { uniform token info:id = \"ND_rotate3d_vector3\"
            float inputs:amount = -90
            float3 inputs:in.connect = </m/t.outputs:out>
            float3 outputs:out }
         def Shader \"t\" { uniform token info:id = \"ND_tangent_vector3\"
            float3 outputs:out }",
    );
    let m = read.material();
    same(&[m.sheen.unwrap().color.factor[0], m.alpha.factor], &[0.4, 0.5]);
    let emission = value_of(m, m.emission.graph.unwrap(), &[]);
    same(&emission[..3], &[3.0 * (1.0 - 0.5 * reflected(1.5)); 3]);
    same(&[m.iridescence.unwrap().thickness.factor, m.coat.unwrap().ior.factor], &[300.0, 1.5]);
    let anisotropy = m.anisotropy.unwrap();
    same(&[anisotropy.strength.factor, anisotropy.rotation.factor], &[0.21, std::f64::consts::FRAC_PI_2]);
    assert_eq!(anisotropy.law, AnisotropyLaw::OpenPbr);
    let beneath = m.subsurface.unwrap();
    same(&[beneath.weight.factor, beneath.anisotropy.factor, beneath.ior.factor], &[0.2, 0.0, 1.5]);
    // Of the stage's units, centimetres.
    same(&beneath.radius.factor, &[0.01, 0.005, 0.0025]);
    assert_eq!(beneath.method, crate::desc::SubsurfaceMethod::FreePath);
    assert_eq!(read.warnings, "");
}

/// `effective_specular_roughness` and `eta_s`; light that gets inside is bent as it would be without the coat.
#[test]
fn a_coat_of_open_pbr_changes_what_is_beneath() {
    let id = "ND_open_pbr_surface_surfaceshader";
    let coat = "float inputs:coat_weight = 1
        float inputs:coat_roughness = 0.5
        float inputs:coat_ior = 1.2
        float inputs:specular_roughness = 0.3
        float inputs:specular_weight = 0.5";
    let lacquered = mtlx(id, coat, "");
    let m = lacquered.material();
    let roughness = (0.3_f64.powi(4) + 2.0 * 0.5_f64.powi(4)).powf(0.25);
    assert!((roughness - 0.604).abs() < 5e-4);
    same(&[m.roughness.factor, m.ior.factor, m.specular_level.factor, m.specular.factor], &[roughness, 1.25, 0.5, 1.0]);
    let half = mtlx(id, &coat.replace("coat_weight = 1", "coat_weight = 0.5"), "");
    same(&[half.material().roughness.factor, half.material().ior.factor], &[0.5 * (0.3 + roughness), 1.375]);
    // The reciprocal of what is below 1.
    let denser = mtlx(id, &coat.replace("1.2", "1.8"), "");
    same(&[denser.material().ior.factor], &[1.2]);
    let f0 = |ior: f64| ((ior - 1.0) / (ior + 1.0)).powi(2);
    let root = (0.5 * f0(1.5)).sqrt();
    let relative = f0(1.25) / f0(1.5);
    for (inside, index, weight) in [("transmission", (1.0 + root) / (1.0 - root), 1.0), ("subsurface", 1.5, 0.5)] {
        let read = mtlx(id, &format!("{coat}\nfloat inputs:{inside}_weight = 1"), "");
        let (ior, level) = (read.material().ior.factor, read.material().specular_level.factor);
        same(&[ior, level], &[index, weight * relative]);
    }
}

/// The Principled BSDF that Blender has filled the node with knows none of that.
#[test]
fn open_pbr_written_by_blender_is_its_principled() {
    let lines = "float inputs:coat_weight = 0.5
        float inputs:coat_roughness = 0.5
        float inputs:base_metalness = 0.5
        color3f inputs:base_color = (0.8, 0.6, 0.4)
        color3f inputs:specular_color = (1, 0.5, 0.2)
        float inputs:specular_roughness = 0.3
        float inputs:specular_roughness_anisotropy = 0.35
        float inputs:specular_weight = 0.6";
    let text = material_of("mtlx:", "ND_open_pbr_surface_surfaceshader", lines, "");
    let folder = tempfile::tempdir().unwrap();
    let read = read_at(folder.path(), &format!("(\n doc = \"Blender v5.0.1\"\n)\n{text}"), "/m");
    let m = read.material();
    same(&[m.specular_level.factor, m.specular.factor, m.ior.factor, m.roughness.factor], &[0.6, 1.0, 1.5, 0.3]);
    same(&m.base_color.factor, &[0.8, 0.6, 0.4]);
    same(&m.metal_edge.factor, &[1.0, 0.5, 0.2]);
    let anisotropy = m.anisotropy.unwrap();
    same(&[anisotropy.strength.factor], &[0.5]);
    assert_eq!(anisotropy.law, AnisotropyLaw::Aspect);
}
