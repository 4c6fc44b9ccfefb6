// Whether the surface of the picture hides something drawn over it.

@group(1) @binding(0) var surface: texture_2d<u32>;

fn surface_at(pixel: vec2f) -> f32 {
    let last = vec2i(view.size) - 1;
    return bitcast<f32>(textureLoad(surface, clamp(vec2i(pixel), vec2i(0), last), 0).r);
}

// Whether what has linear depth `depth` at `pixel` is in front of the surface, or on it.
//
// The surface is known once a texel, at its centre. On a slanted surface its depth changes from one
// texel to the next by more than any fixed tolerance, so a line that lies on it would come and go.
// It counts as hidden only if it lies behind the neighbouring texels as well.
fn in_front(pixel: vec2f, depth: f32) -> bool {
    let tolerance = view.depth_step * select(abs(depth), 1.0, view.orthographic > 0.5) + 2e-5 * abs(depth);
    let near = depth - tolerance;
    if near <= surface_at(pixel) {
        return true;
    }
    let step = max(view.texel, vec2f(1.0));
    let aside = max(surface_at(pixel + vec2f(step.x, 0.0)), surface_at(pixel - vec2f(step.x, 0.0)));
    let above = max(surface_at(pixel + vec2f(0.0, step.y)), surface_at(pixel - vec2f(0.0, step.y)));
    return near <= max(aside, above);
}
