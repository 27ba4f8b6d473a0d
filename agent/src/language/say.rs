//! Numbers as sentences say them.

/// Rounded to six digits that count: what is stored stays readable, and nobody measures better.
pub fn tidy(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    let scale = 10f64.powf(5.0 - value.abs().log10().floor());
    let rounded = if scale.is_finite() { (value * scale).round() / scale } else { 0.0 };
    if rounded.abs() < 1e-12 { 0.0 } else { rounded }
}

/// A vector of [`tidy`] numbers; what is nothing beside the longest component is 0.
pub fn tidy3(vector: glam::DVec3) -> [f64; 3] {
    let longest = vector.abs().max_element();
    vector.to_array().map(|v| if v.abs() < 1e-9 * longest { 0.0 } else { tidy(v) })
}

/// Two decimals, fewer for large numbers, more for small ones.
pub fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        v if v >= 100.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        v if v >= 0.1 => format!("{value:.2}"),
        v if v >= 1e-6 => format!("{:.*}", (1.0 - v.log10().floor()) as usize, value),
        _ => format!("{value:e}"),
    }
}

/// A number without the zeros that end it.
pub fn short(value: f64) -> String {
    let text = number(value);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// "0.30 m"
pub fn metres(value: f64) -> String {
    format!("{} m", number(value))
}

/// "2.43 m/s"
pub fn speed(value: f64) -> String {
    format!("{} m/s", number(value))
}

/// "0.5 s"
pub fn seconds(value: f64) -> String {
    format!("{} s", short(value))
}

/// "1.62 m/s²"
pub fn acceleration(value: f64) -> String {
    format!("{} m/s²", short(value))
}

/// "30 kPa"
pub fn pressure(value: f64) -> String {
    match value.abs() {
        v if v >= 1e9 => format!("{} GPa", short(value / 1e9)),
        v if v >= 1e6 => format!("{} MPa", short(value / 1e6)),
        v if v >= 1e3 => format!("{} kPa", short(value / 1e3)),
        _ => format!("{} Pa", short(value)),
    }
}

/// "Young's modulus 10 kPa, Poisson's ratio 0.45, 1030 kg/m³"
pub fn material(material: &phystalk::spec::Material) -> String {
    use phystalk::spec::{Material, Young};
    let young = material.young_pa().map(|young| match young {
        Young::Value(young) => format!("Young's modulus {}", pressure(young)),
        Young::AtLeast(young) => format!("Young's modulus {}, more where its weight asks for it", pressure(young)),
        Young::Auto => "automatic stiffness".to_owned(),
    });
    let own = match material {
        Material::Rigid(m) => vec![format!("friction {}", short(m.friction)), format!("gives back {} % of the speed", short(100.0 * m.restitution))],
        Material::Elastic(m) => vec![format!("Poisson's ratio {}", short(m.poisson))],
        Material::Muscle(m) => vec![format!("pulls with {} % of it", short(100.0 * m.activation.at(0.0)))],
        Material::Plastic(m) => vec![format!("yields at {}", pressure(m.yield_stress_pa))],
        Material::Viscoplastic(m) => {
            vec![format!("yields at {}", pressure(m.yield_stress_pa)), format!("viscosity {} Pa·s", short(m.viscosity_pa_s))]
        }
        Material::Sand(m) => vec![format!("friction angle {}°", short(m.friction_angle_deg)), format!("cohesion {}", pressure(m.cohesion_pa))],
        Material::Snow(m) => vec![format!("packs from {} % of compression", short(100.0 * m.theta_c))],
        Material::Liquid(m) => {
            vec![format!("viscosity {} Pa·s", short(m.viscosity_pa_s)), format!("surface tension {} N/m", short(m.surface_tension_n_m))]
        }
    };
    let words: Vec<String> = young.into_iter().chain(own).chain([format!("{} kg/m³", short(material.density_kg_m3()))]).collect();
    format!("{}, {}", material.kind(), words.join(", "))
}

/// "1 turn a second"
pub fn turns(rate_rad_s: f64) -> String {
    let turns = short(rate_rad_s.abs() / std::f64::consts::TAU);
    if turns == "1" { "1 turn a second".to_owned() } else { format!("{turns} turns a second") }
}

/// "a", "a and b", "a, b and c"
pub fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!(tidy(2.426_108_819), 2.42611);
        assert_eq!(tidy(-1e-300), 0.0);
        assert_eq!(metres(0.3), "0.30 m");
        assert_eq!(pressure(3e4), "30 kPa");
        assert_eq!(short(0.5), "0.5");
        assert_eq!(number(0.0123), "0.012");
        assert_eq!(list(&["a".into(), "b".into(), "c".into()]), "a, b and c");
    }
}
