//! From flags to a spec, a session, a conversation.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::{output, stores};
use crate::conversation::Conversation;
use crate::conversation::output_folder::{self, OutputFolder, Owner};
use crate::history::{Session, Sessions};
use phystalk::spec::{Edit, Spec, file_name};
use phystalk::stages::Engine;
use phystalk::store::Store;
use std::path::{Path, PathBuf};

/// The engine of this process.
pub fn engine(flags: &Flags, store: Store) -> Engine {
    Engine::new(store, flags.device_request())
}

/// The `--set` flags as edits.
pub fn edits(flags: &Flags) -> Result<Vec<Edit>, Failure> {
    flags.set.iter().map(|text| Ok(Edit::parse_set(text)?)).collect()
}

/// A spec with the `--set` flags applied.
pub fn adjusted(spec: Spec, flags: &Flags) -> Result<Spec, Failure> {
    let mut notes = Vec::new();
    let adjusted = spec.apply_noted(&edits(flags)?, &mut notes);
    notes.iter().for_each(|note| output::note(format!("warning: {note}")));
    Ok(adjusted?)
}

/// A spec from a file. What was converted from another program's values is said.
pub fn read(path: &Path) -> Result<Spec, Failure> {
    let mut notes = Vec::new();
    let spec = Spec::read_noted(path, &mut notes);
    notes.iter().for_each(|note| output::note(format!("warning: {note}")));
    Ok(spec?)
}

/// For clap: an argument that names a file. One that is not UTF-8 becomes the text that a spec has for it.
pub fn file_argument() -> impl clap::builder::TypedValueParser<Value = String> {
    use clap::builder::TypedValueParser;
    clap::builder::OsStringValueParser::new().map(|argument| file_name::encode(Path::new(&argument)))
}

/// The spec that a scene starts with: defaults, one elastic object; a `.toml` or `.json` is read as
/// a spec, and `builtin:demo` is the built-in scene.
pub fn spec_of(scene: &str, flags: &Flags) -> Result<Spec, Failure> {
    let path = &file_name::decode(scene);
    let spec = if scene == "builtin:demo" {
        phystalk::scene::demo::spec()
    } else if is_spec(scene) {
        read(path)?
    } else {
        let path = std::path::absolute(path).map_err(|e| Failure::file("find", path, &e))?;
        let mut spec = Spec::of_scene(&file_name::encode(&path));
        // Of what cannot be read, reading the scene tells why.
        spec.scene.blake3 = phystalk::scene::digest(&path).ok();
        spec
    };
    adjusted(spec, flags)
}

/// Whether an argument names a spec rather than a version or a splat file.
pub fn is_spec(argument: &str) -> bool {
    Path::new(argument).extension().is_some_and(|e| e == "toml" || e == "json")
}

/// A conversation about a scene: goes on with a session where the flags say so, else starts one
/// whose scene was read first, so that a wrong path leaves nothing behind. `command` is who writes to the output folder.
pub fn converse(scene: Option<&str>, flags: &Flags, command: &str, out: impl Fn(&str) -> Option<PathBuf>) -> Result<Conversation, Failure> {
    stores::with_work(flags, |store| converse_in(store, scene, flags, command, out))
}

fn converse_in(
    store: &Store,
    scene: Option<&str>,
    flags: &Flags,
    command: &str,
    out: impl Fn(&str) -> Option<PathBuf>,
) -> Result<Conversation, Failure> {
    let sessions = stores::sessions(flags, store)?;
    let known = flags.session.as_ref().is_some_and(|name| sessions.has(name).is_ok_and(|known| known));
    let mut engine = engine(flags, store.clone());
    engine.open_ahead();
    let resumed = flags.resume || known;
    let session = match scene {
        _ if resumed => old_session(scene, flags, &sessions)?,
        Some(scene) => {
            if let Some(out) = &flags.out {
                output_folder::check(out, None, command, flags.replace)?;
            }
            let spec = spec_of(scene, flags)?;
            engine.facts(&spec, Path::new(""), &flags.run_options())?;
            sessions.start(flags.session.as_deref(), spec)?
        }
        None => return Err(Failure::new(Kind::Usage, "no scene: give a splat file (.ply or .splat), a spec (.toml), or --continue")),
    };
    let folder = out(session.name()).map(|dir| output(dir, store, &session, flags, command)).transpose()?;
    let mut conversation = Conversation::new(engine, session, flags.run_options(), folder, flags.cpu);
    (conversation.details, conversation.resumed) = (flags.verbose, resumed);
    Ok(conversation)
}

/// The output folder of a session, refused where it holds files of another one.
pub fn output(dir: PathBuf, store: &Store, session: &Session, flags: &Flags, command: &str) -> Result<OutputFolder, Failure> {
    let owner = Owner { store: store.id().unwrap_or_default().to_owned(), session: session.name().to_owned(), command: command.to_owned() };
    OutputFolder::open(dir, owner, flags.replace)
}

/// An old session, which must be about the scene that was named, if one was.
fn old_session(scene: Option<&str>, flags: &Flags, sessions: &Sessions) -> Result<Session, Failure> {
    let session = sessions.open(flags.session.as_deref())?;
    let asked = scene.map(|s| spec_of(s, &Flags::default())).transpose()?;
    let same = |asked: &Spec| {
        asked.scene.blake3 == session.base().scene.blake3 && (asked.scene.blake3.is_some() || asked.scene.file == session.base().scene.file)
    };
    match asked {
        Some(asked) if !same(&asked) => Err(Failure::new(
            Kind::Usage,
            format!(
                "session {} is about {}, not {}; leave the scene out to go on with it, or leave --continue and --session out to start another",
                session.name(),
                session.base().scene.file,
                asked.scene.file
            ),
        )),
        _ => Ok(session),
    }
}

/// Where pictures of a session go unless `--out` says otherwise.
pub fn default_out(flags: &Flags, session: &str) -> PathBuf {
    flags.out.clone().unwrap_or_else(|| Path::new("phystalk-out").join(session))
}

/// Whether an argument names a file or the built-in scene rather than a version.
pub fn is_file(argument: &str) -> bool {
    argument.contains(['.', '/', '\\', ':'])
}

/// A spec by file, that of a scene by itself, or of a version of the session.
pub fn spec_by_name(name: &str, flags: &Flags) -> Result<(Spec, String), Failure> {
    if is_file(name) {
        return Ok((spec_of(name, flags)?, name.to_owned()));
    }
    let (_, session) = stores::session(flags)?;
    let version = session.find(name)?.name.clone();
    Ok((adjusted(session.spec_of(&version)?, flags)?, version))
}
