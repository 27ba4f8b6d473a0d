// What a surface without captured light looks like: brighter above than below, and a mirror of a room with a bright window,
// the more so the flatter it is looked at (Schlick 1994). All in display-referred colours.

// `normal` is as long as it is sure, 0 to 1; `look` goes from the eye to the surface.
fn lit(colour: vec3<f32>, normal: vec3<f32>, gloss: f32, look: vec3<f32>) -> vec3<f32> {
    let sure = length(normal);
    var n = normal / max(sure, 1e-6);
    // Sheets have two sides.
    n *= select(1.0, -1.0, dot(n, look) > 0.0);
    let matt = colour * mix(1.0, mix(LIT_BELOW, LIT_ABOVE, 0.5 + 0.5 * n.z), sure);
    let away = look - 2.0 * dot(look, n) * n;
    let grazing = 1.0 - abs(dot(look, n));
    let grazing2 = grazing * grazing;
    // What shines more than water does so where it is looked at straight; along it everything is a mirror.
    let mirrored = sure * (gloss * MIRROR + min(gloss, 1.0) * (1.0 - MIRROR) * grazing2 * grazing2 * grazing);
    let room = mix(ROOM_BELOW, ROOM_ABOVE, smoothstep(-0.3, 0.8, away.z));
    let window = WINDOW * smoothstep(WINDOW_EDGE, WINDOW_CORE, dot(away, vec3(WINDOW_X, WINDOW_Y, WINDOW_Z)));
    return mix(matt, vec3(room + window), min(mirrored, 1.0));
}
