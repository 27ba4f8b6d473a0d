// Liquids: brings J back to the density that the particles really have. Integrated from the velocity
// gradient alone, J drifts from it, and liquid slowly loses volume or gains it. Inside the liquid, and
// wherever it is denser than J says, J goes towards that density, slowly, so that no sound comes of it.
//
// Inside is where it is about as full all around. That is nowhere so at a surface, in a thin sheet, a thread or a drop, but
// it is in a heap that fell together with gaps: there J comes to be that of the gaps, so that no pressure holds them open.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> substances: array<Substance>;
@group(0) @binding(4) var<storage, read> share: array<vec4<f32>>;
// Its length is the time until the next such pass.
var<immediate> substep: Substep;

struct Density {
    sum: f32,
    weight: f32,
    least: f32,
    most: f32,
}

fn taste(d: Density, node: u32, weight: f32) -> Density {
    let full = share[node].x;
    if (full < 0.0) {
        return d;
    }
    return Density(d.sum + weight * full, d.weight + weight, min(d.least, full), max(d.most, full));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = id.x;
    let n = params.count;
    let position = kinematics[i];
    let base = base_node(position.xyz);
    let first = base - params.origin;
    if (substances[row_of(bitcast<u32>(matter[3u * n + i].y))].kind != LIQUID || !in_window(first)) {
        return;
    }
    let s = stencil(position.xyz, base, vec3<u32>(first));
    var d = Density(0.0, 0.0, 1e9, 0.0);
    for (var k = 0u; k < 9u; k++) {
        let r = row(s, k);
        d = taste(d, r.nodes.x, r.weights.x);
        d = taste(d, r.nodes.y, r.weights.y);
        d = taste(d, r.nodes.z, r.weights.z);
    }
    let j = determinant(read_deformation(i));
    let really = clamp(d.weight / max(d.sum, 1e-6), LIQUID_J_LEAST, LIQUID_J_LOOSE);
    let inside = d.least >= FULL * min(d.most, 1.0);
    if (!(j > 0.0) || (!inside && really >= j)) {
        return;
    }
    let sound_m_s = sqrt(matter[n + i].w * matter[2u * n + i].w / position.w);
    let share_of_it = min(CALM * sound_m_s * params.per_m * substep.dt_s, 0.5);
    let changed = j + share_of_it * clamp(really - j, -0.1, 0.1);
    let scale = cube_root(changed / j);
    matter[i] = vec4<f32>(matter[i].xyz * scale, matter[i].w);
    matter[n + i] = vec4<f32>(matter[n + i].xyz * scale, matter[n + i].w);
    matter[2u * n + i] = vec4<f32>(matter[2u * n + i].xyz * scale, matter[2u * n + i].w);
}
