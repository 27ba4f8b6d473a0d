// Prestress, on the grid: goes along the direction (job CURVATURE), turns it (job TURN), or hands the
// solution to the particles (job ADOPT).

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> search: Search;
@group(0) @binding(3) var<storage, read_write> velocity: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> nodes: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> partial: array<vec4<f32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    let alive = place < active_blocks[0];
    let node = (1u + min(place, active_blocks[0] - 1u)) * 64u + lane;
    let count = active_blocks[0] * 64u;
    let k = place * 64u + lane;
    var share = vec4<f32>(0.0);
    let job = steer(substep.job, params.count);
    if (alive && job == CURVATURE) {
        let residual = nodes[RESIDUAL * count + k];
        let left = residual.xyz - search.alpha * nodes[PRODUCT * count + k].xyz;
        let step = select(vec3<f32>(0.0), left / residual.w, residual.w > 0.0);
        nodes[SOLUTION * count + k] += vec4<f32>(search.alpha * nodes[DIRECTION * count + k].xyz, 0.0);
        nodes[RESIDUAL * count + k] = vec4<f32>(left, residual.w);
        share = vec4<f32>(dot(left, step), dot(residual.xyz, step), 0.0, 0.0);
    } else if (alive && job == TURN && search.done == 0u) {
        let residual = nodes[RESIDUAL * count + k];
        let step = select(vec3<f32>(0.0), residual.xyz / residual.w, residual.w > 0.0);
        let direction = step + search.beta * nodes[DIRECTION * count + k].xyz;
        nodes[DIRECTION * count + k] = vec4<f32>(direction, 0.0);
        velocity[node] = vec4<f32>(direction, 0.0);
    } else if (alive && job == ADOPT) {
        velocity[node] = vec4<f32>(nodes[SOLUTION * count + k].xyz, 0.0);
    }
    if (job == CURVATURE) {
        let sum = workgroup_sum(lane, share);
        if (lane == 0u && alive) {
            partial[place] = sum;
        }
    }
}
