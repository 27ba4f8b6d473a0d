// Liquids of smoothed particles have no part in the grid, nor have rigid bodies.
fn on_grid(tag: u32) -> bool {
    return (params.has_liquid == 0u || substances[row_of(tag)].kind != SPH_LIQUID) && !is_rigid(tag);
}
