// The mesh by rasterisation: flat faces under a light at the eye, until the traced picture is there.

// 1 where a part of the scene is cut away.
override CUT: f32;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) seen: vec3f,
    // How far inside of what is left, negative outside.
    @location(1) inside: f32,
}

// Each instance has the rows of the way from its mesh into the scene.
@vertex
fn vertex(@location(0) p: vec3f, @location(1) x: vec4f, @location(2) y: vec4f, @location(3) z: vec4f) -> Corner {
    let v = vec4f(p, 1.0);
    let placed = vec3f(dot(x, v), dot(y, v), dot(z, v));
    let seen = seen_from_eye(placed);
    return Corner(clip_space(seen), seen, dot(view.section, vec4f(placed, 1.0)));
}

struct Surface {
    @location(0) color: vec4f,
    // The bits of a float, as in the texture it goes to.
    @location(1) depth: u32,
}

fn gamma_encoded(linear: vec3f) -> vec3f {
    let low = linear * 12.92;
    let high = 1.055 * pow(max(linear, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

@fragment
fn fragment(corner: Corner) -> Surface {
    // The face's normal, from how its position changes from pixel to pixel. Its sign says nothing,
    // and nothing needs it: triangles have two sides.
    let n = cross(dpdx(corner.seen), dpdy(corner.seen));
    let towards = select(corner.seen, vec3f(0.0, 0.0, 1.0), view.orthographic > 0.5);
    let facing = abs(dot(n, towards)) / max(length(n) * length(towards), 1e-30);
    let light = 0.12 + 0.88 * facing * facing;
    // Last, since neighbouring pixels tell the normal.
    if CUT > 0.5 && corner.inside < 0.0 {
        discard;
    }
    return Surface(vec4f(gamma_encoded(view.mesh_color.rgb * light), 1.0), bitcast<u32>(corner.seen.z));
}
