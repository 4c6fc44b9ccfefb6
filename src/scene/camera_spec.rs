//! Where a picture is taken from, as written on the command line.

use std::str::FromStr;

use super::{Camera, Geometry, Projection, Scene};
use crate::geometry::num::narrow;
use glam::Vec3;

/// A camera as the user writes it; what is not said comes from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSpec {
    eye: Vec3,
    target: Vec3,
    up: Option<Vec3>,
    projection: Option<Projection>,
}

impl CameraSpec {
    /// The camera asked for, or the one that suits the scene.
    pub fn or_first(spec: Option<&Self>, scene: &Scene, geometry: &Geometry, aspect: f32) -> Camera {
        spec.map_or_else(|| scene.first_camera(geometry.world_bounds(), aspect), |spec| spec.in_scene(scene))
    }

    /// A camera as it is written, and read back to the bit.
    pub fn written(camera: &Camera) -> String {
        let point = |p: Vec3| format!("{},{},{}", p.x, p.y, p.z);
        let projection = match camera.projection {
            Projection::Perspective { fov_y } => format!("fov {}", degrees(fov_y)),
            Projection::Orthographic { height } => format!("height {height}"),
        };
        format!("eye {} target {} up {} {projection}", point(camera.eye), point(camera.target), point(camera.up))
    }

    /// The camera it describes in a scene.
    pub fn in_scene(&self, scene: &Scene) -> Camera {
        let projection = self.projection.unwrap_or(Projection::Perspective { fov_y: Camera::DEFAULT_FOV_Y });
        Camera { eye: self.eye, target: self.target, up: self.up.unwrap_or(scene.up), projection }
    }
}

impl FromStr for CameraSpec {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let words: Vec<&str> = s.split_whitespace().collect();
        let (mut eye, mut target, mut up, mut projection) = (None, None, None, None);
        for pair in words.chunks(2) {
            let [key, value] = pair else { return Err(format!("'{}' has no value", pair[0])) };
            let twice = match *key {
                "eye" => eye.replace(point(value)?).is_some(),
                "target" => target.replace(point(value)?).is_some(),
                "up" => up.replace(point(value)?).is_some(),
                "fov" => projection.replace(perspective(value)?).is_some(),
                "height" => projection.replace(parallel(value)?).is_some(),
                other => return Err(format!("'{other}' is not one of eye, target, up, fov, height")),
            };
            if twice {
                return Err(format!("'{key}' says something that has been said before"));
            }
        }
        let eye = eye.ok_or("eye X,Y,Z is missing")?;
        let target = target.ok_or("target X,Y,Z is missing")?;
        Ok(Self { eye, target, up, projection })
    }
}

fn number(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite()).ok_or_else(|| no_number(text))
}

fn no_number(text: &str) -> String {
    format!("'{text}' is not a number")
}

/// An angle in degrees: in few digits if they say it, else in 64 bits.
fn degrees(radians: f32) -> String {
    let short = radians.to_degrees().to_string();
    let says = short.parse().is_ok_and(|degrees: f64| narrow(degrees.to_radians()) == radians);
    if says { short } else { f64::from(radians).to_degrees().to_string() }
}

fn point(text: &str) -> Result<Vec3, String> {
    let parts = text.split(',').map(number).collect::<Result<Vec<f32>, _>>()?;
    <[f32; 3]>::try_from(parts).map(Vec3::from).map_err(|_| format!("'{text}' is not X,Y,Z"))
}

fn perspective(text: &str) -> Result<Projection, String> {
    // In 64 bits, so that it is rounded once.
    let degrees = text.parse().ok().filter(|x: &f64| narrow(*x).is_finite()).ok_or_else(|| no_number(text))?;
    let fits = narrow(degrees) > 0.0 && narrow(degrees) < 180.0;
    fits.then_some(Projection::Perspective { fov_y: narrow(degrees.to_radians()) })
        .ok_or_else(|| format!("fov {text} is not between 0 and 180"))
}

fn parallel(text: &str) -> Result<Projection, String> {
    let height = number(text)?;
    (height > 0.0).then_some(Projection::Orthographic { height }).ok_or_else(|| format!("height {text} is not above 0"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_is_read_in_any_order() {
        let spec: CameraSpec = "target 0,0,0  eye 1,-2,3.5 fov 90 up 0,0,1".parse().expect("well formed");
        assert_eq!((spec.eye, spec.up), (Vec3::new(1.0, -2.0, 3.5), Some(Vec3::Z)));
        assert_eq!(spec.projection, Some(Projection::Perspective { fov_y: std::f32::consts::FRAC_PI_2 }));
        let scene = Scene { up: Vec3::Y, ..Scene::default() };
        let camera = "eye 1,0,0 target 0,0,0 height 2".parse::<CameraSpec>().expect("well formed").in_scene(&scene);
        assert_eq!((camera.up, camera.projection), (Vec3::Y, Projection::Orthographic { height: 2.0 }));
        let again: CameraSpec = CameraSpec::written(&camera).parse().expect("well formed");
        assert_eq!(again.in_scene(&Scene::default()), camera);
    }

    #[test]
    fn every_written_angle_comes_back() {
        let camera =
            |fov_y| Camera { eye: Vec3::X, target: Vec3::ZERO, up: Vec3::Y, projection: Projection::Perspective { fov_y } };
        let even = (1..=600u16).map(|i| f32::from(i) * 5.2e-3);
        let whole = (1..180u8).map(|degrees| f32::from(degrees).to_radians());
        let ends = [Camera::DEFAULT_FOV_Y, 1e-6, std::f32::consts::PI - 1e-6];
        for camera in even.chain(whole).chain(ends).map(camera) {
            let written = CameraSpec::written(&camera);
            let again: CameraSpec = written.parse().expect("well formed");
            assert_eq!(again.in_scene(&Scene::default()), camera, "{written}");
        }
        let short = CameraSpec::written(&camera(std::f32::consts::FRAC_PI_2));
        assert!(short.ends_with(" fov 90"), "{short}");
    }

    #[test]
    fn what_is_wrong_with_a_camera_is_said() {
        for (text, why) in [
            ("", "eye X,Y,Z is missing"),
            ("eye 1,2,3", "target X,Y,Z is missing"),
            ("eye 1,2 target 0,0,0", "'1,2' is not X,Y,Z"),
            ("eye 1,2,nan target 0,0,0", "'nan' is not a number"),
            ("eye 1,2,3 target", "'target' has no value"),
            ("eye 1,2,3 target 0,0,0 fov 180", "fov 180 is not between 0 and 180"),
            ("eye 1,2,3 target 0,0,0 fov 40 height 2", "'height' says something that has been said before"),
            ("look 1,2,3", "'look' is not one of eye, target, up, fov, height"),
        ] {
            assert_eq!(text.parse::<CameraSpec>(), Err(why.to_owned()));
        }
    }
}
