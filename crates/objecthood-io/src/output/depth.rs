//! Depth as whole units, as 16-bit images hold it.

use objecthood::Raster;

/// Depth in whole units, 0 = none.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeUnits {
    /// Units of every pixel, row by row.
    pub units: Vec<u16>,
    /// How far a depth that is read from them may be from what it was (m); 0 where it is the same number.
    pub error_m: f32,
    /// Pixels whose depth is more than 16 bits hold; they have none.
    pub lost_px: usize,
}

impl WholeUnits {
    /// The units nearest to each depth (m, NaN = none), of which `scale` make a metre. O(n).
    pub fn of(depth_m: &Raster<f32>, scale: f64) -> Self {
        let mut whole =
            Self { units: Vec::with_capacity(depth_m.as_slice().len()), error_m: 0.0, lost_px: 0 };
        for &z in depth_m.as_slice() {
            let nearest = (f64::from(z) * scale).round();
            // The greatest number stands for no depth, as 0 does.
            let fits = nearest >= 1.0 && nearest < f64::from(u16::MAX);
            let unit = if fits { nearest as u16 } else { 0 };
            whole.units.push(unit);
            if fits {
                whole.error_m = whole.error_m.max(((f64::from(unit) / scale) as f32 - z).abs());
            } else if !z.is_nan() {
                whole.lost_px += 1;
            }
        }
        whole
    }

    /// Whether reading them gives back every depth, to the last bit.
    pub fn is_exact(&self) -> bool {
        self.error_m == 0.0 && self.lost_px == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_units_come_back_and_others_say_how_far_they_are() {
        let depths = vec![0.001, 1.234, 65.534, f32::NAN];
        let depth_m = Raster::from_vec(4, 1, depths).unwrap();
        let whole = WholeUnits::of(&depth_m, 1000.0);
        assert_eq!((&whole.units[..], whole.is_exact()), (&[1, 1234, 65534, 0][..], true));
        let whole = WholeUnits::of(&depth_m, 5000.0);
        assert_eq!((whole.lost_px, whole.is_exact()), (1, false));
        let between = WholeUnits::of(&Raster::from_vec(1, 1, vec![1.0004]).unwrap(), 1000.0);
        assert!((between.error_m - 0.0004).abs() < 1e-6 && !between.is_exact());
    }
}
