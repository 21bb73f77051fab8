//! Which lobes a material has, from what was authored: an input of 0 is none, whatever it is of.

use crate::desc::graph::Graph;
use crate::desc::{ClosureDesc, ColorInput, FacetsDesc, MaterialDesc, ScalarInput};

/// A lobe of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lobe {
    Diffuse,
    Reflection,
    Metal,
    Refraction,
    Subsurface,
    Translucent,
    Coat,
    Sheen,
    ThinFilm,
    Stretched,
    Dispersion,
    Toon,
}

/// All of them with their names.
pub(super) const LOBES: &[(Lobe, &str)] = &[
    (Lobe::Diffuse, "diffuse reflection"),
    (Lobe::Reflection, "dielectric reflection"),
    (Lobe::Metal, "metal"),
    (Lobe::Refraction, "refraction"),
    (Lobe::Subsurface, "subsurface walks"),
    (Lobe::Translucent, "diffuse passage"),
    (Lobe::Coat, "coats"),
    (Lobe::Sheen, "sheen"),
    (Lobe::ThinFilm, "thin films"),
    (Lobe::Stretched, "stretched highlights"),
    (Lobe::Dispersion, "dispersion"),
    (Lobe::Toon, "toon"),
];

/// The value of an input that is the same everywhere.
fn known(input: &ScalarInput, graph: &Graph) -> Option<f64> {
    if input.factor == 0.0 {
        return Some(0.0);
    }
    let value = match input.graph {
        Some(value) => graph.known(value)?[0],
        None => 1.0,
    };
    input.texture.is_none().then_some(input.factor * value)
}

fn is_none(input: &ScalarInput, graph: &Graph) -> bool {
    known(input, graph).is_some_and(|value| value <= 0.0)
}

fn is_full(input: &ScalarInput, graph: &Graph) -> bool {
    known(input, graph).is_some_and(|value| value >= 1.0)
}

fn is_black(input: &ColorInput, graph: &Graph) -> bool {
    let factor = input.factor.iter().all(|&c| c == 0.0);
    factor || input.graph.and_then(|v| graph.known(v)).is_some_and(|v| v[..3].iter().all(|&c| c == 0.0))
}

/// The lobes that `material` may show.
pub(super) fn of(material: &MaterialDesc) -> Vec<Lobe> {
    let mut all = Vec::new();
    if material.unlit {
        return all;
    }
    if material.parts.is_empty() {
        layered(material, &material.graph, &mut all);
    }
    for part in material.parts.iter().filter(|part| !is_none(&part.weight, &material.graph)) {
        closure(&part.closure, &material.graph, &mut all);
    }
    all
}

fn layered(m: &MaterialDesc, graph: &Graph, all: &mut Vec<Lobe>) {
    let shows = |input: &ScalarInput| !is_none(input, graph);
    if shows(&m.metallic) {
        all.push(Lobe::Metal);
    }
    if !is_full(&m.metallic, graph) {
        if shows(&m.specular) && (shows(&m.specular_level) || shows(&m.transmission)) {
            all.push(Lobe::Reflection);
        }
        if shows(&m.transmission) {
            all.push(Lobe::Refraction);
            all.extend((m.dispersion > 0.0).then_some(Lobe::Dispersion));
        }
        if !is_full(&m.transmission, graph) {
            let subsurface = m.subsurface.filter(|subsurface| shows(&subsurface.weight));
            all.extend(subsurface.map(|_| Lobe::Subsurface));
            let translucent = m.translucent.filter(|translucent| shows(&translucent.weight));
            all.extend(translucent.map(|_| Lobe::Translucent));
            let all_below = subsurface.is_some_and(|s| is_full(&s.weight, graph));
            if !all_below && !is_black(&m.base_color, graph) {
                all.push(Lobe::Diffuse);
            }
        }
    }
    all.extend(m.coat.filter(|coat| shows(&coat.weight)).map(|_| Lobe::Coat));
    all.extend(m.sheen.filter(|sheen| !is_black(&sheen.color, graph)).map(|_| Lobe::Sheen));
    all.extend(m.iridescence.filter(|film| shows(&film.weight)).map(|_| Lobe::ThinFilm));
    all.extend(m.anisotropy.filter(|stretch| shows(&stretch.strength)).map(|_| Lobe::Stretched));
}

fn closure(closure: &ClosureDesc, graph: &Graph, all: &mut Vec<Lobe>) {
    let facets = |facets: &FacetsDesc| {
        facets.anisotropy.filter(|stretch| !is_none(&stretch.strength, graph)).map(|_| Lobe::Stretched)
    };
    match closure {
        ClosureDesc::Layered(material) => layered(material, graph, all),
        ClosureDesc::Diffuse { .. } => all.push(Lobe::Diffuse),
        ClosureDesc::Beneath { .. } => all.push(Lobe::Subsurface),
        ClosureDesc::Translucent { .. } => all.push(Lobe::Translucent),
        ClosureDesc::Glossy { facets: f, .. } => {
            all.push(Lobe::Reflection);
            all.extend(facets(f));
        }
        ClosureDesc::Metal { facets: f, film, .. } | ClosureDesc::Conductor { facets: f, film, .. } => {
            all.push(Lobe::Metal);
            all.extend(facets(f));
            all.extend(film.map(|_| Lobe::ThinFilm));
        }
        ClosureDesc::Glass { facets: f, film, .. } => {
            all.extend([Lobe::Reflection, Lobe::Refraction]);
            all.extend(facets(f));
            all.extend(film.map(|_| Lobe::ThinFilm));
        }
        ClosureDesc::Refraction { facets: f, .. } => {
            all.push(Lobe::Refraction);
            all.extend(facets(f));
        }
        ClosureDesc::Sheen(_) => all.push(Lobe::Sheen),
        ClosureDesc::Toon { .. } => all.push(Lobe::Toon),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_of_nothing_are_no_lobes() {
        let plain = MaterialDesc { specular: ScalarInput::constant(0.0), ..MaterialDesc::default() };
        assert_eq!(of(&plain), [Lobe::Diffuse]);
        let metal = MaterialDesc { metallic: ScalarInput::constant(1.0), ..MaterialDesc::default() };
        assert_eq!(of(&metal), [Lobe::Metal]);
        let glass = MaterialDesc { transmission: ScalarInput::constant(1.0), ..MaterialDesc::default() };
        assert_eq!(of(&glass), [Lobe::Reflection, Lobe::Refraction]);
        assert!(of(&MaterialDesc { unlit: true, ..glass }).is_empty());
    }

    #[test]
    fn a_graph_that_is_known_to_be_zero_is_none() {
        let mut material = MaterialDesc::default();
        let zero = material.graph.number(0.0);
        material.transmission = ScalarInput::graph(zero);
        assert!(!of(&material).contains(&Lobe::Refraction));
        let one = material.graph.number(1.0);
        material.transmission = ScalarInput::graph(one);
        assert!(of(&material).contains(&Lobe::Refraction) && !of(&material).contains(&Lobe::Diffuse));
    }
}
