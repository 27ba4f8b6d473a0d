//! What things are asked to do, and what is done to them.

/// What an object can be asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verb {
    /// Leaves the ground by itself.
    Jump,
    /// A jump with one turn in the air.
    Somersault,
    /// Comes down: by itself after a jump, else from a height.
    Fall,
    /// Falls from a height.
    Drop,
    /// Leans so far that it falls over.
    Topple,
    /// Starts higher.
    Lift,
    /// Gets a speed along the ground; the strength says how hard the word itself is.
    Push(f64),
    /// Is accelerated for a while.
    Pull,
    /// Gets a speed along the ground and upwards.
    Throw,
    /// Turns about an axis at a speed.
    Spin,
    /// Spins about a horizontal axis.
    Roll,
    /// Is turned by an angle before it starts.
    Turn,
    /// Leans by an angle before it starts.
    Tilt,
    /// Starts elsewhere.
    Move,
    /// Is held.
    Pin,
    /// Is held from above, clear of what is below it.
    Hang,
    /// Is let go.
    Release,
    /// Is blown at.
    Blow,
    /// Stops.
    Stop,
    /// Does nothing.
    Rest,
    /// Runs for a time.
    Run,
    /// The camera looks from somewhere.
    Look,
    /// The camera comes closer (1) or goes away (-1).
    Zoom(f64),
    /// The camera goes round.
    Orbit,
    /// Back to what it was.
    Reset,
    /// Is driven by a field.
    Field(Field),
    /// Becomes other stuff.
    Change(Fate),
}

/// What becomes of a thing by itself. Beside a material these only say that it turns into that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// A thick liquid of its own weight.
    Melt,
    /// A solid of the shape that it has.
    Freeze,
    /// Loose grains.
    Crumble,
    /// Water.
    Dissolve,
    /// A muscle that pulls again and again.
    Pulse,
    /// Pieces.
    Shatter,
}

/// What drives things all along, beside pulls and wind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Air that circles.
    Swirl,
    /// A blast.
    Explode,
    /// Towards its own middle.
    Attract,
    /// The drag of air.
    Air,
    /// The drag of water.
    Water,
    /// To and fro.
    Sway,
    /// To and fro, fast.
    Shake,
    /// Keeps turning.
    Motor,
    /// On a spring that draws it to where it starts.
    Spring,
}
