// Start of a segment: adds the stress to A, for the length of the segment's first substep, and
// measures the momenta that its fixed-point scale is made from.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> control: Control;
@group(0) @binding(4) var<storage, read> substances: array<Substance>;
var<immediate> substep: Substep;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = id.x;
    let n = params.count;
    let row = row_of(bitcast<u32>(matter[3u * n + i].y));
    // Before the stress is added A is mass times the gradient of velocity.
    let gradient = read_affine(i) * (1.0 / max(kinematics[i].w, 1e-30));
    let flow = Flow(0.0, gradient, activation(row, substep.index));
    let tau = respond(substances[row], read_deformation(i), matter[3u * n + i].w, matter[i].w, matter[n + i].w, flow).tau;
    let weight = substep.dt_next_s * 4.0 * params.per_m * params.per_m * matter[2u * n + i].w;
    let affine = read_affine(i) - weight * tau;
    let v = held_back(kinematics[n + i].xyz);
    write_motion(i, v, affine);
    atomicMax(&control.momentum[substep.index & 3u], bitcast<u32>(momentum_measure(kinematics[i].w, v, affine)));
}
