// Snow (Stomakhin et al. 2013): fixed corotated, of which stretches beyond [1 - theta_c, 1 + theta_s]
// turn plastic; packed snow is stiffer, loosened snow softer.
//
// values: theta_c, theta_s, hardening, the most that it stiffens by. History: det of the plastic part of F.
fn snow(s: Substance, stretches: vec3<f32>, history: f32, mu: f32, lambda: f32) -> Kept {
    let kept = clamp(stretches, vec3<f32>(1.0 - s.values[0]), vec3<f32>(1.0 + s.values[1]));
    // What is inside out counts as crushed flat.
    let volume = max(stretches.x * stretches.y * stretches.z, 1e-6);
    let j = kept.x * kept.y * kept.z;
    let changed = any(kept != stretches);
    let packing = select(history, clamp(history * volume / j, PACKING_LEAST, PACKING_MOST), changed);
    let stiffening = snow_stiffening(s, packing);
    let stress = stiffening * (2.0 * mu * (kept - vec3<f32>(1.0)) * kept + vec3<f32>(lambda * j * (j - 1.0)));
    return Kept(kept, changed, packing, stress);
}
