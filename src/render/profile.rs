//! Every constant of the picture, in one place.

/// Whose picture is drawn. They differ in the constants below, which a capture was trained under.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Profile {
    /// gsplat's classic mode (Ye et al. 2024), the default.
    #[default]
    Gsplat,
    /// The first implementation (Kerbl et al. 2023).
    Inria,
    /// gsplat's antialiased mode: opacity is lowered by what the dilation adds to the area
    /// (Yu et al. 2024, Mip-Splatting).
    Antialiased,
}

/// The constants of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// Added to both variances on the screen, square pixels.
    pub dilation: f32,
    /// Opacity is multiplied by max(sqrt(det / det dilated), this); 0 leaves it.
    pub compensation_floor: f32,
    /// Alpha is never larger.
    pub opacity_cap: f32,
    /// Alpha is never smaller: below it a splat is skipped at that pixel.
    pub alpha_min: f32,
    /// A pixel ends before the splat that would take its transmittance down to this.
    pub stop: f32,
    /// 0: a splat extends to where its alpha falls to `alpha_min`. Else a square of this many
    /// standard deviations of its longer axis, in whole tiles of 16 pixels.
    pub sigmas: f32,
    /// The slope of the projection is taken at tangents no further out than the picture's edge, by
    /// this share of half the field; see [`Constants::symmetric`].
    pub tangent_margin: f32,
    /// Whether the edge is half the field on either side of the axis, wherever the centre lies.
    pub symmetric: bool,
    /// Gaussians no further than this are dropped, in the scene's units; `None` takes the caller's.
    pub near: Option<f32>,
}

impl Profile {
    /// Its constants.
    pub fn constants(self) -> Constants {
        let gsplat = Constants {
            dilation: 0.3,
            compensation_floor: 0.0,
            opacity_cap: 0.999,
            alpha_min: 1.0 / 255.0,
            stop: 1e-4,
            sigmas: 0.0,
            tangent_margin: 0.3,
            symmetric: false,
            near: None,
        };
        match self {
            Profile::Gsplat => gsplat,
            Profile::Antialiased => Constants { compensation_floor: 0.005, ..gsplat },
            Profile::Inria => Constants { opacity_cap: 0.99, sigmas: 3.0, symmetric: true, near: Some(0.2), ..gsplat },
        }
    }
}

/// Near plane of the contract, in the scene's units.
pub const NEAR: f32 = 0.01;

/// What lies further out than this, in any unit, is not drawn.
pub const FAR: f32 = 1e15;

/// A variance on the screen past which a Gaussian is absurd, square pixels: its determinant still fits.
pub const VARIANCE_MAX: f32 = 1e15;

/// Correlation of a projected Gaussian at most: sqrt(1 - 1e-6). Closer to 1 its inverse is noise in f32.
pub const CORRELATION_MAX: f32 = 0.999_999_5;

/// Opacities above 1 by more than rounding are not opacities.
pub const OPACITY_MAX: f32 = 1.001;

/// Slack of the box around an ellipse, as a factor and in pixels: boxes may be too large, never too small.
pub const REACH_SLACK: f32 = 1.001;

/// Slack of exponents in tests of whole rectangles; each pixel is tested without.
pub const EXPONENT_SLACK: f32 = 2e-3;

/// Bits of the depth key, spread over the depths that occur.
pub const DEPTH_BITS: u32 = 24;

/// Side of the tiles that the Inria profile fills whole, pixels.
pub const INRIA_TILE: u32 = 16;
/// How much darker the plain ground is under the object than the background.
pub const POOL_TONE: f32 = 0.16;

/// The light on what has none captured: matter that is drawn as its particles (`lit.wgsl`).
#[derive(Clone, Copy, Debug)]
pub struct LitLook {
    /// Factor on the colour of what faces down, and up.
    pub matt: [f32; 2],
    /// Share that a shining surface mirrors of what is straight before it: of water (n - 1)^2 / (n + 1)^2 = 0.02.
    pub mirror: f32,
    /// Light of the room below and above, display-referred.
    pub room: [f32; 2],
    /// Towards the window, of unit length.
    pub window: [f32; 3],
    /// Its light over the room's.
    pub window_light: f32,
    /// Cosines to its middle at which its soft edge begins, and at which it is whole.
    pub window_edge: [f32; 2],
}

/// See [`LitLook`].
pub const LIT_LOOK: LitLook =
    LitLook { matt: [0.7, 1.12], mirror: 0.03, room: [0.30, 0.95], window: [-0.566, 0.170, 0.807], window_light: 4.0, window_edge: [0.8, 0.98] };
