// One thread a sorted particle: the mean light of what it has come to, so that what is mixed is smooth. What it brought along counts
// less. Colours are as good as square roots of light. And which way its neighbours lie: alone too uneven to be a surface's, the
// mean of it over many is.

@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read> spans: array<u32>;
@group(0) @binding(2) var<storage, read> sorted: array<vec4<u32>>;
/// Mean light; the middle of what lies around, in reaches.
@group(0) @binding(3) var<storage, read_write> blended: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let own = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if own >= params.count || keys[own] > params.mask {
        return;
    }
    let x = bitcast<vec3<f32>>(sorted[2u * own].xyz);
    let home = cell_of(x);
    var light = vec3(0.0);
    var total = 0.0;
    var first = vec3(0.0);
    var volume = 0.0;
    for (var c = 0; c < 27; c++) {
        let cell = home + vec3(c % 3, c / 3 % 3, c / 9) - vec3(1);
        let key = key_of(cell);
        let start = spans[2u * key];
        let end = min(spans[2u * key + 1u], start + CROWD);
        for (var k = start; k < end; k++) {
            let there = bitcast<vec4<f32>>(sorted[2u * k]);
            let d = (there.xyz - x) / params.reach_m;
            let apart2 = dot(d, d);
            if apart2 >= 1.0 || any(cell_of(there.xyz) != cell) {
                continue;
            }
            let root = bitcast<vec3<f32>>(sorted[2u * k + 1u].xyz);
            let near = cubed(1.0 - apart2) * cubed(there.w / params.spacing_m);
            // Colours from farther off than shapes: beads would show else.
            let w = (1.0 - apart2) * cubed(there.w / params.spacing_m) * select(1.0, OWN_COLOUR, k == own);
            light += w * root * root;
            total += w;
            first += near * d;
            volume += near;
        }
    }
    blended[2u * own] = vec4(light / total, 0.0);
    blended[2u * own + 1u] = vec4(first / volume, 0.0);
}
