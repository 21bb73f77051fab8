//! Visibility, purpose, units and the up axis.

use penumbra::import::{ImportOptions, Purpose};

use super::{load, try_load};

fn showing(purposes: &[Purpose]) -> ImportOptions {
    ImportOptions { purposes: Some(purposes.to_vec()), ..ImportOptions::default() }
}

#[test]
fn purposes_are_shown_as_asked() {
    let paths = |purposes: &[Purpose]| {
        let loaded = load("shown.usda", &showing(purposes));
        loaded.paths().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    // What usdview shows for the same choices; the invisible mesh in none.
    let default = ["/Set/Proxy/AsDefault", "/Set/Reset"];
    assert_eq!(paths(&[]), default);
    assert_eq!(paths(&[Purpose::Render]), ["/Set/Render/T", default[0], default[1]]);
    assert_eq!(paths(&[Purpose::Proxy]), ["/Set/Proxy/T", default[0], default[1]]);
    assert_eq!(paths(&[Purpose::Guide]), [default[0], "/Set/Guide", default[1]]);
}

#[test]
fn the_world_is_y_up_in_metres() {
    let loaded = load("shown.usda", &showing(&[Purpose::Render]));
    // (100, 200, 300) centimetres, z up.
    assert_eq!(loaded.origin("/Set/Render/T"), [1.0, 3.0, -2.0]);
    // !resetXformStack! leaves out the parents, not the units of the stage.
    assert_eq!(loaded.origin("/Set/Reset"), [0.01, 0.03, -0.02]);
}

/// A stage whose render settings say `lines`, read as `options` say: what is shown, with its material.
fn with_settings(lines: &str, options: &ImportOptions) -> (Vec<(String, String)>, Vec<String>) {
    let mesh = r#"int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
            uniform token subdivisionScheme = "none""#;
    let material = |name: &str| {
        format!(
            "def Material \"{name}\" {{
                token outputs:surface.connect = </Looks/{name}/S.outputs:surface>
                def Shader \"S\" {{
                    uniform token info:id = \"UsdPreviewSurface\"
                    token outputs:surface
                }}
            }}"
        )
    };
    let names = ["Full", "Preview", "All"].map(material).join("\n");
    let text = format!(
        "#usda 1.0
        ( metersPerUnit = 1 upAxis = \"Y\" renderSettingsPrimPath = \"/Settings\" )
        def RenderSettings \"Settings\" {{
            {lines}
        }}
        def Scope \"Looks\" {{
            {names}
        }}
        def Mesh \"Default\" ( prepend apiSchemas = [\"MaterialBindingAPI\"] ) {{
            rel material:binding = </Looks/All>
            rel material:binding:full = </Looks/Full>
            rel material:binding:preview = </Looks/Preview>
            {mesh}
        }}
        def Mesh \"Render\" {{
            uniform token purpose = \"render\"
            {mesh}
        }}
        def Mesh \"Proxy\" {{
            uniform token purpose = \"proxy\"
            {mesh}
        }}
        "
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stage.usda");
    std::fs::write(&path, text).unwrap();
    let loaded = try_load(&path, options).unwrap();
    let shown = loaded.paths().into_iter().map(|path| (path[1..].to_string(), loaded.material(path).to_string()));
    (shown.collect(), loaded.said.clone())
}

#[test]
fn the_purposes_of_render_settings_count_where_the_command_line_is_silent() {
    let silent = ImportOptions::default();
    let shown = |lines: &str, options: &ImportOptions| {
        let (shown, said) = with_settings(lines, options);
        assert!(said.is_empty(), "{said:?}");
        shown.into_iter().map(|(path, material)| format!("{path} {material}")).collect::<Vec<_>>()
    };
    let grey = "displayColor";
    assert_eq!(shown("", &silent), ["Default Full".to_string(), format!("Render {grey}")]);
    let proxies = "uniform token[] includedPurposes = [\"default\", \"proxy\"]";
    assert_eq!(shown(proxies, &silent), ["Default Full".to_string(), format!("Proxy {grey}")]);
    assert_eq!(shown(proxies, &showing(&[Purpose::Render])), ["Default Full".to_string(), format!("Render {grey}")]);
    for (purposes, material) in
        [("\"full\", \"\"", "Full"), ("\"preview\", \"\"", "Preview"), ("\"\"", "All"), ("\"mine\"", grey)]
    {
        let lines = format!("uniform token[] materialBindingPurposes = [{purposes}]");
        assert_eq!(shown(&lines, &silent)[0], format!("Default {material}"));
    }
}

#[test]
fn purposes_that_can_t_be_honoured_are_told() {
    let lines = "uniform token[] includedPurposes = [\"proxy\", \"ornament\"]";
    let (shown, said) = with_settings(lines, &ImportOptions::default());
    assert_eq!(shown.iter().map(|(path, _)| path.as_str()).collect::<Vec<_>>(), ["Default", "Proxy"]);
    assert!(said.iter().any(|said| said.contains("/Settings: includedPurposes leaves out default")), "{said:?}");
    assert!(said.iter().any(|said| said.contains("names \"ornament\"")), "{said:?}");
}
