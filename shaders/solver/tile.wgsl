// A workgroup's part of the grid, in workgroup memory: the 8^3 nodes that the particles of one block reach
// while they stay within a cell of it. One workgroup for each item of the sort's list.

// Strides that spread neighbouring cells over the banks of workgroup memory.
const TILE_ROW: u32 = 8u;
const TILE_SLAB: u32 = 68u;
const TILE_NODES: u32 = 544u;

struct Item {
    layer: u32,
    // The tile's first node, from the window's.
    corner: vec3<i32>,
    first: u32,
    count: u32,
}

// First nodes of the 3^3 blocks that the tile lies in, as they are stored.
var<workgroup> around: array<u32, 27>;

fn item_of(place: u32) -> Item {
    let item = items[1u + place];
    let block = block_of(item.y);
    return Item(block.layer, block.corner - vec3<i32>(1), item.z, item.w - item.z);
}

// To be called by all, before a barrier.
fn look_around(item: Item, lane: u32) {
    if (lane < 27u) {
        let block = (item.corner - vec3<i32>(3)) / 4 + vec3<i32>(vec3<u32>(lane % 3u, lane / 3u % 3u, lane / 9u));
        let inside = all(block >= vec3<i32>(0)) && all(block < vec3<i32>(params.blocks));
        around[lane] = 64u * select(0u, params.slots[block_number(vec3<u32>(max(block, vec3<i32>(0))), item.layer)], inside);
    }
}

// Where the k-th of the tile's 8^3 nodes is stored.
fn stored_in_tile(k: u32) -> u32 {
    // The corner is the last node of a block along each axis.
    let at = vec3<u32>(k & 7u, (k >> 3u) & 7u, k >> 6u) + vec3<u32>(3u);
    let block = at >> vec3<u32>(2u);
    let inner = at & vec3<u32>(3u);
    return around[block.x + 3u * block.y + 9u * block.z] + inner.x + 4u * inner.y + 16u * inner.z;
}

// And in the tile.
fn in_tile(k: u32) -> u32 {
    return (k >> 6u) * TILE_SLAB + (k & 63u);
}

// Whether a stencil that starts at a node lies in the tile.
fn tile_holds(item: Item, first: vec3<i32>, tag: u32) -> bool {
    let local = first - item.corner;
    return all(local >= vec3<i32>(0)) && all(local <= vec3<i32>(5)) && layer_of(tag) == item.layer;
}

fn tile_start(item: Item, first: vec3<i32>) -> u32 {
    let local = vec3<u32>(first - item.corner);
    return local.z * TILE_SLAB + local.y * TILE_ROW + local.x;
}
