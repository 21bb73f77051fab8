//! The node hierarchy: world transforms, paths and what is visible, without recursion.

use std::sync::Arc;

use super::extras::Penumbra;
use super::json::{Node, Root};
use crate::error::{Place, Warnings};
use crate::math::{DAffine3, DMat3, DQuat, DVec3};

/// Longest node path that is written out; deeper nodes show the end of theirs.
const LONGEST_PATH: usize = 512;

/// A node in the scene.
pub(super) struct PlacedNode {
    /// Index of the node in the file.
    pub node: usize,
    /// Node to world.
    pub world: DAffine3,
    /// The node's own name, or a substitute.
    pub name: Arc<str>,
    /// File and path of names from the root.
    pub place: Place,
    /// Name of the topmost ancestor.
    pub asset: Arc<str>,
    /// How many ancestors it has.
    pub depth: u32,
}

/// The scene's nodes, and the world transforms of all nodes, which skins use.
pub(super) struct Hierarchy {
    /// Visible nodes of the scene, parents before children, in the order of the file.
    pub nodes: Vec<PlacedNode>,
    /// Node to world for each node of the file; `None` for those that no root leads to.
    pub world: Vec<Option<DAffine3>>,
    /// Lights at nodes that would be visible if they could be placed.
    pub lights_left_out: usize,
}

/// A node to visit.
struct Visit {
    node: usize,
    parent: Option<Arc<Ancestor>>,
    world: DAffine3,
    /// Part of the scene and not hidden.
    shown: bool,
    /// False at and below a node that can't be placed.
    placed: bool,
    depth: u32,
}

/// What children take from their parent.
struct Ancestor {
    path: String,
    asset: Arc<str>,
}

/// Walks the default scene; then what is left, out of sight, for the joints of skins.
pub(super) fn walk(root: &Root, place: &Place, warnings: &mut Warnings) -> Hierarchy {
    let count = root.nodes.len();
    let mut hierarchy = Hierarchy { nodes: Vec::new(), world: vec![None; count], lights_left_out: 0 };
    let mut has_parent = vec![false; count];
    for &child in root.nodes.iter().flat_map(|node| &node.children) {
        if let Some(flag) = has_parent.get_mut(child) {
            *flag = true;
        }
    }
    let parentless = || (0..count).filter(|&i| !has_parent[i]);
    let scene = root.scene.unwrap_or(0);
    let roots: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.clone(),
        None => {
            if root.scene.is_some() {
                let what = format!("scene {scene} of {} does not exist; every root node is read", root.scenes.len());
                warnings.push(place, what);
            }
            parentless().collect()
        }
    };
    hierarchy.visit(root, &roots, true, place, warnings);
    let rest: Vec<usize> = parentless().filter(|&i| hierarchy.world[i].is_none()).collect();
    hierarchy.visit(root, &rest, false, place, &mut Warnings::new());
    hierarchy
}

impl Hierarchy {
    fn visit(&mut self, root: &Root, roots: &[usize], shown: bool, place: &Place, warnings: &mut Warnings) {
        let mut stack: Vec<Visit> = Vec::new();
        for &node in roots.iter().rev() {
            stack.push(Visit { node, parent: None, world: DAffine3::IDENTITY, shown, placed: true, depth: 0 });
        }
        while let Some(visit) = stack.pop() {
            let Some(node) = root.nodes.get(visit.node) else {
                let what = format!("a child names node {} of {}; it is left out", visit.node, root.nodes.len());
                warnings.push(place, what);
                continue;
            };
            let name = name(root, visit.node);
            let path = match &visit.parent {
                None => name.clone(),
                Some(parent) if parent.path.len() + name.len() > LONGEST_PATH => format!("…/{name}"),
                Some(parent) => format!("{}/{name}", parent.path),
            };
            if self.world[visit.node].is_some() {
                let what = "the node has two parents or is its own ancestor; it is kept where it was met first";
                warnings.push(&place.at(&path), what);
                continue;
            }
            let here = place.at(&path);
            let world = visit.world * local(node, &here, warnings);
            self.world[visit.node] = Some(world);
            let shown = visit.shown && node.extensions.visibility.as_ref().is_none_or(|v| v.visible);
            let placed = visit.placed && usable(&world);
            if shown && !placed {
                let light = Penumbra::read(&node.extras, &here, &mut Warnings::new()).gives_light(node);
                self.lights_left_out += usize::from(light);
                if visit.placed {
                    let what = "the transform is singular or not finite; the node and its children are left out";
                    warnings.push(&here, what);
                } else if light {
                    warnings.push(&here, "the light is left out with the node above it that can't be placed");
                }
            }
            let name: Arc<str> = name.into();
            let asset = visit.parent.as_ref().map_or_else(|| name.clone(), |parent| parent.asset.clone());
            if shown && placed {
                let asset = asset.clone();
                self.nodes.push(PlacedNode { node: visit.node, world, name, place: here, asset, depth: visit.depth });
            }
            if !node.children.is_empty() {
                let parent = Arc::new(Ancestor { path, asset });
                for &child in node.children.iter().rev() {
                    let parent = Some(parent.clone());
                    stack.push(Visit { node: child, parent, world, shown, placed, depth: visit.depth + 1 });
                }
            }
        }
    }
}

