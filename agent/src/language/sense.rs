//! What a word or a group of words can mean.

use super::numbers::Quantity;
pub use super::verbs::{Fate, Field, Verb};

/// What can be more or less.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Young's modulus.
    Stiffness,
    /// "Harder": stiffer, or a stronger push where that was spoken of.
    Hardness,
    /// Mass density.
    Density,
    /// How high it jumps or from where it drops.
    Height,
    /// How fast it moves.
    Speed,
    /// How strong a push is.
    Strength,
    /// "Bigger": of a motion, how strong it is.
    Size,
    /// Restitution of the ground and colliders.
    Bounce,
    /// Friction of the ground and colliders.
    Friction,
    /// Length of the run.
    Duration,
    /// How far: of a throw or of the camera.
    Distance,
    /// Free fall.
    Gravity,
    /// Frames a second.
    FrameRate,
    /// The camera's angle.
    FieldOfView,
    /// Poisson's ratio.
    Poisson,
    /// How fine the grid is.
    Detail,
    /// How thick a liquid is.
    Viscosity,
    /// Its surface tension.
    Tension,
    /// What grains bear without pressure.
    Cohesion,
    /// How well it holds together, whatever does that.
    Hold,
    /// "Sticky": of grains their cohesion, of liquids how thick they are, else the friction of the ground.
    Stick,
    /// The stress at which it dents or flows.
    Yield,
    /// The slope of a heap.
    Slope,
}

/// How an adjective stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// "soft"
    Plain,
    /// "softer"
    Comparative,
}

/// A direction as said; what it is in the world depends on the object's front or on the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The object's front.
    Forward,
    /// Its back.
    Backward,
    /// Its left.
    Left,
    /// Its right.
    Right,
    /// To a side, nobody said which: its left.
    Sideways,
    /// Against gravity's usual way: +z.
    Up,
    /// -z.
    Down,
    /// Along the ground to the camera.
    Towards,
    /// Along the ground away from the camera.
    Away,
    /// Left in the picture.
    ScreenLeft,
    /// Right in the picture.
    ScreenRight,
    /// A world axis: 0 x, 1 y, 2 z, and its sign.
    Axis(u8, bool),
    /// Counter-clockwise seen from above.
    Anticlockwise,
    /// Clockwise seen from above.
    Clockwise,
}

/// From where something is seen, or comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From the object's front.
    Front,
    /// From behind it.
    Back,
    /// From its left.
    Left,
    /// From its right.
    Right,
    /// From above.
    Above,
    /// From just over the ground.
    Below,
    /// The camera that the program chooses.
    Auto,
}

/// Part of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The lowest twentieth.
    Base,
    /// The highest twentieth.
    Top,
    /// The lower half.
    LowerHalf,
    /// The upper half.
    UpperHalf,
    /// The lowest third.
    LowerThird,
    /// The highest third.
    UpperThird,
    /// The third between them.
    MiddleThird,
    /// Its left half, as it faces.
    LeftHalf,
    /// Its right half.
    RightHalf,
    /// Its front half.
    FrontHalf,
    /// Its back half.
    BackHalf,
    /// What is above its neck, or the height at which its colours change most.
    Flowers,
    /// What is below it.
    Pot,
    /// All that is no part of its own.
    Rest,
    /// The highest and the lowest twentieth.
    Ends,
}

/// What is put around things.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scenery {
    /// Everything behind a plane.
    Wall,
    /// A cube.
    Block,
    /// A sphere.
    Ball,
    /// An upright rod.
    Post,
}

/// What a thing is led along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// Round and round.
    Circle,
    /// A figure of eight.
    Eight,
    /// A square.
    Square,
}

/// How it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pose {
    /// Turned by half a turn about its front.
    UpsideDown,
    /// Turned by a quarter.
    OnItsSide,
    /// As captured.
    Upright,
}

/// A moment that follows from the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// At the top of a jump.
    Apex,
    /// When it comes down.
    Landing,
    /// When it comes down once more, or every time: no event waits for that.
    LaterLanding,
    /// So long after it came down: no event waits for that.
    AfterLanding,
    /// Half way up or down.
    OnTheWay,
}

/// What concerns turns of the conversation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnWord {
    /// A version back.
    Undo,
    /// A version forward.
    Redo,
    /// A version by its name.
    BackTo,
    /// The first version.
    First,
    /// The direction of the last edits, reversed.
    OtherWay,
    /// The last edits once more.
    Again,
}

