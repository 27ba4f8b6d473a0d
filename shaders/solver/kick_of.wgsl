// A change of the velocity of one object: v = keep v + add.
struct Kick {
    add_m_s: vec3<f32>,
    keep: f32,
    object: u32,
}
