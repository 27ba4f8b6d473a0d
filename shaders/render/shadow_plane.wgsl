// One thread a texel: the light that reaches the plain ground, as a map that pictures sample.

@group(0) @binding(0) var<storage, read> bounds: array<u32>;
@group(0) @binding(1) var<storage, read> pyramid: array<f32>;
@group(0) @binding(2) var<storage, read> roof: array<u32>;
/// Origin x and y, texels a metre, a spare; then the factors, rows along x.
@group(0) @binding(3) var<storage, read_write> ground_map: array<f32>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let map = current_map();
    if id.x == 0u {
        ground_map[0] = map.origin.x;
        ground_map[1] = map.origin.y;
        ground_map[2] = 1.0 / map.texel;
    }
    if id.x < SIDE * SIDE {
        let place = vec2(f32(id.x % SIDE), f32(id.x / SIDE)) + 0.5;
        ground_map[4u + id.x] = shade_at(map, vec3(map.origin + place * map.texel, params.ground_m));
    }
}
