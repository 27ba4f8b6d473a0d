// Prestress: adds up what the blocks found and chooses the next step. One workgroup.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> partial: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> search: Search;
var<immediate> substep: Substep;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32) {
    var own = vec4<f32>(0.0);
    for (var k = lane; k < active_blocks[0]; k += 64u) {
        own += partial[k];
    }
    let sum = workgroup_sum(lane, own);
    if (lane != 0u) {
        return;
    }
    let job = steer(substep.job, params.count);
    if (job == SET_UP || job == ADOPT) {
        search = Search(0.0, 0.0, sum.z, 0.0, sum.x, sum.y, 0u, 0u, sum.w);
    } else if (job == CURVATURE) {
        // No curvature along the direction, or a number that is none: as far as f32 goes.
        if (!(sum.x > 0.0)) {
            search.done = 1u;
        }
        search.alpha = select(0.0, search.gamma / sum.x, search.done == 0u);
        search.gained += search.alpha * search.gamma;
    } else if (search.done == 0u) {
        // Polak and Ribiere: forgets a direction that rounding has spoilt.
        search.beta = max((sum.x - sum.y) / search.gamma, 0.0);
        search.gamma = sum.x;
        search.rounds += 1u;
    }
}
