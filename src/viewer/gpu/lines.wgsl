// The edges of boxes, and lines, as quads that keep their width on the screen. A line is a box that is flat along two axes.
//
//        side 1  ┌──────────────────────────────────┐
//                │  p ●━━━━━━━━━━━━━━━━━━━━━━━━● q  │   reach = half the halo + half a pixel
//        side 0  └──────────────────────────────────┘
//             end 0                              end 1
//
// Edges are clipped here, to the near plane and to the sides of the view, so that no coordinate
// grows beyond what the rasteriser holds, and an eye inside a box is nothing special. Everything
// else is worked out a pixel at a time from the two ends.

struct Style {
    halo: vec4f,
    // Widths in points.
    width: f32,
    halo_width: f32,
    hidden_width: f32,
    hidden_alpha: f32,
    // The dash and the gap, in points.
    dash: vec2f,
    hidden_halo_alpha: f32,
    // 1 for lines that nothing covers, and that are drawn even if hidden lines are not wanted.
    on_top: f32,
}

@group(2) @binding(0) var<uniform> style: Style;

struct Edge {
    @builtin(position) position: vec4f,
    // The two ends in pixels.
    @location(0) @interpolate(flat) ends: vec4f,
    // At the two ends: what changes linearly on the screen, depth or its inverse.
    @location(1) @interpolate(flat) depths: vec2f,
    // Where the dashes begin, in pixels before the first end.
    @location(2) @interpolate(flat) dash_start: f32,
    @location(3) @interpolate(flat) color: vec4f,
    // From 0 for the first box to 1 for the last.
    @location(4) @interpolate(flat) lateness: f32,
    // The width of the halo, in points.
    @location(5) @interpolate(flat) halo_width: f32,
}

// Nowhere: a quad whose corners fall together.
const NOWHERE = Edge(vec4f(2.0, 2.0, 0.5, 1.0), vec4f(0.0), vec2f(1.0), 0.0, vec4f(0.0), 0.0, 0.0);

// What is left of the interval `t` where a distance that runs from `a` to `b` is not negative.
fn cut(t: vec2f, a: f32, b: f32) -> vec2f {
    if a < 0.0 && b < 0.0 {
        return vec2f(1.0, 0.0);
    }
    let crossing = a / (a - b);
    if a < 0.0 {
        return vec2f(max(t.x, crossing), t.y);
    }
    if b < 0.0 {
        return vec2f(t.x, min(t.y, crossing));
    }
    return t;
}

// The part of an edge that is in the view, with a little room at the sides for its width.
fn in_view(a: vec3f, b: vec3f) -> vec2f {
    let ortho = view.orthographic > 0.5;
    let wide = vec2f(view.half_width, view.half_height) * (1.0 + 32.0 / view.size);
    let side_a = wide * select(a.z, 1.0, ortho);
    let side_b = wide * select(b.z, 1.0, ortho);
    let near = select(view.near, 0.0, ortho);
    var t = cut(vec2f(0.0, 1.0), a.z - near, b.z - near);
    t = cut(t, side_a.x - a.x, side_b.x - b.x);
    t = cut(t, side_a.x + a.x, side_b.x + b.x);
    t = cut(t, side_a.y - a.y, side_b.y - b.y);
    return cut(t, side_a.y + a.y, side_b.y + b.y);
}

fn on_screen(v: vec3f) -> vec2f {
    let ndc = v.xy / (vec2f(view.half_width, view.half_height) * select(v.z, 1.0, view.orthographic > 0.5));
    return vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * view.size;
}

// Depth, as what changes linearly on the screen; the same function takes it back.
fn screen_linear(depth: f32) -> f32 {
    return select(1.0 / depth, depth, view.orthographic > 0.5);
}