/// A name for the node: its own, that of its mesh, or one made of its index.
fn name(root: &Root, index: usize) -> String {
    let node = &root.nodes[index];
    let own = node.name.as_deref().filter(|name| !name.is_empty());
    let mesh = || node.mesh.and_then(|mesh| root.meshes.get(mesh)?.name.as_deref()).filter(|name| !name.is_empty());
    own.or_else(mesh).map_or_else(|| format!("node_{index}"), str::to_owned)
}

/// Node to parent.
fn local(node: &Node, place: &Place, warnings: &mut Warnings) -> DAffine3 {
    let Some(m) = node.matrix else {
        return from_trs(
            node.translation.unwrap_or_default(),
            node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            node.scale.unwrap_or([1.0; 3]),
        );
    };
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        warnings.push(place, "the matrix has a projective row; its affine part is used");
    }
    let column = |c: usize| DVec3::new(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
    DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3))
}

/// Translation · rotation · scale; the rotation is a quaternion x y z w of any length but 0.
pub(super) fn from_trs(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> DAffine3 {
    let q = DQuat::from_array(rotation);
    let q = if q.length_squared() > 0.0 && q.is_finite() { q.normalize() } else { DQuat::IDENTITY };
    DAffine3::from_scale_rotation_translation(scale.into(), q, translation.into())
}

/// True where `world` is finite, also in single precision, and has an inverse.
pub(super) fn usable(world: &DAffine3) -> bool {
    let m = world.matrix3;
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let in_range = world.to_cols_array().iter().all(|v| v.abs() < 1e30);
    in_range && size > 1e-60 && m.determinant().abs() > 1e-12 * size
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk_json(json: &str) -> (Hierarchy, Warnings) {
        let root: Root = serde_json::from_str(json).unwrap();
        let mut warnings = Warnings::new();
        (walk(&root, &Place::file("a.gltf"), &mut warnings), warnings)
    }

    #[test]
    fn transforms_compose_and_paths_name_every_ancestor() {
        let (h, warnings) = walk_json(
            r#"{"nodes":[{"name":"A","children":[1],"scale":[2,2,2]},{"translation":[1,0,0],"children":[2]},{"name":"C"}]}"#,
        );
        assert!(warnings.is_empty());
        assert_eq!(h.nodes[2].place.node.as_deref(), Some("A/node_1/C"));
        assert_eq!(&*h.nodes[2].asset, "A");
        assert_eq!(h.nodes[2].world.translation, DVec3::new(2.0, 0.0, 0.0));
    }

    #[test]
    fn cycles_end_and_are_told() {
        let json = r#"{"scenes":[{"nodes":[0]}],"nodes":[{"name":"A","children":[1]},{"name":"B","children":[0]}]}"#;
        let (h, warnings) = walk_json(json);
        assert_eq!((h.nodes.len(), warnings.len()), (2, 1));
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_nodes_is_walked() {
        let count = 100_000;
        let nodes: Vec<String> = (0..count).map(|i| format!(r#"{{"children":[{}]}}"#, i + 1)).collect();
        let (h, _) = walk_json(&format!(r#"{{"nodes":[{},{{}}]}}"#, nodes.join(",")));
        assert_eq!(h.nodes.len(), count + 1);
    }

    #[test]
    fn singular_nodes_are_left_out_with_their_children() {
        let (h, warnings) = walk_json(
            r#"{"nodes":[{"name":"flat","scale":[1,0,1],"children":[1]},{},{"scale":[-1,1,1]},{"scale":[1e-9,1e-9,1e-9]}]}"#,
        );
        assert_eq!(h.nodes.iter().map(|n| n.node).collect::<Vec<_>>(), [2, 3]);
        assert_eq!(warnings.len(), 1);
        assert!(warnings.iter().next().unwrap().to_string().contains("flat"));
    }
}
