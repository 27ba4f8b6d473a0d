// Gives each particle the mean gain of its cell in place of its own.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> substances: array<Substance>;
@group(0) @binding(4) var<storage, read> gains: array<i32>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = id.x;
    let n = params.count;
    let gain = gain_of(i);
    if (!gain.counts) {
        return;
    }
    let volume = f32(gains[2u * gain.cell]);
    if (volume <= 0.0) {
        return;
    }
    let mean = f32(gains[2u * gain.cell + 1u]) / volume * (VOLUME_UNITS / GAIN_UNITS);
    // exp(t) - 1: as a change, so that little of it rounds little.
    let t = (mean - gain.gained) * (1.0 / 3.0);
    let more = t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0))));
    let f = read_deformation(i);
    let evened = f + f * more;
    let rows = transpose(evened);
    matter[i] = vec4<f32>(rows[0], matter[i].w);
    matter[n + i] = vec4<f32>(rows[1], matter[n + i].w);
    matter[2u * n + i] = vec4<f32>(rows[2], matter[2u * n + i].w);
    matter[3u * n + i].w = ln_volume(evened);
}
