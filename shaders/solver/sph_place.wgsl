// Start of a substep: what the passes over neighbours read of each particle, the pressures that the last
// substep ended with, and no rounds that would run by themselves.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> substances: array<Substance>;
// Pressure, and how much too dense it may be, in the original order.
@group(0) @binding(4) var<storage, read> kept: array<vec4<f32>>;
// Position, and volume in cells; that of a solid with a minus.
@group(0) @binding(5) var<storage, read_write> place: array<vec4<f32>>;
// Velocity, viscosity.
@group(0) @binding(6) var<storage, read_write> motion: array<vec4<f32>>;
// 1 / density, surface tension, viscosity, how much too dense it may be.
@group(0) @binding(7) var<storage, read_write> nature: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> pressure: array<f32>;
@group(0) @binding(9) var<storage, read_write> errors: array<u32>;
// Workgroups of even rounds, and of odd ones.
@group(0) @binding(10) var<storage, read_write> even: array<vec4<u32>>;
@group(0) @binding(11) var<storage, read_write> odd: array<vec4<u32>>;
// Places as the search first sees them.
@group(0) @binding(12) var<storage, read_write> coarse: array<u32>;

// A place within four cells, ten bits an axis; whether it is liquid. From the window's corner: rounding is then as
// fine far from the origin as beside it.
fn coarsely(x: vec3<f32>, liquid: bool) -> u32 {
    let from_corner = (x - params.cell_m * vec3<f32>(params.origin)) * params.per_m;
    let steps = vec3<u32>(vec3<i32>(floor(from_corner * COARSE_STEPS))) & vec3<u32>(1023u);
    return steps.x | (steps.y << 10u) | (steps.z << 20u) | select(0u, 1u << 30u, liquid);
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < SPH_SLOTS) {
        errors[id.x] = 0u;
        even[id.x] = vec4<u32>(0u);
        odd[id.x] = vec4<u32>(0u);
    }
    let n = params.count;
    let i = id.x;
    if (i >= n) {
        return;
    }
    let position = kinematics[i];
    let tag = matter[3u * n + i];
    let substance = substances[row_of(bitcast<u32>(tag.y))];
    let liquid = substance.kind == SPH_LIQUID;
    var volume = matter[2u * n + i].w;
    if (!liquid) {
        volume *= clamp(determinant(read_deformation(i)), 0.1, 10.0);
    }
    let cells = volume * params.per_m * params.per_m * params.per_m;
    let viscosity = select(0.0, substance.values[0], liquid);
    place[i] = vec4<f32>(position.xyz, select(-cells, cells, liquid));
    coarse[i] = coarsely(position.xyz, liquid);
    motion[i] = vec4<f32>(kinematics[n + i].xyz, viscosity);
    let own = select(vec4<f32>(0.0), kept[bitcast<u32>(tag.x)], liquid);
    nature[i] = vec4<f32>(volume / position.w, select(0.0, substance.values[1], liquid), viscosity, own.y);
    pressure[i] = own.x;
}
