//! `phystalk still SCENE --camera FILE.json -o OUT`: pictures of a scene in its own frame. Nothing is
//! pruned, turned or scaled.

use super::exit::{Failure, Kind};
use super::flags::Flags;
use super::{output, setup};
use clap::{Args, ValueEnum};
use glam::{Mat4, Vec3};
use phystalk::export;
use phystalk::render::{Image, Profile, RenderOptions, View};
use phystalk::scene::{self, Loaded, SceneFrame};
use phystalk::store::Store;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Arguments {
    /// Splat file, .ply or .splat
    scene: PathBuf,
    /// Camera, or list of cameras, with OpenCV axes: width, height, fx, fy, cx, cy, world_to_camera, background
    /// [default: from in front and a little above, holding all of the scene]
    #[arg(long, value_name = "FILE.json")]
    camera: Option<PathBuf>,
    /// Picture to write, .png or .exr; with a list of cameras its name holds %d, which counts from 0
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Whose constants to draw with
    #[arg(long, value_enum, default_value = "gsplat")]
    profile: ProfileFlag,
    /// What is nearer is not drawn, in the file's units
    #[arg(long, default_value_t = 0.01, value_parser = parse_near)]
    near: f32,
}

/// Where the usual camera stands from the middle, its field of view, and the share of Gaussians on each side that it need
/// not hold.
const STANDS: [f32; 3] = [-0.87, -0.49, 0.3];
const SIZE: [u32; 2] = [1280, 720];
const FOV_DEG: f32 = 45.0;
const OUTERMOST: f32 = 0.005;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ProfileFlag {
    /// gsplat, classic
    Gsplat,
    /// The original implementation
    Inria,
    /// gsplat, antialiased
    Antialiased,
}

impl From<ProfileFlag> for Profile {
    fn from(flag: ProfileFlag) -> Profile {
        match flag {
            ProfileFlag::Gsplat => Profile::Gsplat,
            ProfileFlag::Inria => Profile::Inria,
            ProfileFlag::Antialiased => Profile::Antialiased,
        }
    }
}

fn parse_near(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|n: &f32| *n > 0.0 && n.is_finite()).ok_or_else(|| format!("\"{text}\" is not a distance: expected a number above 0"))
}

/// What the output's name asks for.
#[derive(Clone, Copy, PartialEq)]
enum Kinds {
    Png,
    Exr,
}

pub fn run(arguments: &Arguments, flags: &Flags) -> Result<(), Failure> {
    let kind = match arguments.output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("png") => Kinds::Png,
        Some("exr") => Kinds::Exr,
        _ => return Err(Failure::new(Kind::Usage, format!("{} is neither .png nor .exr", arguments.output.display()))),
    };
    let given = arguments.camera.as_ref().map(|camera| read_views(camera, flags.size)).transpose()?;
    let loaded = scene::read(&arguments.scene)?;
    let views = given.unwrap_or_else(|| Views { list: vec![usual_view(&loaded, flags.size)], is_list: false });
    let outputs = output_paths(&arguments.output, &views)?;
    loaded.warnings.iter().filter(|_| !flags.quiet).for_each(|w| output::note(format!("warning: {w}")));
    let exr = kind == Kinds::Exr;
    let options = RenderOptions { profile: arguments.profile.into(), near: arguments.near, colour: exr, depth: exr, ..RenderOptions::default() };
    let mut engine = setup::engine(flags, Store::scratch()?);
    let images = engine.still(&loaded.gaussians, &views.list, &options)?;
    for (image, path) in images.iter().zip(&outputs) {
        write(image, path, kind)?;
    }
    if flags.json {
        return output::json(
            &json!({ "pictures": outputs.iter().map(|path| phystalk::spec::file_name::encode(path)).collect::<Vec<_>>(), "gaussians": loaded.gaussians.len(), "device": engine.device()?.name() }),
        );
    }
    outputs.iter().try_for_each(|path| output::line(path.display()))
}

