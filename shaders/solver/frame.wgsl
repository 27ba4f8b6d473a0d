// What others see of the particles, in their original order: position, visual deformation
// G as halves of G - I, how it flows, velocity, and the volume ratio. G = F F0^-1, or what is shown instead where F
// forgets.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
// Rows of F0^-1, three vec4 a particle, in the original order.
@group(0) @binding(3) var<storage, read> unstressed: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> motion: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> velocity: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> substances: array<Substance>;
// Rows of the deformation that is shown of particles whose F forgets, in the original order.
@group(0) @binding(7) var<storage, read> shown: array<vec4<f32>>;

fn from_rows(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> mat3x3<f32> {
    return transpose(mat3x3<f32>(a.xyz, b.xyz, c.xyz));
}

// det F of all that happened, where F forgets a part of it.
fn volume_ratio(s: Substance, history: f32, elastic: f32) -> f32 {
    switch (s.kind) {
        case SAND: { return elastic * exp(history); }
        case SNOW: { return elastic * history; }
        default: { return elastic; }
    }
}

// To the nearest multiple of 2^-14, so that rest is exactly 0 whatever the last bits of F0^-1.
fn tidy(value: f32) -> f32 {
    return clamp(round(value * 16384.0) * (1.0 / 16384.0), -1000.0, 1000.0);
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = id.x;
    let n = params.count;
    let x = bitcast<vec3<u32>>(kinematics[i].xyz);
    let particle = bitcast<u32>(matter[3u * n + i].x);
    let k = 3u * particle;
    let elastic = read_deformation(i) * from_rows(unstressed[k], unstressed[k + 1u], unstressed[k + 2u]);
    let s = substances[row_of(bitcast<u32>(matter[3u * n + i].y))];
    var g = elastic;
    if (s.shown_most > 0.0) {
        g = from_rows(shown[k], shown[k + 1u], shown[k + 2u]);
    }
    let rows = transpose(g);
    let a = vec3<f32>(tidy(rows[0].x - 1.0), tidy(rows[0].y), tidy(rows[0].z));
    let b = vec3<f32>(tidy(rows[1].x), tidy(rows[1].y - 1.0), tidy(rows[1].z));
    let c = vec3<f32>(tidy(rows[2].x), tidy(rows[2].y), tidy(rows[2].z - 1.0));
    motion[2u * particle] = vec4<u32>(x, pack2x16float(a.xy));
    motion[2u * particle + 1u] = vec4<u32>(
        pack2x16float(vec2<f32>(a.z, b.x)),
        pack2x16float(b.yz),
        pack2x16float(c.xy),
        pack2x16float(vec2<f32>(c.z, select(s.flow, -1.0, has_left(i)))),
    );
    let v = select(kinematics[n + i].xyz, vec3<f32>(0.0), has_left(i));
    velocity[particle] = vec4<f32>(v, volume_ratio(s, matter[3u * n + i].w, determinant(elastic)));
}