// Four corners an edge, twelve edges a box, four along each of its axes.
@vertex
fn vertex(
    @builtin(vertex_index) i: u32,
    @builtin(instance_index) instance: u32,
    @location(0) corner: vec3f,
    @location(1) edge_x: vec3f,
    @location(2) edge_y: vec3f,
    @location(3) edge_z: vec3f,
    @location(4) color: vec4f,
) -> Edge {
    let axis = i / 16u;
    let first = (i / 4u) % 2u == 1u;
    let second = (i / 8u) % 2u == 1u;
    let along = vec3<bool>(axis == 0u, axis == 1u, axis == 2u);
    let at_high = vec3<bool>(first && axis != 0u, select(second, first, axis == 0u) && axis != 1u, second && axis != 2u);
    // A flat box has its edges once, not twice on top of each other.
    let edges = mat3x3f(edge_x, edge_y, edge_z);
    let is_flat = vec3<bool>(all(edge_x == vec3f(0.0)), all(edge_y == vec3f(0.0)), all(edge_z == vec3f(0.0)));
    if any(is_flat & (along | at_high)) {
        return NOWHERE;
    }
    let a = seen_from_eye(corner + edges * vec3f(at_high));
    let b = seen_from_eye(corner + edges * vec3f(at_high | along));
    let t = in_view(a, b);
    if t.x >= t.y {
        return NOWHERE;
    }
    let p = mix(a, b, t.x);
    let q = mix(a, b, t.y);
    let p_px = on_screen(p);
    let q_px = on_screen(q);

    let span = q_px - p_px;
    let direction = select(vec2f(1.0, 0.0), span / length(span), length(span) > 1e-6);
    // Short edges have less of a halo: where many of them crowd together it would only darken the
    // picture, and most of their cost is the pixels it takes.
    let short = clamp(length(span) / (16.0 * view.pixels_per_point), 0.0, 1.0);
    let halo_width = mix(style.width, style.halo_width, max(short, style.on_top));
    let reach = 0.5 * halo_width * view.pixels_per_point + 0.5;
    let end = select(p_px - direction * reach, q_px + direction * reach, i % 2u == 1u);
    let aside = vec2f(-direction.y, direction.x) * select(-reach, reach, (i / 2u) % 2u == 1u);
    let ndc = (end + aside) / view.size * 2.0 - 1.0;

    var edge: Edge;
    edge.position = vec4f(ndc.x, -ndc.y, 0.5, 1.0);
    edge.ends = vec4f(p_px, q_px);
    edge.depths = vec2f(screen_linear(p.z), screen_linear(q.z));
    edge.dash_start = 0.0;
    if t.x > 0.0 && a.z > view.near {
        edge.dash_start = length(p_px - on_screen(a));
    }
    edge.color = color;
    edge.lateness = f32(instance) / view.boxes;
    edge.halo_width = halo_width;
    return edge;
}

// How much of a pixel a line covers whose middle is `away` from it.
fn coverage(width: f32, away: f32) -> f32 {
    let half_width = 0.5 * width * view.pixels_per_point;
    return clamp(half_width - away + 0.5, 0.0, 1.0) * min(2.0 * half_width, 1.0);
}

// How much of a pixel the dash pattern leaves at a place along it.
fn dashed(along: f32) -> f32 {
    let dash = style.dash * view.pixels_per_point;
    let period = dash.x + dash.y;
    let at = along - period * floor(along / period);
    return clamp(min(at, dash.x - at) + 0.5, 0.0, 1.0);
}

// A line over its halo, premultiplied: the share of the pixel that each of them takes.
fn over_halo(color: vec4f, core: f32, halo: f32) -> vec4f {
    let under = halo * (1.0 - core);
    return color.a * vec4f(color.rgb * core + style.halo.rgb * under, core + under);
}

// What lines hide each other by: reversed, so that 0 is behind everything.
fn line_depth(depth: f32) -> f32 {
    let ortho = clamp((view.far - depth) / (view.far - view.near), 0.0, 1.0);
    return select(min(view.near / depth, 1.0), ortho, view.orthographic > 0.5);
}

struct Drawn {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

// Lines cross as they do in space: the halo of the nearer one cuts the farther one (Appel, Rohlf and
// Stein 1979). Lines that touch or coincide, as those of a node and its child, are spared: a halo
// counts as some pixels farther away than its line, and later boxes as up to as many nearer.
@fragment
fn fragment(edge: Edge) -> Drawn {
    let span = edge.ends.zw - edge.ends.xy;
    let t = clamp(dot(edge.position.xy - edge.ends.xy, span) / max(dot(span, span), 1e-12), 0.0, 1.0);
    // Judged where the line's middle is, so that its whole width is in front or behind.
    let middle = edge.ends.xy + span * t;
    let away = distance(edge.position.xy, middle);
    let depth = screen_linear(mix(edge.depths.x, edge.depths.y, t));
    var drawn: Drawn;
    if in_front(middle, depth) {
        let core = coverage(style.width, away);
        drawn.color = over_halo(edge.color, core, style.halo.a * coverage(edge.halo_width, away));
        let spared = 8.0 * view.depth_step * select(depth, 1.0, view.orthographic > 0.5);
        drawn.depth = max(line_depth(depth + spared * (select(1.0, 0.0, core >= 0.5) - edge.lateness)), style.on_top);
    } else {
        let dash = dashed(edge.dash_start + t * length(span)) * max(view.hidden, style.on_top);
        let core = style.hidden_alpha * coverage(style.hidden_width, away);
        let halo_width = style.hidden_width + edge.halo_width - style.width;
        let halo = style.hidden_halo_alpha * coverage(halo_width, away);
        drawn.color = dash * over_halo(edge.color, core, halo);
        drawn.depth = style.on_top;
    }
    if drawn.color.a <= 0.0 {
        discard;
    }
    return drawn;
}
