//! Genesis's names of material parameters. The same name says different things of different kinds,
//! so each is converted by the kind that it stands in; what was converted is told.

use serde_json::{Map, Value, json};

use super::canonical::number;
use super::error::{SpecError, SpecErrorKind, show};
use super::{Material, Young, path};

/// Their names of what every solid has, and ours.
const SOLID: [(&str, &str); 3] = [("E", "young_pa"), ("nu", "poisson"), ("rho", "density_kg_m3")];

/// Their names that are ours but for a unit: kind, theirs, ours.
const RENAMED: [(&str, &str, &str); 8] = [
    ("rigid", "rho", "density_kg_m3"),
    ("rigid", "coup_friction", "friction"),
    ("rigid", "coup_restitution", "restitution"),
    ("liquid", "rho", "density_kg_m3"),
    ("sand", "friction_angle", "friction_angle_deg"),
    ("sand", "cohesion", "cohesion_pa"),
    ("snow", "yield_lower", "theta_c"),
    ("snow", "yield_higher", "theta_s"),
];

/// Lamé's two parameters, under their names.
const LAME: [&str; 3] = ["mu", "lam", "lambda"];

/// A uniaxial yield stress over their von Mises bound, which is on the norm of the deviator.
const UNIAXIAL: f64 = 1.224_744_871_391_589; // sqrt(3/2)

/// Surface tension over density times their `gamma`. Their pull of a neighbour is an acceleration gamma x W(x); Rayleigh's
/// integral over a sharp surface, sigma = (pi/8) n^2 m gamma int r^5 W dr, with their kernel of reach h = 2 d, constant
/// within d, and a volume of 0.8 d^3 for each particle, gives this number whatever the spacing d.
const TENSION_OVER_GAMMA: f64 = 0.036_12;

/// What settling a material reads, writes and tells.
pub(super) struct Settling<'a> {
    pub table: &'a mut Map<String, Value>,
    pub place: &'a str,
    pub notes: &'a mut Vec<String>,
}

/// Brings the table of one kind into our names.
pub(super) fn settle(kind: &str, settling: &mut Settling) -> Result<(), SpecError> {
    let solid = Material::of_kind(kind).is_some_and(|material| material.poisson().is_some());
    let renamed = SOLID.into_iter().filter(|_| solid);
    for (theirs, ours) in renamed.chain(RENAMED.into_iter().filter(|(of, ..)| *of == kind).map(|(_, theirs, ours)| (theirs, ours))) {
        settling.rename(theirs, ours)?;
    }
    if solid {
        settling.lame(kind)?;
    }
    match kind {
        "elastic" | "muscle" => settling.model(),
        "plastic" => settling.von_mises()?,
        "liquid" => settling.liquid()?,
        _ => {}
    }
    if kind == "muscle" && settling.table.get("n_groups").is_some_and(|groups| groups.as_f64() == Some(1.0)) {
        settling.table.shift_remove("n_groups");
    }
    Ok(())
}

/// Our keys that one of their names stands for: what a value under that name replaces.
pub(super) fn stands_for(kind: &str, key: &str) -> &'static [&'static str] {
    let renamed = SOLID.iter().map(|(theirs, ours)| (*theirs, ours)).chain(RENAMED.iter().filter(|(of, ..)| *of == kind).map(|(_, t, o)| (*t, o)));
    if let Some((_, ours)) = renamed.into_iter().find(|(theirs, _)| *theirs == key) {
        return std::slice::from_ref(ours);
    }
    match (kind, key) {
        ("liquid", "mu") => &["viscosity_pa_s"],
        ("liquid", "gamma") => &["surface_tension_n_m"],
        ("plastic", "von_mises_yield_stress") => &["yield_stress_pa"],
        (_, key) if LAME.contains(&key) => &["young_pa"],
        _ => &[],
    }
}

