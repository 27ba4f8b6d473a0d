// Sort, last pass: within each cell by original index, so that the order depends on positions alone
// and every f32 sum over it repeats to the bit. Where workgroups go by block, an item's particles are then
// dealt out in rounds of every eighth, so that neighbours lie in different cells and seldom add to one node
// at once. Copies the particles into that order; into the one that they have where a particle left the window.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> slots: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> kinematics_out: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> matter_out: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> block_start: array<u32>;
@group(0) @binding(7) var<storage, read> cell_end: array<u32>;
@group(0) @binding(8) var<storage, read_write> control: Control;
@group(0) @binding(9) var<storage, read> cell_start: array<u32>;

// An item of a block, in which a slot lies: its first slot, and how many.
fn item_with(slot: u32, block: u32) -> vec2<u32> {
    let item = (slot - block_start[block]) / params.item_particles;
    let first = block_start[block] + item * params.item_particles;
    return vec2<u32>(first, min(params.item_particles, cell_end[64u * block + 63u] - first));
}

// From the order of cells to that of rounds, within an item. Of eight hands the first few are one longer.
fn dealt(slot: u32, item: vec2<u32>) -> u32 {
    let k = slot - item.x;
    let hand = k & 7u;
    return item.x + hand * (item.y / 8u) + min(hand, item.y & 7u) + k / 8u;
}

// And back.
fn undealt(slot: u32, item: vec2<u32>) -> u32 {
    let k = slot - item.x;
    let size = item.y / 8u;
    let longer = (item.y & 7u) * (size + 1u);
    let late = k >= longer;
    let length = max(select(size + 1u, size, late), 1u);
    let past = select(k, k - longer, late);
    return item.x + 8u * (past % length) + select(0u, item.y & 7u, late) + past / length;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = params.count;
    if (id.x >= n) {
        return;
    }
    if (atomicLoad(&control.window) != 0u) {
        hand_on(id.x, id.x);
        return;
    }
    var slot = id.x;
    var mine = slots[slot];
    if (params.mixes != 0u) {
        // Neighbours write to neighbours.
        slot = undealt(slot, item_with(slot, mine.x >> 6u));
        mine = slots[slot];
    }
    // How many of its cell come before it.
    var target_slot = cell_start[mine.x];
    for (var k = cell_start[mine.x]; k < cell_end[mine.x]; k++) {
        target_slot += select(0u, 1u, slots[k].y < mine.y);
    }
    if (params.mixes != 0u) {
        target_slot = dealt(target_slot, item_with(target_slot, mine.x >> 6u));
    }
    hand_on(mine.z, target_slot);
}
