//! From the texture coordinates of a mesh to those of an image, whose origin is its upper left
//! corner and whose v points down, as in glTF (glTF 2.0, section 3.9.2).

use glam::Vec2;

/// An affine map of the plane: two rows of u, v and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform([[f32; 3]; 2]);

impl UvTransform {
    /// Coordinates as they are.
    pub const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);

    /// That of KHR_texture_transform: scaled, then turned by `rotation` radians, then moved.
    ///
    /// It turns from u towards where v is negative: "counter-clockwise" as one looks at an image
    /// whose v points down. The listing in the specification has the signs of v pointing up, which
    /// neither its own sample nor any viewer follows (KhronosGroup/glTF, issue 1563).
    pub fn khr(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> Self {
        let (sin, cos) = rotation.sin_cos();
        let ([ou, ov], [su, sv]) = (offset, scale);
        Self([[cos * su, sin * sv, ou], [-sin * su, cos * sv, ov]])
    }

    /// That of the options `-s` and `-o` of an MTL file, whose v points up: the one place where it
    /// is turned over.
    pub fn mtl(offset: [f32; 2], scale: [f32; 2]) -> Self {
        let ([ou, ov], [su, sv]) = (offset, scale);
        Self([[su, 0.0, ou], [0.0, -sv, 1.0 - ov]])
    }

    /// Where on the image a point of the mesh is.
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        // Written out, so that every road and every machine rounds alike.
        let row = |[a, b, c]: [f32; 3]| a * uv.x + b * uv.y + c;
        Vec2::new(row(self.0[0]), row(self.0[1]))
    }
}

impl Default for UvTransform {
    fn default() -> Self {
        Self::IDENTITY
    }
}