impl Settling<'_> {
    fn rename(&mut self, theirs: &str, ours: &str) -> Result<(), SpecError> {
        let Some(value) = self.table.shift_remove(theirs) else { return Ok(()) };
        if self.table.contains_key(ours) && self.table[ours] != value {
            return Err(twice(self.place, theirs, ours));
        }
        self.table.insert(ours.to_owned(), value);
        Ok(())
    }

    /// Takes a number out of the table.
    fn take(&mut self, name: &str, what: &str) -> Result<Option<f64>, SpecError> {
        let Some(value) = self.table.shift_remove(name) else { return Ok(None) };
        match value.as_f64().filter(|value| *value >= 0.0) {
            Some(value) => Ok(Some(value)),
            None => Err(SpecError::new(SpecErrorKind::Type, path::join(self.place, name), format!("{} is not {what}", show(&value)))
                .allowed("a number that is not negative")),
        }
    }

    /// Puts a converted number in, and tells how it came about.
    fn put(&mut self, theirs: &str, ours: &str, value: f64, how: &str) -> Result<(), SpecError> {
        if self.table.contains_key(ours) {
            return Err(twice(self.place, theirs, ours));
        }
        // Ten digits: a factor of ours is no more exact.
        let scale = 10f64.powf(9.0 - value.abs().max(1e-300).log10().floor());
        let value = if value == 0.0 { 0.0 } else { (value * scale).round() / scale };
        self.table.insert(ours.to_owned(), json!(value));
        self.notes.push(format!("{}: {how}, so {ours} = {}", path::join(self.place, theirs), number(value)));
        Ok(())
    }

    fn model(&mut self) {
        if let Some(model) = self.table.get_mut("model") {
            match model.as_str() {
                Some("corotation") => *model = json!("corotated"),
                Some("neohooken" | "neohookean") => *model = json!("neo_hookean"),
                _ => {}
            }
        }
    }

    /// Lamé's parameters to Young's modulus and Poisson's ratio: E = mu (3 lambda + 2 mu) / (lambda + mu),
    /// nu = lambda / (2 (lambda + mu)). One of the two is enough where nu is given.
    fn lame(&mut self, kind: &str) -> Result<(), SpecError> {
        let mut take = |name: &str| self.take(name, "a modulus").map(|value| value.filter(|value| *value > 0.0));
        let mu = take(LAME[0])?;
        let lambda = match take(LAME[1])? {
            Some(lambda) => Some(lambda),
            None => take(LAME[2])?,
        };
        if mu.is_none() && lambda.is_none() {
            return Ok(());
        }
        let default_nu = Material::of_kind(kind).and_then(|material| material.poisson()).unwrap_or(0.3);
        let given_nu = self.table.get("poisson").and_then(Value::as_f64);
        let nu = given_nu.unwrap_or(default_nu);
        let (name, young, nu) = match (mu, lambda) {
            (Some(_), Some(_)) if given_nu.is_some() => return Err(twice(self.place, "lambda", "poisson")),
            (Some(mu), Some(lambda)) => ("mu", mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), lambda / (2.0 * (lambda + mu))),
            (Some(mu), None) => ("mu", 2.0 * mu * (1.0 + nu), nu),
            (None, Some(lambda)) if nu <= 0.0 => {
                let message = format!("lambda = {} says nothing with poisson = {}", number(lambda), number(nu));
                return Err(SpecError::new(SpecErrorKind::Conflict, self.place, message).allowed("young_pa and poisson"));
            }
            (None, Some(lambda)) => ("lambda", lambda * (1.0 + nu) * (1.0 - 2.0 * nu) / nu, nu),
            (None, None) => return Ok(()),
        };
        if self.table.get("young_pa").is_some_and(|young| young != "auto") {
            return Err(twice(self.place, name, "young_pa"));
        }
        self.table.shift_remove("young_pa");
        self.table.insert("poisson".to_owned(), json!(nu));
        self.put(name, "young_pa", young, "Lamé's parameters of a solid")
    }

    fn von_mises(&mut self) -> Result<(), SpecError> {
        if let Some(bound) = self.take("von_mises_yield_stress", "a stress")? {
            self.put(
                "von_mises_yield_stress",
                "yield_stress_pa",
                bound * UNIAXIAL,
                "a bound on the norm of the deviator is sqrt(3/2) less than in tension",
            )?;
        }
        match self.table.get("use_von_mises").and_then(Value::as_bool) {
            Some(true) => {
                self.table.shift_remove("use_von_mises");
                for bound in ["yield_lower", "yield_higher"] {
                    if self.table.shift_remove(bound).is_some() {
                        self.notes.push(format!("{} is not read: von Mises' criterion yields by stress", path::join(self.place, bound)));
                    }
                }
            }
            Some(false) => {
                return Err(SpecError::new(
                    SpecErrorKind::NotBuilt,
                    path::join(self.place, "use_von_mises"),
                    "not built yet: yielding within a box of stretches",
                )
                .allowed("von Mises' criterion by yield_stress_pa, or kind = \"snow\" with theta_c and theta_s"));
            }
            None => {}
        }
        Ok(())
    }

    /// Of their SPH liquid: mu is kinematic. Of their MPM liquid `E`, `nu` and `lam` would be a stiffness, and then mu is Lamé's.
    fn liquid(&mut self) -> Result<(), SpecError> {
        for (key, why) in [
            ("stiffness", "the speed of sound follows from depth and speed"),
            ("exponent", "the speed of sound follows from depth and speed"),
            ("E", "the speed of sound follows from depth and speed"),
            ("nu", "a liquid has none"),
            ("lam", "the speed of sound follows from depth and speed"),
        ] {
            if matches!(key, "E" | "nu" | "lam") && self.table.contains_key(key) && self.table.contains_key("mu") {
                let message = format!("beside {key} this is Lamé's parameter of a solid; alone it is a viscosity in m²/s");
                return Err(SpecError::new(SpecErrorKind::Conflict, path::join(self.place, "mu"), message).allowed("viscosity_pa_s"));
            }
            if self.table.shift_remove(key).is_some() {
                self.notes.push(format!("{} is not read: {why}", path::join(self.place, key)));
            }
        }
        let density = self.table.get("density_kg_m3").and_then(Value::as_f64).unwrap_or(1000.0);
        if let Some(mu) = self.take("mu", "a viscosity")? {
            let how = format!("{} m²/s times {} kg/m³", number(mu), number(density));
            self.put("mu", "viscosity_pa_s", mu * density, &how)?;
        }
        if let Some(gamma) = self.take("gamma", "a pull between particles")? {
            let how = format!("{} m³/s² times {} kg/m³ times {}", number(gamma), number(density), number(TENSION_OVER_GAMMA));
            self.put("gamma", "surface_tension_n_m", gamma * density * TENSION_OVER_GAMMA, &how)?;
        }
        Ok(())
    }
}

