//! Skeletons and blend shapes. That points, normals and transforms are OpenUSD's is held by
//! `tests/python/test_usd_core.py`.

use penumbra::desc::ShapeRef;
use penumbra::import::ImportOptions;

use super::{Loaded, at_frame, load};

fn points(loaded: &Loaded, path: &str) -> Vec<[f32; 3]> {
    loaded.scene.mesh(loaded.one(path)).expect("a mesh").points.clone()
}

#[test]
fn what_is_wrong_is_told_and_stands_as_modelled_or_by_the_rest_pose() {
    let loaded = load("skel_bad.usda", &ImportOptions::default());
    let told = [
        "/Bad/Misordered: joint a/b comes before its parent; what follows the skeleton is as modelled",
        "/Bad/ShortBind: has 1 bindTransforms for 2 joints; what follows the skeleton is as modelled",
        "/Bad/SingularBind: the bindTransform of joint a/b is singular; what follows the skeleton is as modelled",
        "/Bad/NoRest: needs restTransforms for its 2 joints, which are not all animated; what follows it is as modelled",
        "/Bad/ShortRest: has 1 restTransforms for 2 joints; they are left out",
        "/Bad/ShortRest: needs restTransforms",
        "/Bad/WrongCounts: has 1 translations, 1 rotations and 1 scales for 2 joints; the rest pose is used",
        "/Bad/Strangers: moves none of the joints of /Bad/Strange; the rest pose is used",
        "/Bad/NoAnimation: skel:animationSource leads to /Bad/Nowhere, where no SkelAnimation is; the rest pose is used",
        "/Bad/WrongWeights: has 2 blendShapeWeights for 1 blend shapes; the first ones are used",
        "/Bad/ToNothing: skel:skeleton leads to /Bad/Gone, where no Skeleton is; what follows it stands as modelled",
        "/Bad/ToAnimation: skel:skeleton leads to /Bad/OneJoint, a SkelAnimation, not a Skeleton;",
        "/Bad/Unbound: follows joints or blend shapes of no skeleton; it stands as modelled",
        "/Bad/OutOfRange: has joint indices out of range; there are 2 joints; it stands as modelled",
        "/Bad/TooFew: has 2 joint indices and 2 weights where 3 are needed; it stands as modelled",
        "/Bad/Sizes: has joint indices and weights of different interpolation or elementSize; it stands as modelled",
        "/Bad/Varying: has joint influences of interpolation varying, not constant or vertex; it stands as modelled",
        "/Bad/Alone: has joint indices or weights, but not both; it stands as modelled",
        "/Bad/Method: there is no skinningMethod 'magic'; it stands as modelled",
        "/Bad/UnknownJoint: follows the joint nobody, which its skeleton does not have; that one stays where it was bound",
        "/Bad/NoApi: has primvars:skel:jointIndices without SkelBindingAPI; it is ignored, as OpenUSD does",
        "/Bad/Stiff: has joint indices out of range; there are 2 joints; it stands as modelled",
        "/Bad/Shapes: blend shape /Bad/Short has 1 offsets for 3 points; it is left out",
        "/Bad/Shapes: blend shape /Bad/Far has pointIndices out of range; there are 3 points; it is left out",
        "/Bad/Shapes: blend shape /Bad/Gone does not exist; it is left out",
        "/Bad/Shapes: blend shape /Bad/Same has the in-between x at weight 1, where another shape is; it is left out",
        "/Bad/Names: has 2 skel:blendShapes and 1 targets for them; they are left out",
        "/Outside: is bound to a skeleton outside of any SkelRoot; it stands as modelled",
    ];
    for what in told {
        loaded.said_of(what);
    }
    assert_eq!(loaded.said.len(), told.len(), "{:#?}", loaded.said);
    // The joint that they follow rests five units from where it was bound.
    let moved = ["/Bad/ToBadAnimation", "/Bad/ToStrange", "/Bad/ToNoAnimation"];
    let others = ["/Bad/UnknownJoint", "/Bad/Weighted"];
    for path in loaded.paths().into_iter().filter(|path| !others.contains(path)) {
        let x = if moved.contains(&path) { 5.0 } else { 0.0 };
        assert_eq!(points(&loaded, path), [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]], "{path}");
    }
    assert_eq!(points(&loaded, "/Bad/UnknownJoint"), [[0.0; 3], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    assert_eq!(points(&loaded, "/Bad/Weighted"), [[1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn instances_share_what_is_moved_alike() {
    let loaded = load("skel.usda", &at_frame(3.0));
    loaded.said_nothing();
    let shape = |path: &str| loaded.one(path).shape;
    assert_eq!(shape("/Walker/Leg"), shape("/Twin/Leg"));
    let legs = ["/Walker/Leg", "/Runner/Leg", "/Idler/Leg"].map(|path| points(&loaded, path));
    assert!(legs[0] != legs[1] && legs[1] != legs[2] && legs[0] != legs[2]);
    // What is moved as a whole has its own place alone.
    assert_eq!(shape("/Walker/Foot"), shape("/Runner/Foot"));
    let up = |path: &str| loaded.one(path).transform.translation.y;
    assert!(up("/Walker/Foot") != up("/Runner/Foot") && up("/Walker/Foot") != up("/Idler/Foot"));
    // Joints are not drawn.
    assert!(!loaded.paths().iter().any(|path| path.contains("Skeleton")));
}

#[test]
fn poses_within_the_shutter_are_kept() {
    let loaded = load("skel_motion.usda", &at_frame(3.0));
    let mesh = |path: &str| match loaded.one(path).shape {
        ShapeRef::Mesh(mesh) => &loaded.scene.meshes[mesh as usize],
        shape => panic!("{shape:?}"),
    };
    let moved = |path: &str, point: usize| -> Vec<(f64, [f32; 3])> {
        mesh(path).motion.iter().map(|m| (m.time, m.value[point])).collect()
    };
    assert_eq!(mesh("/Root/Skin").points[0], [3.0, 0.0, 0.0]);
    let at = |x| [x, 0.0, 0.0];
    assert_eq!(moved("/Root/Skin", 0), [(-0.5, at(2.5)), (0.25, at(3.25)), (0.5, at(4.25))]);
    assert_eq!(moved("/Root/Skin", 2)[2].1, [2.125, 0.5, 0.0]);
    let at = |y| [0.0, y, 0.0];
    assert_eq!(moved("/Root/Shape", 2), [(-0.5, at(4.0)), (0.25, at(5.5)), (0.5, at(6.0))]);
    // Its own transform has no say.
    let ball = loaded.one("/Root/Ball");
    assert_eq!(ball.transform.translation.to_array(), [3.0, 0.0, 0.0]);
    let places: Vec<(f64, f64)> = ball.motion.iter().map(|m| (m.time, m.value.translation.x)).collect();
    assert_eq!(places, [(-0.5, 2.5), (0.25, 3.25), (0.5, 4.25)]);
}
