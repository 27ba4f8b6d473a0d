// What laws keep beside F, and what is shown of particles whose F forgets.

fn positive(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> bool {
    return a.x > 0.0 && a.x * b.y - a.y * b.x > 0.0 && dot(a, cross(b, c)) > 0.0;
}

// Whether all stretches lie between two bounds: both F^T F - least^2 and most^2 - F^T F are positive.
fn within(f: mat3x3<f32>, least: f32, most: f32) -> bool {
    let c = transpose(f) * f;
    let low = least * least;
    let high = most * most;
    let x = vec3<f32>(1.0, 0.0, 0.0);
    let y = vec3<f32>(0.0, 1.0, 0.0);
    let z = vec3<f32>(0.0, 0.0, 1.0);
    return determinant(f) > 0.0 && positive(c[0] - low * x, c[1] - low * y, c[2] - low * z)
        && positive(high * x - c[0], high * y - c[1], high * z - c[2]);
}

fn bounded(f: mat3x3<f32>, least: f32, most: f32) -> mat3x3<f32> {
    if (within(f, least, most)) {
        return f;
    }
    let axes = svd(f);
    return compose(axes.u, clamp(axes.s, vec3<f32>(least), vec3<f32>(most)), axes.v);
}

// Liquid has no shape to keep: what is shown goes back to that of the captured Gaussian, turned. A step of Newton's
// iteration leads there.
fn relaxed(f: mat3x3<f32>, s: Substance, dt_s: f32) -> mat3x3<f32> {
    if (s.kind != LIQUID) {
        return f;
    }
    return f + (cofactors(f) * (1.0 / determinant(f)) - f) * (0.5 * min(dt_s / LIQUID_SHOWN_S, 1.0));
}

// Keeps what the law remembers, and what is shown.
fn remember(i: u32, s: Substance, answer: Answer, flow: Flow) {
    let n = params.count;
    matter[3u * n + i].w = answer.history;
    if (s.shown_most > 0.0) {
        let k = 3u * bitcast<u32>(matter[3u * n + i].x);
        let old = transpose(mat3x3<f32>(shown[k].xyz, shown[k + 1u].xyz, shown[k + 2u].xyz));
        let moved = bounded(old + flow.dt_s * (flow.gradient * old), s.shown_least, s.shown_most);
        let rows = transpose(relaxed(moved, s, flow.dt_s));
        shown[k] = vec4<f32>(rows[0], 0.0);
        shown[k + 1u] = vec4<f32>(rows[1], 0.0);
        shown[k + 2u] = vec4<f32>(rows[2], 0.0);
    }
}
