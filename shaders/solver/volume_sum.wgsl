// Sums what the particles of each cell gained, in fixed point.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> substances: array<Substance>;
// Two words a cell: rest volume; rest volume times gain.
@group(0) @binding(4) var<storage, read_write> gains: array<atomic<i32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let gain = gain_of(id.x);
    if (!gain.counts) {
        return;
    }
    let share = rest_share(id.x);
    atomicAdd(&gains[2u * gain.cell], i32(round(share * VOLUME_UNITS)));
    atomicAdd(&gains[2u * gain.cell + 1u], i32(round(share * gain.gained * GAIN_UNITS)));
}
