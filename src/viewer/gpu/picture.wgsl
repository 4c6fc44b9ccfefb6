// The traced picture, stretched over the target: its colour smoothly, its depth not.

@group(1) @binding(0) var colors: texture_2d<f32>;
@group(1) @binding(1) var smooth_sampler: sampler;
@group(1) @binding(2) var depths: texture_2d<u32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return covering_corner(i);
}

struct Surface {
    @location(0) color: vec4f,
    // The bits of a float, as in the texture it goes to.
    @location(1) depth: u32,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> Surface {
    let at = position.xy / view.size;
    let color = textureSampleLevel(colors, smooth_sampler, at, 0.0);
    let size = vec2i(textureDimensions(depths));
    let depth = bitcast<f32>(textureLoad(depths, min(vec2i(at * vec2f(size)), size - 1), 0).r);
    // Premultiplied over the background.
    return Surface(vec4f(color.rgb + view.background.rgb * (1.0 - color.a), 1.0), bitcast<u32>(min(depth, NOTHING)));
}
