//! Numbers derived from a run's arrays: what expectations and diffs speak of.

use super::{Metrics, ObjectMetrics};
use crate::spec::expect::Measured;

/// Share of an object's height that its gap must fall under to count as an impact.
const IMPACT_GAP: f64 = 0.01;
/// Share of its height that the gap must have exceeded before.
const FLIGHT_GAP: f64 = 0.03;
/// Share of its largest value that the mean speed stays under once an object has settled.
const SETTLED: f64 = 0.01;

impl ObjectMetrics {
    /// Largest height of the centre of mass over frame 0's.
    pub fn apex_m(&self) -> f64 {
        let start = self.com_m.first().map_or(0.0, |c| c[2]);
        self.com_m.iter().map(|c| c[2] - start).fold(0.0, f64::max)
    }

    /// Largest fall of the centre of mass from any frame to a later one.
    pub fn drop_m(&self) -> f64 {
        let mut highest = f64::NEG_INFINITY;
        self.com_m.iter().fold(0.0, |drop: f64, c| {
            highest = highest.max(c[2]);
            drop.max(highest - c[2])
        })
    }

    /// Centre of mass at the end minus that at frame 0.
    pub fn travel_m(&self) -> [f64; 3] {
        match (self.com_m.first(), self.com_m.last()) {
            (Some(a), Some(b)) => [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
            _ => [0.0; 3],
        }
    }

    /// Times at which it meets what is below it. `rest_gap_m` is its gap in the captured pose, `height_m` its height there.
    pub fn impacts_s(&self, rest_gap_m: f64, height_m: f64, fps: u32) -> Vec<f64> {
        let mut flying = false;
        let mut impacts = Vec::new();
        for (frame, gap) in self.gap_m.iter().enumerate() {
            let gap = gap - rest_gap_m;
            if flying && gap < IMPACT_GAP * height_m {
                impacts.push(frame as f64 / f64::from(fps));
                flying = false;
            } else if gap > FLIGHT_GAP * height_m {
                flying = true;
            }
        }
        impacts
    }

    /// First time after which the mean speed stays under a hundredth of its maximum; none where it never does.
    pub fn settle_s(&self, fps: u32) -> Option<f64> {
        let limit = SETTLED * self.mean_speed_m_s.iter().copied().fold(0.0, f64::max);
        let moving = self.mean_speed_m_s.iter().rposition(|&speed| speed > limit);
        match moving {
            None => Some(0.0),
            Some(last) if last + 1 < self.mean_speed_m_s.len() => Some((last + 1) as f64 / f64::from(fps)),
            Some(_) => None,
        }
    }

    /// Largest of `stretch_max`.
    pub fn largest_stretch(&self) -> f64 {
        self.stretch_max.iter().copied().fold(0.0, f64::max)
    }
}

/// What an expectation's name means in a run.
pub fn lookup(metrics: &Metrics, object: &str, metric: &str) -> Option<Measured> {
    let o = metrics.objects.get(object)?;
    let series = |values: &Vec<f64>| Measured::Series(values.clone());
    Some(match metric {
        "particles" => Measured::Number(o.particles as f64),
        "gaussians" => Measured::Number(o.gaussians as f64),
        "mass_kg" => Measured::Number(o.mass_kg),
        "fill_ratio" => Measured::Number(o.fill_ratio),
        "com_m" => Measured::VectorSeries(o.com_m.clone()),
        "low_m" => series(&o.low_m),
        "high_m" => series(&o.high_m),
        "speed_m_s" => series(&o.speed_m_s),
        "mean_speed_m_s" => series(&o.mean_speed_m_s),
        "volume_ratio" => series(&o.volume_ratio),
        "stretch_max" => series(&o.stretch_max),
        "spin_rad_s" => Measured::VectorSeries(o.spin_rad_s.clone()),
        "kinetic_j" => series(&o.kinetic_j),
        "spread_m" => series(&o.spread_m),
        "apex_m" => Measured::Number(o.apex_m()),
        "drop_m" => Measured::Number(o.drop_m()),
        "travel_m" => Measured::Vector(o.travel_m()),
        "impacts_s" => Measured::Series(o.impacts_s.clone()),
        "settle_s" => o.settle_s(metrics.fps).map_or(Measured::Null, Measured::Number),
        "largest_stretch" => Measured::Number(o.largest_stretch()),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bounce_gives_its_apex_drop_impacts_and_settling() {
        let heights = [0.5, 0.8, 0.9, 0.7, 0.5, 0.55, 0.5, 0.5, 0.5];
        let object = ObjectMetrics {
            com_m: heights.iter().map(|&z| [0.0, 0.0, z]).collect(),
            gap_m: heights.iter().map(|z| z - 0.5 + 0.004).collect(),
            mean_speed_m_s: vec![3.0, 2.0, 1.0, 2.0, 3.0, 1.0, 0.02, 0.01, 0.0],
            stretch_max: vec![1.0, 1.3, 1.1],
            ..Default::default()
        };
        assert!((object.apex_m() - 0.4).abs() < 1e-12 && (object.drop_m() - 0.4).abs() < 1e-12);
        assert_eq!(object.impacts_s(0.004, 1.0, 10), [0.4, 0.6]);
        assert_eq!(object.settle_s(10), Some(0.6));
        assert_eq!(object.largest_stretch(), 1.3);
    }
}
