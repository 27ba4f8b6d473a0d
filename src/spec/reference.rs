//! The reference of the spec, `docs/spec.md`, made from the schema and the tables of this room.

use std::fmt::Write as _;

use serde_json::Value;

use super::canonical::inline;
use super::expect::{METRICS, Shape};
use super::expression::{self, Name};
use super::{check, diff, later, presets, schema};

const HEAD: &str = "# The spec

What to simulate, in TOML; JSON says the same. Metres, seconds, kilograms, pascals; the world is z up. Units are part
of the names. `phystalk run SPEC.toml` runs one, `phystalk show VERSION` writes one, and what is left out has the default below.
This page is made from the program's own schema (`phystalk schema spec`); a test holds the two together.

```toml
format = 1

[scene]
file = \"vase.splat\"           # from this file's folder

[[object]]
name = \"vase\"
velocity_m_s = [0, 0, 3]

[[event]]
at_s = 0.5
object = \"vase\"
push_m_s = [0, 2, 0]

[[expect]]
that = \"vase.apex_m > 0.3\"
```
";

const EXPRESSIONS: &str = "
## Expressions

`acceleration_m_s2 = \"vec3(6 * sin(3 * t), 0, 0)\"` is worked out for every particle in every substep. It gives a vector, made of the names
and functions below with `+ - * /`, comparisons, `&& || !` and brackets; `.x`, `.y` and `.z` are the parts of a vector, and a number beside
a vector stands for all three. There are no loops and no access to anything. A text has at most 4096 bytes and 512 parts, 48 levels deep.

Where it gives no number (a division by zero, a root or a logarithm of a negative number, a broken power of one, anything past 3e38) the force
counts as zero for that particle and substep; `solver.undefined` of the metrics counts how often, and a warning says so. However stiff it
is (`-1e8 * (x - x0)`), it is followed without an overshoot that grows; no force brings a particle beyond 200 m/s (`solver.limited`).
";

const EDITS: &str = "
## Edits

Everything that changes a spec is a list of edits, accepted as a whole or not at all (`phystalk schema edit`):

```json
{ \"op\": \"set\",    \"path\": \"object.vase.material.young_pa\", \"value\": 30000 }
{ \"op\": \"add\",    \"path\": \"event\", \"value\": { \"at_s\": 0.5, \"object\": \"vase\", \"push_m_s\": [0, 2, 0] } }
{ \"op\": \"remove\", \"path\": \"collider.table\" }
```

Entries of lists are addressed by name, conditions by their text, the parts of a vector by `.x`, `.y` and `.z`. To remove a value
that is not an entry sets it back to its default. `--set PATH=VALUE` is a `set`, its value written as TOML writes it; a bare word is a text:
`--set object.vase.material.young_pa=3e4`, `--set world.gravity_m_s2=moon`, `--set camera=auto`.
";

const MATERIALS: &str = "
## Materials, parts and events in a few words

To set `material.kind` keeps what the new kind shares with the old one, an automatic stiffness excepted; to set a preset replaces the whole material.

`young_pa = \"auto\"` of what stands (elastic, muscle, plastic) is four times the self-buckling bound of its most slender part, 5e4 to 1e6 Pa; of what flows
(viscoplastic, sand, snow) it is what lets its own weight compress it by a hundredth, 1e4 to 1e6 Pa.

`young_pa = { at_least = 1e4 }`, jelly's, is that much, and more only where that would not bear what the place carries: then one and a half times the self-buckling bound, so that it
sags and sways at a touch and holds. A number is obeyed as given, also where the thing then falls over.

Parts are bonded: one body of several materials, without a gap or a contact between them. They are picked in the captured pose, by particles. Where two parts
overlap the later one has what both claim; a part that holds no particle has no effect; both are said as warnings.

An event does one thing, at `at_s` or `when = \"impact\"`: the first time that its object meets something, the ground, a collider or another object, that it
did not touch before. What it stands on counts once it has been half a cell clear of it. The run finds that by itself, to a sixteenth of a frame; `events` in the
metrics says when. A change of material keeps mass, place and speed: the new density is not read. What an event freezes stays solid until an event releases it.

