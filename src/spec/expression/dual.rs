//! A number and how it changes with the particle's place and velocity (forward differentiation).

/// A value and its derivatives by x, y, z and by the three components of velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// The number.
    pub value: f64,
    /// Its derivatives.
    pub slope: [f64; 6],
}

impl Dual {
    /// What does not change.
    pub fn constant(value: f64) -> Dual {
        Dual { value, slope: [0.0; 6] }
    }

    /// One of the six that derivatives are taken by.
    pub fn variable(value: f64, which: usize) -> Dual {
        let mut slope = [0.0; 6];
        slope[which] = 1.0;
        Dual { value, slope }
    }

    /// f(a), where f has this value and derivative.
    pub fn chain(self, value: f64, by: f64) -> Dual {
        Dual { value, slope: self.slope.map(|s| by * s) }
    }

    /// f(a, b), where f has this value and these derivatives.
    pub fn chain2(self, other: Dual, value: f64, by: f64, by_other: f64) -> Dual {
        let mut slope = [0.0; 6];
        for (k, s) in slope.iter_mut().enumerate() {
            *s = by * self.slope[k] + by_other * other.slope[k];
        }
        Dual { value, slope }
    }
}
