//! Which light a shading point samples, and which lamps a ray meets.

use std::collections::HashMap;
use std::sync::Arc;

use super::choice::Selection;
use super::{Choice, Emitter, EmitterHit, Light, LightBounds, LightTree, Receiver, Seen, Strategy};
use crate::math::{Bounds, Vec3};

/// Up to so many lamps are asked one by one whether a ray meets them.
const FEW_LAMPS: usize = 8;

/// The choice for each class of receivers; classes that the same lights reach share one.
type ByClass = Vec<Arc<Selection>>;

/// All lights of a scene and the choice among them.
#[derive(Clone, Debug, Default)]
pub struct LightSet {
    lights: Vec<Light>,
    /// Indices of the lights that the background shows.
    background: Vec<u32>,
    /// Indices of the lights with a shape of their own, growing.
    lamps: Vec<u32>,
    /// Over `lamps`, where they are many.
    lamp_tree: Option<Arc<LightTree>>,
    selections: ByClass,
    /// For each light group the choice among its lights alone; empty where none is asked for.
    of_groups: Vec<ByClass>,
}

impl LightSet {
    /// The lights of a scene whose box is `scene` and whose receivers are of `classes` classes.
    pub fn new(lights: Vec<Light>, scene: Bounds, classes: usize) -> Self {
        Self::chosen_by(Strategy::Tree, lights, scene, classes, &[])
    }

    /// The same, with lights chosen by `strategy`; for each of the light groups `of_groups` says whether
    /// a light for diffuse reflection can be chosen in it alone.
    pub fn chosen_by(
        strategy: Strategy,
        lights: Vec<Light>,
        scene: Bounds,
        classes: usize,
        of_groups: &[bool],
    ) -> Self {
        let those = |test: &dyn Fn(&Light) -> bool| -> Vec<u32> {
            (0..lights.len() as u32).filter(|&i| test(&lights[i as usize])).collect()
        };
        let background = those(&|light| light.emitter.in_background());
        let lamps = those(&|light| light.emitter.is_lamp());
        let lamp_tree = tree_of(&lights, &lamps).map(Arc::new);
        let mut known: HashMap<Vec<u32>, Arc<Selection>> = HashMap::new();
        let mut by_class = |test: &dyn Fn(&Light) -> bool| -> ByClass {
            let of_class = |class: usize| {
                let members = those(&|light| light.rules.lights(class as u16) && test(light));
                let selection = known
                    .entry(members)
                    .or_insert_with_key(|members| Arc::new(Selection::new(&lights, members.clone(), scene, strategy)));
                selection.clone()
            };
            (0..classes.clamp(1, 1 << 16)).map(of_class).collect()
        };
        // A light that only the camera sees lights nothing.
        let scatters = |seen: &Seen| seen.diffuse || seen.glossy || seen.transmission;
        let selections = by_class(&|light| scatters(&light.rules.seen));
        let is_of = |light: &Light, group: usize| light.rules.group.map(usize::from) == Some(group);
        let mut of_group = |group: usize| by_class(&|light| is_of(light, group) && light.rules.seen.diffuse);
        let of_groups =
            of_groups.iter().enumerate().map(|(i, asked)| if *asked { of_group(i) } else { Vec::new() }).collect();
        Self { lights, background, lamps, lamp_tree, selections, of_groups }
    }

    /// True where nothing shines.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// How many lights there are.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Light `i`.
    pub fn get(&self, i: u32) -> &Light {
        &self.lights[i as usize]
    }

    /// All lights, in the order of their indices.
    pub fn iter(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter()
    }

    /// Lights that a ray which leaves the scene may see, with their indices.
    pub fn background(&self) -> impl Iterator<Item = (u32, &Light)> {
        self.background.iter().map(|&i| (i, self.get(i)))
    }

    /// True where some light has a shape of its own that rays may meet.
    pub fn has_lamps(&self) -> bool {
        !self.lamps.is_empty()
    }

    /// Calls `visit` with every lamp that the ray from `p` along the unit direction `wi` meets at a
    /// distance of `range`, in an order that depends on the scene and the ray alone.
    pub fn lamps_along(&self, p: Vec3, wi: Vec3, range: [f32; 2], mut visit: impl FnMut(u32, &Light, &EmitterHit)) {
        let mut ask = |i: u32| {
            let light = self.get(i);
            if let Some(hit) = light.emitter.hit(p, wi).filter(|hit| (range[0]..range[1]).contains(&hit.dist)) {
                visit(i, light, &hit);
            }
        };
        match &self.lamp_tree {
            Some(tree) => tree.along(p, wi, range[1], |item| ask(self.lamps[item as usize])),
            None => self.lamps.iter().copied().for_each(ask),
        }
    }

    /// Chooses a light for `at` by `u`; `None` where none can reach it.
    pub fn choose(&self, at: &Receiver, u: f32) -> Option<Choice> {
        self.selections.get(usize::from(at.class))?.choose(&self.lights, at, u)
    }

    /// Chooses a light of `group` for `at` by `u`; `None` where none of them can reach it.
    pub fn choose_of_group(&self, group: usize, at: &Receiver, u: f32) -> Option<Choice> {
        self.of_groups.get(group)?.get(usize::from(at.class))?.choose(&self.lights, at, u)
    }

    /// Probability with which [`LightSet::choose`] at `at` chooses `light`.
    pub fn pmf(&self, at: &Receiver, light: u32) -> f32 {
        self.selections.get(usize::from(at.class)).map_or(0.0, |selection| selection.pmf(&self.lights, at, light))
    }

    /// Density in solid angle with which light sampling at `at` finds `light` along `wi`.
    pub fn pdf_li(&self, at: &Receiver, light: u32, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let pdf = self.get(light).emitter.pdf_li(at, wi, hit);
        if pdf > 0.0 { pdf * self.pmf(at, light) } else { 0.0 }
    }
}

/// The tree over many lamps; `None` for a few, or where one of them has no bounds.
fn tree_of(lights: &[Light], lamps: &[u32]) -> Option<LightTree> {
    if lamps.len() <= FEW_LAMPS {
        return None;
    }
    // A lamp that rays alone can find is in the tree, too.
    let bounds = |&i: &u32| {
        let bounds = lights[i as usize].emitter.bounds()?;
        Some(LightBounds { intensity: bounds.intensity.max(f32::MIN_POSITIVE), ..bounds })
    };
    LightTree::new(&lamps.iter().map(bounds).collect::<Option<Vec<_>>>()?)
}
