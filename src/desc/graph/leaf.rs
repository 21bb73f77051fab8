//! What a graph may ask of the place where a ray met a surface.

use std::sync::Arc;

use super::Value;

/// Something known at a hit. Points and vectors in *world* space are those of the `SceneDesc` (y up,
/// metres); *object* space is the mesh's own. A door whose author had z up turns them with
/// [`super::Graph::turned`].
#[derive(Clone, Debug, PartialEq)]
pub enum Leaf {
    /// The point, world space.
    Position,
    /// Unit shading normal before normal maps, world space, on the side of whoever looks.
    Normal,
    /// Unit geometric normal, world space, on the side of whoever looks.
    TrueNormal,
    /// Unit direction back along the ray, world space.
    Incoming,
    /// Unit direction along the surface and around the z axis of the mesh's generated coordinates, world
    /// space; Cycles' default tangent.
    RadialTangent,
    /// Barycentrics of the first and second corner of the triangle, then 0.
    Parametric,
    /// 1 where the surface is seen from behind, as wound.
    Backfacing,
    /// The point, object space.
    ObjectPosition,
    /// [`Leaf::Normal`], object space.
    ObjectNormal,
    /// The point within `MeshDesc::generated`, 0 to 1 along each axis; the attribute "generated" where the
    /// mesh has one.
    Generated,
    /// The point as the camera sees it: x right, y up, z ahead, metres.
    CameraPosition,
    /// Where the point stands in the picture: 0 to 1 from the left and from below, then 0.
    Window,
    /// A UV set of the mesh as `MeshDesc::uvs` has it (v downwards), then 0 and 1; 0 where there is none.
    Uv(u32),
    /// A named attribute: of the mesh, else of the object, else `fallback`. As it stands: vectors of the
    /// mesh are in object space.
    Attribute {
        /// Its name.
        name: Arc<str>,
        /// What is taken where neither has it.
        fallback: Value,
    },
    /// `MeshDesc::colors`, else, of a material that is `tinted`, `InstanceDesc::color`; white where there are none.
    /// They multiply the base color as well.
    VertexColor,
    /// Interpolated normal as wound, object space, not unit: what tangent-space maps are meant for.
    SmoothNormal,
    /// `MeshDesc::tangents`, object space, not unit, and the sign of the bitangent; 0 where there are none.
    Tangent,
    /// Where the object's origin is, world space.
    ObjectLocation,
    /// `InstanceDesc::color` with its alpha.
    ObjectColor,
    /// `InstanceDesc::object_index`.
    ObjectIndex,
    /// `InstanceDesc::random`.
    ObjectRandom,
    /// `MaterialDesc::material_index`.
    MaterialIndex,
    /// What is known of the ray and the path before it.
    Path(PathInfo),
}

/// What is known of a ray and the path before it; yes is 1 and no is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PathInfo {
    /// A ray from the camera, or one that has only passed surfaces since.
    IsCamera,
    /// A shadow ray.
    IsShadow,
    /// Scattered by a diffuse lobe last.
    IsDiffuse,
    /// Scattered by a glossy lobe last, reflected or refracted.
    IsGlossy,
    /// Scattered by a perfect mirror or lens last.
    IsSingular,
    /// Reflected last.
    IsReflection,
    /// Refracted last.
    IsTransmission,
    /// How far the ray came, metres.
    Length,
    /// How often the path was scattered before.
    Depth,
    /// How often by diffuse lobes.
    DiffuseDepth,
    /// How often by glossy lobes, reflections alone.
    GlossyDepth,
    /// How often it was refracted.
    TransmissionDepth,
    /// How many surfaces it has passed unscattered.
    TransparentDepth,
}
