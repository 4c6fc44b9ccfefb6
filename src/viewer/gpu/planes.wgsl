// Translucent parallelograms: flat boxes, filled; or the half of one at its corner.

override FILL: f32;
override FILL_HIDDEN: f32;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) color: vec4f,
}

@vertex
fn vertex(
    @builtin(vertex_index) i: u32,
    @location(0) corner: vec3f,
    @location(1) edge_x: vec3f,
    @location(2) edge_y: vec3f,
    @location(3) edge_z: vec3f,
    @location(4) color: vec4f,
) -> Corner {
    let first = (i & 1u) == 1u;
    let second = (i & 2u) == 2u;
    var at_high = vec3<bool>(first, second, false);
    if all(edge_x == vec3f(0.0)) {
        at_high = vec3<bool>(false, first, second);
    } else if all(edge_y == vec3f(0.0)) {
        at_high = vec3<bool>(first, false, second);
    }
    let seen = seen_from_eye(corner + mat3x3f(edge_x, edge_y, edge_z) * vec3f(at_high));
    var position = clip_space(seen);
    // Only the near plane may cut it: a plane may reach farther than the scene.
    position.z = select(position.z, 0.5, view.orthographic > 0.5);
    return Corner(position, seen.z, color);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    if corner.depth < 0.0 {
        discard;
    }
    let hidden = FILL_HIDDEN * view.hidden;
    let alpha = corner.color.a * select(hidden, FILL, in_front(corner.position.xy, corner.depth));
    return vec4f(corner.color.rgb * alpha, alpha);
}
