// What is summed over the blocks of the window: particles, active blocks, workgroups that take a block's
// particles.

fn worth(info: vec2<u32>) -> vec3<u32> {
    return vec3<u32>(info, (info.x + params.item_particles - 1u) / params.item_particles);
}
