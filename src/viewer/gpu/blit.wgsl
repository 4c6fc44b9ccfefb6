// The finished viewport into the window's own pass.

// 1 where the window's format encodes gamma itself, and takes linear values.
override TARGET_IS_LINEAR: f32;

@group(0) @binding(0) var finished: texture_2d<f32>;
@group(0) @binding(1) var smooth_sampler: sampler;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Corner {
    let uv = vec2f(f32((i << 1u) & 2u), f32(i & 2u));
    return Corner(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    let encoded = textureSampleLevel(finished, smooth_sampler, corner.uv, 0.0).rgb;
    let low = encoded / 12.92;
    let high = pow((encoded + 0.055) / 1.055, vec3f(2.4));
    let linear = select(high, low, encoded <= vec3f(0.04045));
    return vec4f(select(encoded, linear, TARGET_IS_LINEAR > 0.5), 1.0);
}
