//! Specs as text: TOML or JSON, and after a line `---` edits as `--set` has them.

use crate::target::{Target, class};
use phystalk::spec::{Edit, Spec, random};

/// TOML, JSON and edits.
pub struct SpecText;

/// A line that edits follow.
const EDITS: &str = "\n---\n";

impl Target for SpecText {
    fn name(&self) -> &'static str {
        "spec"
    }

    fn seeds(&self) -> Vec<Vec<u8>> {
        let demo = phystalk::scene::demo::spec();
        let edits =
            ["object.vase.material.young_pa=3e4", "time.duration_s=2", "force+={\"name\":\"w\",\"object\":\"vase\",\"acceleration_m_s2\":[1,0,0]}"];
        let mut seeds = vec![
            [demo.to_toml(), EDITS.to_owned(), edits.join("\n")].concat(),
            demo.to_value().to_string(),
            "format = 1\nscene.file = \"a.splat\"\n[[object]]\nname = \"a\"\n".to_owned(),
        ];
        seeds.extend((1..9).filter_map(|seed| Some(random::spec(seed, "a.splat", random::Size::Small).ok()?.to_toml())));
        seeds.into_iter().map(String::into_bytes).collect()
    }

    fn dictionary(&self) -> Vec<&'static [u8]> {
        vec![
            b"[[object]]\n",
            b"[[object.part]]\n",
            b"[[pin]]\n",
            b"[[force]]\n",
            b"[[event]]\n",
            b"[[collider]]\n",
            b"[camera]\n",
            b"name = \"a\"\n",
            b"object = \"a\"\n",
            b"material = { kind = \"liquid\" }\n",
            b"select = { ids = [0, 1] }\n",
            b"acceleration_m_s2 = \"vec3(sin(t), x.x / 0, 0)\"\n",
            b"\"auto\"",
            b"builtin:demo",
            b"bytes:%ff",
            b"{",
            b"[",
            b"[[[[[[[[[[[[[[[[",
            b"{\"a\":",
            b"null",
            b"nan",
            b"\xff",
            b"\n---\n",
            b"scene.file=",
            b"object.a.",
        ]
    }

    fn memory(&self, input_bytes: usize) -> usize {
        // The schema that specs are checked against, made once, and trees of values: about a hundred bytes for a character.
        (32 << 20) + 1024 * input_bytes
    }

    fn run(&self, input: &[u8]) -> Result<String, String> {
        let text = String::from_utf8_lossy(input);
        let (text, edits) = text.split_once(EDITS).unwrap_or((&text, ""));
        let read = if text.trim_start().starts_with('{') { Spec::from_json(text) } else { Spec::from_toml(text) };
        let spec = match read {
            Ok(spec) => spec,
            Err(error) => return Ok(class(&error.to_string())),
        };
        reads_back(&spec)?;
        let edits: Result<Vec<Edit>, _> = edits.lines().filter(|line| !line.is_empty()).map(Edit::parse_set).collect();
        match edits.and_then(|edits| spec.apply(&edits)) {
            Ok(edited) => reads_back(&edited).map(|()| "accepted".to_owned()),
            Err(error) => Ok(format!("accepted, then {}", class(&error.to_string()))),
        }
    }
}

/// A spec that was accepted has a canonical text that is accepted and means the same.
fn reads_back(spec: &Spec) -> Result<(), String> {
    let text = spec.to_toml();
    let again = Spec::from_toml(&text).map_err(|error| format!("the canonical text of an accepted spec is refused: {error}\n{text}"))?;
    if again.hash() == spec.hash() {
        Ok(())
    } else {
        Err(format!("a spec is another one after it was written and read:\n{text}\n{}", again.to_toml()))
    }
}