fn twice(place: &str, theirs: &str, ours: &str) -> SpecError {
    SpecError::new(SpecErrorKind::Duplicate, place, format!("`{theirs}` and `{ours}` say the same")).allowed("one of them")
}

/// The part of a material that another kind has too; the rest takes that kind's defaults.
pub(super) fn switch_kind(table: &mut Map<String, Value>, kind: &str) {
    let Some(Value::Object(fields)) = Material::of_kind(kind).and_then(|material| serde_json::to_value(material).ok()) else { return };
    table.retain(|key, _| fields.contains_key(key));
    // A stiffness that was left to the program is left to the kind.
    if table.get("young_pa").is_some_and(|young| young == &json!(Young::Auto)) {
        table.shift_remove("young_pa");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral behind [`TENSION_OVER_GAMMA`], by the midpoint rule: sigma / (rho gamma) = (pi/8) / (0.8 d^3) int r^5 W dr.
    #[test]
    fn rayleighs_integral_over_their_kernel() {
        let kernel = |q: f64| if q <= 0.5 { 6.0 * q.powi(3) - 6.0 * q * q + 1.0 } else { 2.0 * (1.0 - q).powi(3) };
        let steps = 20_000;
        let pi = std::f64::consts::PI;
        // In units of d: h = 2, W = 8 / (pi h^3) kernel(r / h), constant within r = 1.
        let integral: f64 = (0..steps)
            .map(|i| 2.0 * (f64::from(i) + 0.5) / f64::from(steps))
            .map(|r| r.powi(5) * 8.0 / (pi * 8.0) * kernel(r.max(1.0) / 2.0) * 2.0 / f64::from(steps))
            .sum();
        let share = pi / 8.0 / 0.8 * integral;
        assert!((share / TENSION_OVER_GAMMA - 1.0).abs() < 1e-3, "{share}");
    }
}
