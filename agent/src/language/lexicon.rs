//! The words that the phrasebook knows, and what each means. `docs/phrases.md` is made from these tables.

use super::sense::*;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Words that share a meaning.
pub struct Entry {
    /// What they mean.
    pub sense: Sense,
    /// The words, `|` between them.
    pub words: &'static str,
}

/// Entries under a heading of `docs/phrases.md`.
pub struct Section {
    /// The heading.
    #[cfg_attr(not(test), expect(dead_code, reason = "the page of phrases alone has headings"))]
    pub title: &'static str,
    /// Its entries.
    pub entries: &'static [Entry],
}

macro_rules! entries {
    ($($sense:expr => $words:literal),* $(,)?) => { &[$(Entry { sense: $sense, words: $words }),*] };
}

use Form::{Comparative, Plain};
use Sense::{Change, Degree, Factor, Filler, Gravity, Quality, Strength, Surface, Turn};

/// Everything that the phrasebook knows.
pub const SECTIONS: &[Section] = &[
    Section {
        title: "Motions",
        entries: entries! {
            Sense::Verb(Verb::Jump) => "jump|jumps|jumping|jumped|jump up and down|jumps up and down|hop up and down|hop|hops|hopping|leap|leaps|leaping",
            Sense::Verb(Verb::Somersault) => "somersault|somersaults|backflip|frontflip|back flip|front flip",
            Sense::Verb(Verb::Fall) => "fall|falls|falling|fell|fall back|falls back|falling back|fall back down|back down|down again|back to the ground|back on the ground|back to the table|back onto the table|back on the table|back to the floor|falls back down|fall down|falls down|come back down|comes back down|come down|comes down|go down again|come to rest|comes to rest|settle|settles|land|lands|landing|lands again|land again|bounce|bounces|bouncing",
            Sense::Verb(Verb::Drop) => "drop|drops|dropped|dropping|drop down",
            Sense::Verb(Verb::Topple) => "topple|topples|topple over|tip over|tips over|tip it over|fall over|falls over|knock it over|knock over|keel over",
            Sense::Verb(Verb::Lift) => "lift|lifts|lifted|lift up|raise|raises|raised|raise up|hoist|pick up|elevate",
            Sense::Verb(Verb::Push(0.0)) => "push|pushes|pushed|pushing|slide|slides|slid|sliding|drive|drives",
            Sense::Verb(Verb::Push(1.0)) => "shove|shoves|shoved|kick|kicks|kicked|hit|hits|strike|strikes|slam|ram|knock|knocks|punch",
            Sense::Verb(Verb::Push(-1.0)) => "nudge|nudges|nudged|poke|pokes|tap|taps|bump|bumps",
            Sense::Verb(Verb::Pull) => "pull|pulls|pulled|pulling|drag|drags|dragged|tug|tugs|accelerate|accelerates",
            Sense::Verb(Verb::Throw) => "throw|throws|threw|thrown|throwing|toss|tosses|tossed|fling|flings|hurl|hurls|chuck|lob|launch|launches|catapult",
            Sense::Verb(Verb::Spin) => "spin|spins|spinning|spun|spin around|spins around|spin round|twirl|twirls|twirling|whirl|whirls|rotating|turning|while spinning|while rotating|while turning|pirouette",
            Sense::Verb(Verb::Roll) => "roll|rolls|rolling|tumble|tumbles|tumbling",
            Sense::Verb(Verb::Turn) => "turn|turns|turned|rotate|rotates|rotated",
            Sense::Verb(Verb::Tilt) => "tilt|tilts|tilted|lean|leans|tip|tips|tipped|incline|inclined",
            Sense::Verb(Verb::Move) => "move|moves|moved|shift|shifts|put|puts|place|places|placed|position|bring",
            Sense::Verb(Verb::Pin) => "pin|pins|pinned|pin down|hold|holds|held|hold on to|fix|fixes|fixed|glue|glued|nail|nail down|clamp|clamped|anchor|anchored|attach|keep hold of",
            Sense::Verb(Verb::Release) => "release|releases|released|let go|let go of|lets go|unpin|unfix|unglue|let it go|let them go|set free|free",
            Sense::Verb(Verb::Blow) => "blow|blows|blowing|wind|breeze|gust|a wind|the wind",
            Sense::Gusty => "gusty|in gusts|squally|turbulent|stormy",
            Sense::Verb(Verb::Field(Field::Swirl)) => "swirl|swirls|swirling|swirl around|vortex|tornado|whirlwind|cyclone|whirlpool",
            Sense::Verb(Verb::Field(Field::Explode)) => "explode|explodes|exploding|explosion|blast|detonate|detonates|blow up|blows up|blow it up|blow apart|blow it apart",
            Sense::Verb(Verb::Field(Field::Attract)) => "attract|attracts|implode|implodes|implosion",
            Sense::Verb(Verb::Field(Field::Air)) => "air drag|air resistance|drag of the air|resistance of the air",
            Sense::Verb(Verb::Field(Field::Water)) => "under water|underwater|as if under water|like under water|water resistance",
            Sense::Verb(Verb::Field(Field::Sway)) => "swing|swings|swinging|sway|sways|swaying|rock|rocks|rocking|to and fro|back and forth|from side to side|side to side",
            Sense::Verb(Verb::Field(Field::Shake)) => "shake|shakes|shaking|vibrate|vibrates|tremble|trembles|jiggle|jiggles|wiggle|wiggles|wobble|wobbles",
            Sense::Verb(Verb::Field(Field::Motor)) => "keep spinning|keeps spinning|keep it spinning|keep on spinning|keep turning|keeps turning|keep it turning|motor|on a turntable",
            Sense::Verb(Verb::Stop) => "stop|stops|stopped|halt|cancel|remove|delete|without the",
            Sense::Verb(Verb::Rest) => "stand still|stay|stays|stay still|stay put|rest|do nothing|leave it alone|leave it|keep still|stop moving|stop everything|hold still|be still",
            Sense::Verb(Verb::Reset) => "put it back|put back|move it back where it was|where it was",
            Sense::Pose(Pose::UpsideDown) => "upside down|on its head|head down|bottom up|flip|flipped|flip over|flip it over|flips over|turn over|turn it over|head first",
            Sense::Pose(Pose::OnItsSide) => "on its side|onto its side|lying down|lie down|lay down|lay it down|lay it on its side|lie on its side|lay on its side",
            Sense::Pose(Pose::Upright) => "upright|stand it up|stand it upright|stand upright|set it upright|stand up|stands up|standing up|right way up|the right way up",
        },
    },
    Section {
        title: "Directions",
        entries: entries! {
            Sense::Direction(Direction::Forward) => "forward|forwards|ahead|straight ahead|to the front|frontwards|straight on",
            Sense::Direction(Direction::Backward) => "backward|backwards|back|to the back|rearward|rearwards",
            Sense::Direction(Direction::Left) => "left|to the left|leftward|leftwards|to its left",
            Sense::Direction(Direction::Sideways) => "sideways|sidewards|to the side|to one side|to a side",
            Sense::Direction(Direction::Right) => "right|to the right|rightward|rightwards|to its right|to the other side",
            Sense::Direction(Direction::Up) => "up|upward|upwards|straight up|into the air|in the air|up in the air|up into the air|to the sky|skyward|skywards|vertically",
            Sense::Direction(Direction::Down) => "down|downward|downwards|straight down|to the ground below",
            Sense::Direction(Direction::Towards) => "towards me|toward me|to me|at me|towards us|towards the camera|toward the camera|to the camera|at the camera|towards the viewer|toward the viewer",
            Sense::Direction(Direction::Away) => "away|away from me|away from us|away from the camera|away from the viewer|off into the distance",
            Sense::Direction(Direction::ScreenLeft) => "screen left|on screen left|left on screen|left on the screen|to the left of the screen|left of the screen|to the left of the picture|to my left|my left",
            Sense::Direction(Direction::ScreenRight) => "screen right|on screen right|right on screen|right on the screen|to the right of the screen|right of the screen|to the right of the picture|to my right|my right",
            Sense::Direction(Direction::Axis(0, true)) => "+x|x|along x|in x|plus x|positive x|the x axis|x axis|around x|about x",
            Sense::Direction(Direction::Axis(0, false)) => "-x|minus x|negative x|along minus x|in minus x",
            Sense::Direction(Direction::Axis(1, true)) => "+y|y|along y|in y|plus y|positive y|the y axis|y axis|around y|about y",
            Sense::Direction(Direction::Axis(1, false)) => "-y|minus y|negative y|along minus y|in minus y",
            Sense::Direction(Direction::Axis(2, true)) => "+z|z|along z|in z|plus z|positive z|the z axis|z axis|around z|about z|the vertical axis|the vertical|vertical axis|its own axis|its axis|around its own axis",
            Sense::Direction(Direction::Axis(2, false)) => "-z|minus z|negative z|along minus z|in minus z",
            Sense::Direction(Direction::Anticlockwise) => "counterclockwise|anticlockwise|counter clockwise|anti clockwise",
            Sense::Direction(Direction::Clockwise) => "clockwise",
            Sense::Edge => "off the table|off the edge|over the edge|off|off the plinth|off the pedestal|off the desk|off the shelf|from the table",
        },
    },
    Section {
        title: "How much",
        entries: entries! {
            Strength(-1.0) => "gently|softly|lightly|carefully|tenderly|a gentle|gentle",
            Strength(1.0) => "strongly|forcefully|firmly|violently|powerfully|vigorously|with force|with all its might|as hard as you can|as hard as possible|with full force",
            Degree(0.25) => "a tiny bit|a touch|ever so slightly|barely",
            Degree(0.5) => "a bit|a little|a little bit|slightly|somewhat|a tad|little|bit",
            Degree(1.0) => "quite|rather|fairly|pretty|noticeably",
            Degree(2.0) => "very|much|a lot|lots|way|far|really|considerably|significantly|a great deal|so much",
            Degree(3.0) => "extremely|very much|very very|enormously|hugely|super|incredibly|massively",
            Factor(1.0) => "once",
            Factor(2.0) => "twice|double|doubled|doubles|two times",
            Factor(3.0) => "triple|thrice",
            Factor(4.0) => "quadruple|four times",
            Factor(0.5) => "half|halve|halved|halves|by half|in half",
            Factor(1.0 / 3.0) => "a third|one third",
            Factor(0.25) => "a quarter|one quarter",
            Change(1.0) => "more|increase|increases|increased|increasing|boost",
            Change(-1.0) => "less|decrease|decreases|decreased|reduce|reduces|reduced|fewer|not so|not as|not that|not quite so|not too|cut|lessen|diminish",
        },
    },
    Section {
        title: "More and less",
        entries: entries! {
            Quality(Property::Stiffness, -1.0, Comparative) => "softer|floppier|squishier|wobblier|limper|bendier|looser|squashier|weaker material|more flexible|more elastic|more rubbery",
            Quality(Property::Stiffness, -1.0, Plain) => "soft|floppy|squishy|wobbly|limp|bendy|flexible|soggy",
            Quality(Property::Stiffness, 1.0, Comparative) => "stiffer|firmer|tougher|sturdier|tauter",
            Quality(Property::Stiffness, 1.0, Plain) => "stiff|firm|tough|sturdy",
            Quality(Property::Hardness, 1.0, Comparative) => "harder",
            Quality(Property::Hardness, 1.0, Plain) => "hard",
            Quality(Property::Density, 1.0, Comparative) => "heavier|denser|weightier",
            Quality(Property::Density, 1.0, Plain) => "heavy|dense|weighty",
            Quality(Property::Density, -1.0, Comparative) => "lighter",
            Quality(Property::Density, -1.0, Plain) => "light|lightweight",
            Quality(Property::Height, 1.0, Comparative) => "higher|taller|higher up",
            Quality(Property::Height, 1.0, Plain) => "high|tall",
            Quality(Property::Height, -1.0, Comparative) => "lower|shorter jump",
            Quality(Property::Height, -1.0, Plain) => "low",
            Quality(Property::Speed, 1.0, Comparative) => "faster|quicker|more quickly|speed up|speed it up",
            Quality(Property::Speed, 1.0, Plain) => "fast|quick|quickly|rapidly|swiftly|at speed",
            Quality(Property::Speed, -1.0, Comparative) => "slower|more slowly|slow down|slow it down",
            Quality(Property::Speed, -1.0, Plain) => "slow|slowly",
            Quality(Property::Strength, 1.0, Comparative) => "stronger|more strongly|more forcefully|mightier",
            Quality(Property::Strength, 1.0, Plain) => "strong|mighty|powerful",
            Quality(Property::Strength, -1.0, Comparative) => "weaker|gentler|more gently|more softly",
            Quality(Property::Strength, -1.0, Plain) => "weak|weakly",
            Quality(Property::Size, 1.0, Comparative) => "bigger|larger|greater",
            Quality(Property::Size, 1.0, Plain) => "big|large|huge",
            Quality(Property::Size, -1.0, Comparative) => "smaller|tinier",
            Quality(Property::Size, -1.0, Plain) => "small|tiny",
            Quality(Property::Bounce, 1.0, Comparative) => "bouncier|springier",
            Quality(Property::Bounce, 1.0, Plain) => "bouncy|springy",
            Quality(Property::Friction, -1.0, Comparative) => "slipperier|smoother|slicker",
            Quality(Property::Friction, -1.0, Plain) => "slippery|smooth|slick|slippy",
            Quality(Property::Friction, 1.0, Comparative) => "rougher|stickier|grippier",
            Quality(Property::Friction, 1.0, Plain) => "rough|sticky|grippy|grip",
            Quality(Property::Duration, 1.0, Comparative) => "longer|for longer",
            Quality(Property::Duration, 1.0, Plain) => "long",
            Quality(Property::Duration, -1.0, Comparative) => "shorter|briefer",
            Quality(Property::Duration, -1.0, Plain) => "short|brief|briefly",
            Quality(Property::Distance, 1.0, Comparative) => "further|farther|further away|farther away|further back|farther back|further off",
            Quality(Property::Distance, 1.0, Plain) => "distant|from afar|from far away|far away",
            Quality(Property::Distance, -1.0, Comparative) => "closer|nearer|closer up|closer in",
            Quality(Property::Distance, -1.0, Plain) => "close|near|close up|up close|from close up",
            Quality(Property::FieldOfView, 1.0, Comparative) => "wider",
            Quality(Property::FieldOfView, 1.0, Plain) => "wide|wide angle",
            Quality(Property::FieldOfView, -1.0, Comparative) => "narrower|tighter",
            Quality(Property::FieldOfView, -1.0, Plain) => "narrow|tight",
        },
    },
    Section {
        title: "Properties by name",
        entries: entries! {
            Sense::Property(Property::Stiffness) => "stiffness|young modulus|youngs modulus|elastic modulus|modulus|rigidity",
            Sense::Property(Property::Density) => "density|weight|mass|weigh|weighs",
            Sense::Property(Property::Gravity) => "gravity|gravitation|the pull of gravity",
            Sense::Property(Property::Friction) => "friction|slipperiness",
            Sense::Property(Property::Bounce) => "bounciness|restitution|rebound",
            Sense::Property(Property::Duration) => "duration|run time|running time|simulation time",
            Sense::Property(Property::Height) => "height|altitude",
            Sense::Property(Property::Speed) => "speed|velocity",
            Sense::Property(Property::Strength) => "strength|force|power",
            Sense::Property(Property::Distance) => "distance",
            Sense::Property(Property::FrameRate) => "frame rate|framerate|frames rate",
            Sense::Property(Property::FieldOfView) => "field of view|fov|angle of view",
            Sense::Property(Property::Poisson) => "poisson|poisson ratio|poissons ratio",
        },
    },
    Section {
        title: "Materials",
        entries: entries! {
            Sense::Material("elastic") => "elastic|stretchy",
            Sense::Material("rubber") => "rubber|rubbery|silicone|latex|gummy|a rubber",
            Sense::Material("jelly") => "jelly|jello|gelatin|gelatine|gelatinous|jellylike|jelly like|pudding|a jelly",
            Sense::Material("foam") => "foam|sponge|spongy|foam rubber|a sponge",
            Sense::Material("clay") => "clay|plasticine|putty|modelling clay|a clay",
            Sense::Material("dough") => "dough|doughy|bread dough",
            Sense::Material("mud") => "mud|muddy|sludge",
            Sense::Material("jam") => "jam|marmalade",
            Sense::Material("water") => "water|liquid|fluid|a liquid",
            Sense::Material("honey") => "honey|syrup",
            Sense::Material("lava") => "lava|magma|molten rock",
            Sense::Material("sand") => "sand|sandy|dry sand",
            Sense::Material("dry_soil") => "soil|dry soil|dirt",
            Sense::Material("snow") => "snow|snowy",
            Sense::Material("wood") => "wood|wooden|timber|oak",
            Sense::Material("steel") => "steel|iron|metal|metallic",
            Sense::Material("stone") => "stone|rock|granite|marble|concrete|brick",
            Sense::Material("glass") => "glass|porcelain|ceramic|china",
            Sense::Material("plastic") => "plastic",
            Sense::Material("rigid") => "rigid|solid",
            Sense::Material("cloth-like") => "cloth|cloth like|clothlike|fabric|textile|a cloth",
        },
    },
    Section {
        title: "Not built yet: refused by name",
        entries: entries! {
            Sense::Unbuilt(Unbuilt::Liquid) => "oil|milk|blood|paint|mercury liquid|wine",
            Sense::Unbuilt(Unbuilt::Rigid) => "gold|golden|silver|lead|diamond|ice block",
            Sense::Unbuilt(Unbuilt::Plastic) => "wax|butter|chocolate",
            Sense::Unbuilt(Unbuilt::Viscoplastic) => "toothpaste|slime|cream|ketchup|mayonnaise",
            Sense::Unbuilt(Unbuilt::Grains) => "dust|gravel|salt|sugar|powder|ash",
            Sense::Unbuilt(Unbuilt::Gas) => "smoke|steam|gas|fog|air balloon",
            Sense::Unbuilt(Unbuilt::Muscle) => "muscle|muscles|walk|walks|dance|dances|run away|breathe|breathes|swim|fly|flies",
            Sense::Unbuilt(Unbuilt::Heat) => "melt|melts|melting|melted|freeze|freezes|freezing|frozen|burn|burns|burning|boil|boils|evaporate|heat|heat up|fire|on fire|ice cream",
            Sense::Unbuilt(Unbuilt::Fracture) => "shatter|shatters|shattered|shattering|break|breaks|broken|smash|smashes|crack|cracks|tear|tears|crumble|crumbles|split apart|fall apart|falls apart|collapse|collapses|dissolve|dissolves",
            Sense::Unbuilt(Unbuilt::Deform) => "squeeze|squeezes|squash|squashes|crush|crushes|flatten|stretch|stretches|twist|twists|bend|bends",
            Sense::Unbuilt(Unbuilt::Look) => "red|green|blue|yellow|white|black|pink|purple|grey|gray|transparent|invisible|glow|glows|glowing|shiny|colour|color|brighter|darker|fade|fades|disappear|vanish",
            Sense::Unbuilt(Unbuilt::Scene) => "scale|shrink|shrinks|grow|grows|duplicate|copy|clone|inflate|inflates",
            Sense::Unbuilt(Unbuilt::Playback) => "slow motion|slowmo|slow mo|time lapse|timelapse|in reverse|play backwards|rewind",
        },
    },
    Section {
        title: "Worlds and ground",
        entries: entries! {
            Gravity(9.81) => "earth|on earth|back on earth|back to earth|normal gravity|earth gravity",
            Gravity(1.62) => "moon|the moon|on the moon|lunar|moon gravity|lunar gravity",
            Gravity(3.71) => "mars|on mars|martian|mars gravity",
            Gravity(24.79) => "jupiter|on jupiter|jupiter gravity",
            Gravity(0.0) => "zero gravity|zero g|no gravity|without gravity|weightless|weightlessly|weightlessness|in space|outer space|in outer space|space|in orbit around earth|microgravity|free of gravity|gravity off|switch off gravity|turn off gravity|turn gravity off|turn off the gravity",
            Surface(0.02) => "ice|on ice|icy|on the ice|on an icy floor",
            Surface(0.0) => "frictionless|no friction|without friction|zero friction",
            Surface(0.6) => "carpet|on carpet|on a carpet",
            Sense::Springy(0.8) => "trampoline|on a trampoline|on the trampoline",
            Surface(0.9) => "sandpaper|on sandpaper",
            Sense::Ground => "ground|floor|table|surface|plinth|pedestal|the desk|desk|shelf|tabletop|table top",
        },
    },
    Section {
        title: "Camera",
        entries: entries! {
            Sense::Camera => "camera|the camera|viewpoint|shot",
            Sense::Verb(Verb::Look) => "look|looks|looking|look at|looking at|watch|watched|view|viewed|seen|film|filmed|show|shown|see it|show it|show me|frame it|focus on",
            Sense::Verb(Verb::Zoom(1.0)) => "zoom in|zoom|zoom closer|come closer|go closer|move in",
            Sense::Verb(Verb::Zoom(-1.0)) => "zoom out|back off|step back|zoom away|pull back",
            Sense::Verb(Verb::Orbit) => "orbit|orbits|orbiting|orbit around|turn around the|circle|circle around|go around|fly around|turn around it|go round|walk around|move around|turntable",
            Sense::View(View::Front) => "from the front|from in front|front view|from ahead|in front",
            Sense::View(View::Back) => "from behind|from the back|back view|rear view|from the rear",
            Sense::View(View::Left) => "from the left|from its left|left view|from the left side|from the side|from a side|side view|from one side|from the left hand side",
            Sense::View(View::Right) => "from the right|from its right|right view|from the right side|from the other side|from the right hand side",
            Sense::View(View::Above) => "from above|from the top|top view|from overhead|bird eye view|birds eye view|and above|top down",
            Sense::View(View::Below) => "from below|from the ground|worm eye view|worms eye view|from underneath|low angle|from low down",
            Sense::View(View::Auto) => "reset the camera|reset camera|camera auto|default camera|automatic camera|default view|reset the view|reset view|usual view|normal view",
        },
    },
    Section {
        title: "Parts, moments, time",
        entries: entries! {
            Sense::Part(Part::Base) => "base|bottom|foot|feet|the base|the bottom|its base|its bottom|its foot|underside",
            Sense::Part(Part::Top) => "top|head|tip of it|its top|the top|rim",
            Sense::Part(Part::LowerHalf) => "lower half|bottom half|lower part",
            Sense::Part(Part::UpperHalf) => "upper half|top half|upper part",
            Sense::Part(Part::LowerThird) => "lower third|bottom third",
            Sense::Part(Part::UpperThird) => "upper third|top third",
            Sense::Moment(Moment::Apex) => "at the top of the jump|at the top of its jump|at the apex|at its highest|at the highest point|in mid air|mid air|midair|in midair|at the peak|at its peak|at the top of its flight|while in the air|when it is at the top|when it is highest",
            Sense::Moment(Moment::Landing) => "when it lands|once it lands|as it lands|after it lands|on landing|after landing|when it hits the ground|when it comes down|on impact|at impact",
            Sense::Verb(Verb::Run) => "simulate|simulation|play|animate|animation|run it|let it run|run for|clip|video|go on|last|lasts|continue|keep going",
            Sense::AboveGround => "above the ground|above the floor|above the table|off the ground|off the floor|over the ground|over the table|above ground|above it",
        },
    },
    Section {
        title: "Turns",
        entries: entries! {
            Turn(TurnWord::Undo) => "undo|undo that|undo it|undo this|undo the last|take that back|take it back|revert|revert that|go back|go back one|step backwards|back one|one step back|previous version|go back to the previous version|back to the previous|back to the previous version|back to before|forget that|never mind|nevermind|scrap that|undo last|undo the last turn|undo last turn|undo the turn|undo the last one|undo the last step|undo the last change|undo my last change",
            Turn(TurnWord::Redo) => "redo|redo that|redo it|undo the undo|put that back|go forward again|redo the last",
            Turn(TurnWord::BackTo) => "back to version|go back to version|return to version|revert to version|back to|go back to|return to|revert to|restore|go to version|switch to version|version|as it was in",
            Turn(TurnWord::First) => "back to the first|go back to the first|back to the first version|go back to the first version|back to the start|go back to the start|back to the beginning|back to the original|go back to the original|return to the first|start over|start again|start from scratch|from the beginning|back to square one|reset|reset everything|reset all|the first version|back to the first one",
            Sense::Version(2) => "the second version|second version",
            Sense::Version(3) => "the third version|third version",
            Sense::Version(4) => "the fourth version|fourth version",
            Sense::Version(5) => "the fifth version|fifth version",
            Turn(TurnWord::OtherWay) => "the other way|other way|the other way round|the other way around|other way round|other way around|the opposite way|opposite way|the opposite direction|in the opposite direction|opposite direction|other direction|the other direction|in the other direction|wrong way|wrong direction|the wrong way|that is the wrong way|thats the wrong way|reverse it|reverse that|reverse direction|reverse the direction|invert it|invert the direction|the reverse|opposite|the opposite",
            Turn(TurnWord::Again) => "again|once more|one more time|same again|repeat|repeat that|do it again|do that again|and again|once again",
        },
    },
    Section {
        title: "Small words",
        entries: entries! {
            Sense::It => "it|this|that|the object|object|the thing|thing|itself|this one|that one|the model|he|she|him|her|its",
            Sense::All => "everything|all|them|they|both|all of them|all objects|both of them|every object|all of it|all things|each",
            Sense::Article => "the|a|an|some|my|our|your",
            Sense::As => "as",
            Sense::Preposition(Preposition::At) => "at",
            Sense::Preposition(Preposition::By) => "by|by a factor of|a factor of|factor",
            Sense::Preposition(Preposition::From) => "from|starting at|starting from",
            Sense::Preposition(Preposition::To) => "to|onto|on to|toward|towards",
            Sense::Preposition(Preposition::For) => "for|during|lasting",
            Sense::Preposition(Preposition::With) => "with",
            Sense::Preposition(Preposition::After) => "after|later",
            Sense::Preposition(Preposition::In) => "in|within|inside",
            Sense::Preposition(Preposition::On) => "on|upon",
            Sense::Preposition(Preposition::Of) => "of|out of",
            Sense::Preposition(Preposition::Until) => "until|till|up to|up until",
            Sense::Preposition(Preposition::Around) => "around|round|about",
            Sense::Preposition(Preposition::Along) => "along",
            Sense::Preposition(Preposition::Into) => "into",
            Sense::Negation => "not|dont|do not|doesnt|never|no|without|cannot|cant|wont|should not|shouldnt|avoid",
            Sense::Condition => "if|when|whenever|unless|while|except|before|because|every|or",
            Sense::Question => "why|how|what|where|who|which|whose",
            Sense::Instead => "instead|rather than that|not that way",
            Sense::Separator => "and|then|,|;|but|also|and then|plus|after that|afterwards|next|finally|as well as|at the same time|meanwhile|followed by",
            Filler => "please|pls|first|firstly|to begin with|use|t|kindly|thanks|thank you|thx|hey|hi|hello|ok|okay|well|so|now|right now|just|simply|maybe|perhaps|can|could|would|should|will|shall|must|you|i|we|us|me|id|lets|let|want|wants|like|need|needs|to see|see|make|makes|making|made|so that|have|has|having|get|gets|getting|give|gives|cause|do|does|doing|become|becomes|be|is|are|being|were|go|goes|going|try|point|points|pointing|change|changes|set|adjust|same|the same|the same thing|too|as well|even|still|only|than|than before|than that|than now|than this|than it was|as before|this time|for me|actually|hmm|oh|yes|yeah|yep|sure|what if|what about|how about|alright|approximately|roughly|exactly|about it|start|starts|starting|begin|begins|value|in the direction|own|something|made of|made out of|material|somehow|step|steps|nope|nah|elastically|by itself|on its own",
        },
    },
];

/// An entry ready to match: its words and its sense.
pub struct Pattern {
    /// The words.
    pub words: Vec<&'static str>,
    /// What they mean.
    pub sense: &'static Sense,
}

/// Patterns by their first word, longest first.
pub static PATTERNS: LazyLock<BTreeMap<&'static str, Vec<Pattern>>> = LazyLock::new(|| {
    let mut map: BTreeMap<&'static str, Vec<Pattern>> = BTreeMap::new();
    for entry in SECTIONS.iter().flat_map(|s| s.entries) {
        for phrase in entry.words.split('|') {
            let words: Vec<&'static str> = phrase.split(' ').collect();
            map.entry(words[0]).or_default().push(Pattern { words, sense: &entry.sense });
        }
    }
    // A stable sort: of two patterns of one length the earlier entry holds.
    for patterns in map.values_mut() {
        patterns.sort_by_key(|p| std::cmp::Reverse(p.words.len()));
    }
    map
});