fn write(image: &Image, path: &Path, kind: Kinds) -> Result<(), Failure> {
    match (kind, &image.colour) {
        (Kinds::Exr, Some(colour)) => Ok(export::write_exr(path, image.size, colour, image.depth.as_deref())?),
        _ => Ok(export::write_png(path, image.size, &image.rgba8)?),
    }
}

/// A view that holds the scene without its outermost Gaussians: from the side that the automatic camera stands on, a little
/// above, on white.
fn usual_view(loaded: &Loaded, size: Option<[u32; 2]>) -> View {
    let size = size.unwrap_or(SIZE);
    let world = SceneFrame { up: loaded.up().axis, metres_per_unit: 1.0 }.rotation();
    let mut axes = [0, 1, 2].map(|axis| loaded.gaussians.mean.iter().map(|&p| (world * p)[axis]).collect::<Vec<f32>>());
    let [low, high] = [OUTERMOST, 1.0 - OUTERMOST].map(|share| {
        let at = |values: &mut Vec<f32>| {
            values.sort_by(f32::total_cmp);
            values.get((share * values.len().saturating_sub(1) as f32) as usize).copied().unwrap_or(0.0)
        };
        let [x, y, z] = &mut axes;
        Vec3::new(at(x), at(y), at(z))
    });
    let scales = &loaded.gaussians.scale;
    // A Gaussian shows to about three times its scale.
    let wide = 3.0 * scales.iter().map(|s| s.max_element()).sum::<f32>() / scales.len().max(1) as f32;
    let (middle, radius) = ((low + high) / 2.0, ((high - low) / 2.0).length() + wide.max(1e-6));
    let narrow = (0.5 * FOV_DEG.to_radians()).tan() * (size[0] as f32 / size[1] as f32).min(1.0);
    let eye = middle + Vec3::from(STANDS).normalize() * radius / narrow.atan().sin();
    let view = View::look_at(eye, middle, FOV_DEG, size).with_background([1.0; 3]);
    View { world_to_camera: view.world_to_camera * Mat4::from_mat3(world), ..view }
}

struct Views {
    list: Vec<View>,
    is_list: bool,
}

/// One camera or a list of them; `--size` scales each to another size with the same field of view.
fn read_views(path: &Path, size: Option<[u32; 2]>) -> Result<Views, Failure> {
    let bytes = std::fs::read(path).map_err(|e| Failure::file("read the camera", path, &e))?;
    let bad = |e: serde_json::Error| {
        Failure::other(format!(
            "{} is not a camera: {e}\nexpected {{\"width\", \"height\", \"fx\", \"fy\", \"cx\", \"cy\", \"world_to_camera\": 4 rows of 4, \"background\"}} or a list of such",
            path.display()
        ))
    };
    let is_list = bytes.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'[');
    let mut list: Vec<View> = if is_list { serde_json::from_slice(&bytes).map_err(bad)? } else { vec![serde_json::from_slice(&bytes).map_err(bad)?] };
    for view in &mut list {
        if let Some([width, height]) = size {
            let (x, y) = (width as f32 / view.width as f32, height as f32 / view.height as f32);
            *view = View { width, height, fx: view.fx * x, cx: view.cx * x, fy: view.fy * y, cy: view.cy * y, ..*view };
        }
        let sides = (1..=16384).contains(&view.width) && (1..=16384).contains(&view.height);
        if !(sides && view.fx > 0.0 && view.fy > 0.0) {
            return Err(Failure::other(format!("{}: width and height must be 1 to 16384 and fx, fy above 0", path.display())));
        }
    }
    Ok(Views { list, is_list })
}

/// One file a camera; `%d` becomes its number.
fn output_paths(output: &Path, views: &Views) -> Result<Vec<PathBuf>, Failure> {
    let name = output.to_string_lossy();
    if views.is_list && !name.contains("%d") {
        return Err(Failure::new(
            Kind::Usage,
            format!("{name} has no %d, and the camera file holds a list of {}: name it as out_%d.png", views.list.len()),
        ));
    }
    Ok((0..views.list.len()).map(|i| PathBuf::from(name.replace("%d", &i.to_string()))).collect())
}