/// A material that later issues build, and why it is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unbuilt {
    /// Water and the like.
    Liquid,
    /// Steel and the like.
    Rigid,
    /// Clay and the like.
    Plastic,
    /// Mud and the like.
    Viscoplastic,
    /// Sand and the like.
    Grains,
    /// Smoke and the like.
    Gas,
    /// Walking, swimming.
    Muscle,
    /// Burning, boiling.
    Heat,
    /// Squeezing, shaking.
    Deform,
    /// Colour and light.
    Look,
    /// Bigger, smaller, copies.
    Scene,
    /// Playback speed.
    Playback,
    /// Stuff put inside a thing or poured on it.
    Filling,
    /// A change that runs through a thing from one side to the other.
    Front,
    /// Another thing that moves.
    Mover,
    /// A swing about a point above.
    Pendulum,
}

/// What a word or a group of words means.
#[derive(Clone, Debug, PartialEq)]
pub enum Sense {
    /// Objects by their indices.
    Objects(Vec<usize>),
    /// The object spoken of.
    It,
    /// Every object.
    All,
    /// The camera.
    Camera,
    /// The ground and the colliders.
    Ground,
    /// A thing around.
    Scenery(Scenery),
    /// Something that things hang from.
    Overhead,
    /// What it is led along.
    Course(Course),
    /// How an object becomes a solid.
    Proxy(phystalk::spec::ProxyKind),
    /// A verb.
    Verb(Verb),
    /// More (1) or less (-1) of a property.
    Change(f64),
    /// How much: an exponent of the step of a comparative, a multiplier of the strength of an adverb.
    Degree(f64),
    /// An adverb of strength: -1 gently, 1 hard.
    Strength(f64),
    /// So many times.
    Factor(f64),
    /// A property by its noun.
    Property(Property),
    /// An adjective: the property that it speaks of, which way, and its form.
    Quality(Property, f64, Form),
    /// A preset of the spec.
    Material(&'static str),
    /// Something that later versions build.
    Unbuilt(Unbuilt),
    /// Free fall, m/s2.
    Gravity(f64),
    /// Restitution of a surface.
    Springy(f64),
    /// Friction of a surface.
    Surface(f64),
    /// A direction.
    Direction(Direction),
    /// From where it is seen.
    View(View),
    /// Part of an object.
    Part(Part),
    /// A pose.
    Pose(Pose),
    /// A moment.
    Moment(Moment),
    /// A word about turns.
    Turn(TurnWord),
    /// The name of a version.
    Version(u32),
    /// Of a liquid: solved by smoothed particles, or on the grid.
    Smoothed(bool),
    /// The colour behind the picture.
    Backdrop(&'static str),
    /// Width and height of the picture.
    PictureSize([u32; 2]),
    /// Other random numbers.
    Reseed,
    /// Of wind: it comes in gusts.
    Gusty,
    /// The edge of what it stands on.
    Edge,
    /// "above the ground" after a length.
    AboveGround,
    /// "on", "at", "from" and so on.
    Preposition(Preposition),
    /// "the", "a".
    Article,
    /// "as" in a comparison.
    As,
    /// "not": holds the clause back unless something takes it.
    Negation,
    /// "if", "when": holds the clause back.
    Condition,
    /// "except": what follows is left as it is.
    Except,
    /// "below", "outside": a limit that holds the clause back.
    Limit,
    /// "whole": its parts too.
    Whole,
    /// "dies down": ends what acts.
    Ends,
    /// "wait": what follows comes later.
    Wait,
    /// "replace": other stuff for some that is there.
    Replace,
    /// Stuff that is there, in a part or from an event on: "the sand".
    Stuff(&'static str),
    /// A verb that nobody knows.
    Deed,
    /// "why", "how".
    Question,
    /// "instead": replaces what was asked before.
    Instead,
    /// Between clauses.
    Separator,
    /// Adds nothing.
    Filler,
    /// A number with its unit, and the preposition before it.
    Measure(Quantity, Option<Preposition>),
    /// At a time, seconds.
    At(f64),
    /// From one time to another, seconds.
    Span(f64, f64),
    /// Until a time, seconds.
    Until(f64),
    /// For so long, seconds.
    For(f64),
    /// Not in the lexicon.
    Unknown,
}

/// A small word before a number or a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preposition {
    /// at
    At,
    /// by
    By,
    /// from
    From,
    /// to
    To,
    /// for
    For,
    /// with
    With,
    /// after
    After,
    /// in
    In,
    /// on
    On,
    /// of
    Of,
    /// until
    Until,
    /// about an axis, or roughly
    Around,
    /// along an axis
    Along,
    /// into
    Into,
}
