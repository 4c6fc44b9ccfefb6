// What every shader of the viewport shares: the view, and the way from the scene into it.

struct View {
    eye: vec3f,
    near: f32,
    right: vec3f,
    half_width: f32,
    up: vec3f,
    half_height: f32,
    forward: vec3f,
    far: f32,
    background: vec4f,
    // Linear, before shading.
    mesh_color: vec4f,
    // The target, in pixels.
    size: vec2f,
    // One texel of the depth's source, in pixels of the target.
    texel: vec2f,
    // The linear depth that one such texel spans, at depth 1 if in perspective.
    depth_step: f32,
    pixels_per_point: f32,
    orthographic: f32,
    // 1 where lines behind the surface are wanted.
    hidden: f32,
    // How many boxes and planes there are, at least 1.
    boxes: f32,
    // Of the scene only points where the dot product with (p, 1) is not negative are seen; zeros where all is.
    section: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;

// What stands for a miss: finite, since shaders need not honour infinities.
const NOTHING: f32 = 1e30;

// From the scene to the axes of the view: right, up, and linear depth. The eye is taken off before
// turning, so that scenes far from the origin keep what precision they have.
fn seen_from_eye(p: vec3f) -> vec3f {
    let d = p - view.eye;
    return vec3f(dot(d, view.right), dot(d, view.up), dot(d, view.forward));
}

// Clip space with reversed z: perspective has its infinite far plane at 0, orthographic its range.
fn clip_space(v: vec3f) -> vec4f {
    let xy = vec2f(v.x / view.half_width, v.y / view.half_height);
    if view.orthographic > 0.5 {
        return vec4f(xy, (view.far - v.z) / (view.far - view.near), 1.0);
    }
    return vec4f(xy, view.near, v.z);
}

// The corners of one triangle that covers the target.
fn covering_corner(i: u32) -> vec4f {
    let uv = vec2f(f32((i << 1u) & 2u), f32(i & 2u));
    return vec4f(uv * 2.0 - 1.0, 0.0, 1.0);
}