A liquid with `solver = \"sph\"` is made of smoothed particles beside the grid: it splashes more sharply, costs more steps, and meets everything else; pins do not hold it.
";

const SPELLINGS: &str = "
## Other spellings that are read

- `material = \"jelly\"` and `material = { preset = \"jelly\", density_kg_m3 = 900 }`; a material without `kind` is elastic. `\"plastic\"` is the stuff, the
  kind is `{ kind = \"plastic\" }`.
- `gravity_m_s2 = \"moon\"`, `select = [3, 14, 15]` for `{ ids = [3, 14, 15] }`.
- Genesis's names, **converted by kind**, which is said as a warning: of solids `E`, `nu`, `rho`, Lamé's `mu` and `lam` or `lambda` (one of them with `nu`, or both),
  the models `corotation` and `neohooken`; of a plastic `von_mises_yield_stress` (a bound on the norm of the deviator: times √(3/2) in tension); of sand
  `friction_angle` and `cohesion`; of snow `yield_lower` and `yield_higher` (`theta_c`, `theta_s`); of a rigid body `rho`, `coup_friction`, `coup_restitution`; of a
  liquid `rho`, `mu` in m²/s (times density), `gamma` in m³/s² (times density times 0.03612: Rayleigh's integral over their pull between neighbours), while
  `stiffness` and `exponent` are not read: the speed of sound follows from depth.
- `expect = [\"vase.apex_m > 0.3\"]`.
- An object without a name takes the scene file's name up to its first dot; events without one become `event1`, `event2`, …
";

/// The whole page.
pub fn markdown() -> String {
    let mut page = Page { text: HEAD.to_owned(), shapes: Vec::new(), said_kinds: false };
    let root = schema::spec();
    page.text.push_str("\n## At the top\n");
    page.table(root);
    for (key, property) in properties(root) {
        match property["items"].get("$ref") {
            Some(_) => page.section(&format!("[[{key}]]"), property, &property["items"], 2),
            None => page.section(&format!("[{key}]"), property, property, 2),
        }
    }
    page.shapes();
    page.expressions();
    page.text.push_str(EDITS);
    page.conditions();
    page.presets();
    page.text.push_str(MATERIALS);
    page.text.push_str(SPELLINGS);
    page.later();
    page.text
}

struct Page {
    text: String,
    /// References to shapes that several places use, described once.
    shapes: Vec<&'static str>,
    /// Whether the kinds of materials have been described.
    said_kinds: bool,
}

impl Page {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// A table of the spec, or the forms of a choice; nothing for a plain value.
    fn section(&mut self, title: &str, property: &'static Value, schema: &'static Value, level: usize) {
        let schema = resolve(schema);
        let forms: Vec<&Value> = alternatives(schema).into_iter().map(resolve).filter(|form| form.get("properties").is_some()).collect();
        if schema.get("properties").is_none() && forms.is_empty() {
            return;
        }
        let about = text(property, "description").or_else(|| text(schema, "description")).unwrap_or_default();
        let _ = write!(self.text, "\n{} `{title}`\n\n{about}\n", "#".repeat(level));
        match forms.as_slice() {
            [] => self.table(schema),
            // "auto" or one table: the table itself.
            [form] => self.table(form),
            [first, ..] if kind(first).is_some() => return self.kinds(schema),
            _ => self.forms(schema),
        }
        let inner = if forms.len() == 1 { forms[0] } else { schema };
        let path = title.trim_matches(['[', ']']).to_owned();
        for (key, property) in properties(inner) {
            match property["items"].get("$ref") {
                Some(_) => self.section(&format!("[[{path}.{key}]]"), property, &property["items"], level + 1),
                None => self.section(&format!("{path}.{key}"), property, property, level + 1),
            }
        }
    }

    /// One row for each key.
    fn table(&mut self, schema: &'static Value) {
        self.line("\n| key | value | default | |\n|---|---|---|---|");
        for (key, property) in properties(schema) {
            let about = text(property, "description").unwrap_or_default();
            if property.get("const").is_some() {
                continue;
            }
            let default = match property.get("default") {
                Some(default) if default.is_object() => "see below".to_owned(),
                Some(default) => format!("`{}`", inline(default)),
                None if required(schema, key) => "required".to_owned(),
                None => String::new(),
            };
            let unit = diff::unit(key).map(|unit| format!(", {unit}")).unwrap_or_default();
            self.line(&format!("| `{key}` | {}{unit} | {} | {} |", cell(&value(property)), cell(&default), cell(&about)));
        }
    }

    /// A table for each kind of a material, the first time that materials are spoken of.
    fn kinds(&mut self, schema: &'static Value) {
        if std::mem::replace(&mut self.said_kinds, true) {
            return self.line("\nAs an object's, below `object.material`.");
        }
        for form in alternatives(schema).into_iter().map(resolve) {
            let (name, about) = (kind(form).unwrap_or_default(), text(form, "description").unwrap_or_default());
            let _ = write!(self.text, "\n**`kind = \"{name}\"`** {about}\n");
            self.table(form);
        }
    }

    /// One row for each form of a choice.
    fn forms(&mut self, schema: &'static Value) {
        self.line("\n| form | |\n|---|---|");
        for form in alternatives(schema) {
            let about = text(form, "description").unwrap_or_default();
            if let Some(word) = form.get("const") {
                self.line(&format!("| `{}` | {} |", inline(word), cell(&about)));
            }
            for (key, property) in properties(form) {
                let inside = match property["$ref"].as_str() {
                    Some(reference) => {
                        if !self.shapes.contains(&reference) {
                            self.shapes.push(reference);
                        }
                        "Its keys are below, under shapes".to_owned()
                    }
                    None => capital(&check::describe(property)),
                };
                self.line(&format!("| `{{ {key} = … }}` | {} {}. |", cell(&about), cell(&inside)));
            }
        }
    }

    /// The shapes that choices hold.
    fn shapes(&mut self) {
        self.line("\n## Shapes");
        let choices = ["Select", "Region", "ColliderShape"].map(|name| &schema::spec()["$defs"][name]);
        for reference in std::mem::take(&mut self.shapes) {
            let shape = resolve_reference(reference);
            let name = choices
                .iter()
                .flat_map(|choice| alternatives(choice))
                .flat_map(properties)
                .find(|(_, property)| property["$ref"].as_str() == Some(reference));
            let name = name.map(|(key, _)| key.as_str()).unwrap_or_default();
            let _ = write!(
                self.text,
                "\n### `{}`\n\n{}\n",
                if name == "half_space" { "plane, half_space" } else { name },
                text(shape, "description").unwrap_or_default()
            );
            self.table(shape);
        }
    }

    fn expressions(&mut self) {
        self.text.push_str(EXPRESSIONS);
        self.line("\n| name | |\n|---|---|");
        for name in Name::ALL {
            self.line(&format!("| `{}` | {}; {} |", name.word(), name.about(), name.kind().word()));
        }
        self.line("\n| function | |\n|---|---|");
        for (word, about) in expression::functions() {
            self.line(&format!("| `{word}` | {} |", cell(about)));
        }
    }

    fn conditions(&mut self) {
        self.text.push_str("\n## Conditions\n\n`OBJECT.METRIC > NUMBER`, with `>`, `>=`, `<`, `<=`, `==` or `!=`. Of a vector one says `.x`, `.y` or `.z`, of a series `.min`, `.max`, `.first`,\n`.last` or `.count`: `vase.com_m.z.max > 1`. A condition on a value that is not there does not hold.\n");
        self.line("\n| metric | | unit | |\n|---|---|---|---|");
        for metric in METRICS {
            let shape = match metric.shape {
                Shape::Number => "number",
                Shape::Vector => "vector",
                Shape::Series => "series",
                Shape::VectorSeries => "series of vectors",
            };
            self.line(&format!("| `{}` | {shape} | {} | {} |", metric.name, diff::unit(metric.name).unwrap_or_default(), metric.about));
        }
    }

    fn presets(&mut self) {
        self.text.push_str("\n## Presets\n\n| stuff | kind and parameters | |\n|---|---|---|\n");
        for preset in presets::MATERIALS {
            let fields = serde_json::to_value(&preset.material).unwrap_or_default();
            let ours = super::Material::of_kind(preset.material.kind()).and_then(|default| serde_json::to_value(default).ok()).unwrap_or_default();
            let pairs = properties_of(&fields).filter(|(key, value)| *key == "kind" || ours.get(key.as_str()) != Some(value));
            let pairs: Vec<String> = pairs.map(|(key, value)| format!("{key} = {}", inline(value))).collect();
            self.line(&format!("| `{}` | `{}` | {} |", preset.name, pairs.join(", "), preset.source));
        }
        self.text.push_str("\n| gravity | m/s² |\n|---|---|\n");
        for preset in presets::GRAVITY {
            self.line(&format!("| `{}` | {} |", preset.name, super::number(preset.m_s2)));
        }
    }

    fn later(&mut self) {
        self.text.push_str("\n## Not built yet\n\nThese are refused by name, with exit code 3.\n\n| | |\n|---|---|\n");
        for (what, words) in later::all() {
            self.line(&format!("| {what} | `{}` |", words.replace(", ", "`, `")));
        }
    }
}

/// The word by which a form of a tagged choice is chosen.
fn kind(form: &Value) -> Option<&str> {
    properties(form).find_map(|(_, property)| property.get("const")?.as_str())
}

/// What a property takes: a table that has a section of its own is only named.
fn value(property: &'static Value) -> String {
    let resolved = resolve(property);
    if property["items"].get("$ref").is_some() {
        return "a list of tables".to_owned();
    }
    let forms = alternatives(resolved);
    // A number or `{ at_least = number }` is said in a line.
    let with_tables = forms.iter().filter_map(|form| resolve(form)["properties"].as_object()).any(|table| !table.contains_key("at_least"));
    if resolved.get("properties").is_some() || with_tables { "see below".to_owned() } else { check::describe(property) }
}

fn resolve(schema: &'static Value) -> &'static Value {
    schema["$ref"].as_str().map_or(schema, resolve_reference)
}

fn resolve_reference(reference: &str) -> &'static Value {
    reference.strip_prefix('#').and_then(|pointer| schema::spec().pointer(pointer)).unwrap_or(&Value::Null)
}

fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema["properties"].as_object().into_iter().flatten()
}

fn properties_of(table: &Value) -> impl Iterator<Item = (&String, &Value)> {
    table.as_object().into_iter().flatten()
}

fn alternatives(schema: &Value) -> Vec<&Value> {
    schema.get("oneOf").or_else(|| schema.get("anyOf")).and_then(Value::as_array).into_iter().flatten().collect()
}

fn required(schema: &Value, key: &str) -> bool {
    schema["required"].as_array().is_some_and(|keys| keys.iter().any(|required| required == key))
}

fn text(schema: &Value, key: &str) -> Option<String> {
    schema[key].as_str().map(|text| text.replace('\n', " "))
}

/// As a sentence begins.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Text that does not end a cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    /// `UPDATE_DOCS=1 cargo test -p phystalk reference` writes the page anew.
    #[test]
    fn the_page_is_current() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/spec.md");
        let page = super::markdown();
        if std::env::var_os("UPDATE_DOCS").is_some() {
            crate::store::write_atomic(&path, page.as_bytes()).unwrap();
        }
        let written = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(written == page, "docs/spec.md is not what the code says: run UPDATE_DOCS=1 cargo test -p phystalk reference");
    }
}
