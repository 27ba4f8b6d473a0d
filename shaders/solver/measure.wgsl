// End of a segment: bounds, speeds, volume change, and whether all is finite.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> control: Control;
@group(0) @binding(4) var<storage, read> substances: array<Substance>;

// Bits in the order of the values they stand for.
fn ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits >> 31u) != 0u);
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count || has_left(id.x)) {
        return;
    }
    let i = id.x;
    let n = params.count;
    let x = kinematics[i].xyz;
    let v = kinematics[n + i].xyz;
    let f = read_deformation(i);
    let j = determinant(f);
    let tag = matter[3u * n + i];
    let object = bitcast<u32>(tag.y) & 31u;
    if (!(finite3(x) && finite3(v) && finite3(f[0]) && finite3(f[1]) && finite3(f[2]) && finite(j))) {
        atomicAdd(&control.nonfinite, 1u);
        atomicOr(&control.suspects, 1u << object);
        return;
    }
    if (j < J_LEAST || j > J_MOST) {
        atomicOr(&control.suspects, 1u << object);
    }
    let base = base_node(x);
    atomicMin(&control.low_x, base.x);
    atomicMin(&control.low_y, base.y);
    atomicMin(&control.low_z, base.z);
    atomicMax(&control.high_x, base.x);
    atomicMax(&control.high_y, base.y);
    atomicMax(&control.high_z, base.z);
    atomicMin(&control.j_low, ordered(j));
    atomicMax(&control.j_high, ordered(j));
    atomicMax(&control.final_speed, bitcast<u32>(length(v)));
    let s = substances[row_of(bitcast<u32>(tag.y))];
    // Neo-Hookean: the logarithm of a volume that is none.
    if (s.model == 1u && j <= 0.0) {
        atomicAdd(&control.inside_out, 1u);
        atomicOr(&control.suspects, 1u << object);
    }
    let modulus = step_modulus(s, tag.w, matter[i].w, matter[n + i].w) + capillary_modulus(s, params.per_m);
    atomicMax(&control.wave_speed, bitcast<u32>(sqrt(modulus * matter[2u * n + i].w / kinematics[i].w)));
}
