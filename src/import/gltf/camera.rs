//! Cameras (glTF 2.0, section 3.10).

use crate::desc::ProjectionDesc;

use super::json::Camera;

/// Projection, near and far plane of `camera`, or why there is none.
pub(super) fn projection(camera: &Camera) -> Result<(ProjectionDesc, f64, f64), String> {
    match (camera.kind.as_str(), &camera.perspective, &camera.orthographic) {
        ("perspective", Some(p), _) => {
            if !(p.yfov > 0.0 && p.yfov < std::f64::consts::PI) {
                return Err(format!("a field of view of {} radians can't be seen through", p.yfov));
            }
            let aspect = p.aspect_ratio.filter(|aspect| *aspect > 0.0);
            let far = p.zfar.filter(|far| *far > p.znear).unwrap_or(f64::INFINITY);
            Ok((ProjectionDesc::Perspective { fov_y: p.yfov, aspect }, p.znear.max(0.0), far))
        }
        ("orthographic", _, Some(o)) => {
            let (half_width, half_height) = (o.xmag.abs(), o.ymag.abs());
            if half_width == 0.0 || half_height == 0.0 {
                return Err("an orthographic camera without size sees nothing".into());
            }
            let far = if o.zfar > o.znear { o.zfar } else { f64::INFINITY };
            Ok((ProjectionDesc::Orthographic { half_width, half_height }, o.znear.max(0.0), far))
        }
        (kind, ..) => Err(format!("camera type '{kind}' without its parameters")),
    }
}
