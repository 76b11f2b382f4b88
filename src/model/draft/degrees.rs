//! Latitude and longitude among the columns of a draft.

use super::names::names_an_angle_on_earth;
use super::survey::Survey;

/// Degrees of latitude and longitude among some columns: (column, metres per degree, latitude).
pub(super) struct Degrees {
    pub(super) columns: Vec<(usize, f64)>,
    latitude: f64,
}

impl Degrees {
    pub(super) fn of(survey: &Survey, candidates: &[usize]) -> Option<Self> {
        let named = |i: &usize| names_an_angle_on_earth(&survey.columns[*i].name).map(|is_latitude| (*i, is_latitude));
        let within = |&(i, is_latitude): &(usize, bool)| {
            let limit = if is_latitude { 90.0 } else { 180.0 };
            survey.columns[i].values.iter().all(|v| v.is_nan() || v.abs() <= limit)
        };
        let angles: Vec<(usize, bool)> = candidates.iter().filter_map(named).filter(within).collect();
        let latitudes =
            angles.iter().filter(|(_, is_latitude)| *is_latitude).flat_map(|(i, _)| &survey.columns[*i].values);
        let mut latitudes: Vec<f64> = latitudes.copied().filter(|v| !v.is_nan() && *v != 0.0).collect();
        latitudes.sort_unstable_by(f64::total_cmp);
        let latitude = latitudes.get(latitudes.len() / 2).copied().unwrap_or(0.0);
        let metres = |is_latitude: bool| metres_per_degree(latitude.to_radians())[usize::from(!is_latitude)];
        let columns: Vec<(usize, f64)> = angles.iter().map(|&(i, is_latitude)| (i, metres(is_latitude))).collect();
        (!columns.is_empty()).then_some(Self { columns, latitude })
    }

    /// One sentence.
    pub(super) fn said(&self, survey: &Survey) -> String {
        let lengths = self.columns.iter().map(|(i, m)| format!("one of {:?} is {m:.0} m", survey.columns[*i].name));
        format!(
            "degrees are not metres: at latitude {:.2} {}; r and q come out in degrees^2, and a degree of longitude shrinks \
             towards the poles (project to metres for noise in m^2)",
            self.latitude,
            lengths.collect::<Vec<_>>().join(", ")
        )
    }
}

/// Metres in one degree of latitude and of longitude on the WGS 84 ellipsoid, by its radii of curvature in the meridian
/// and in the prime vertical (Torge and Müller 2012, Geodesy, section 4.1).
fn metres_per_degree(latitude: f64) -> [f64; 2] {
    const A: f64 = 6_378_137.0;
    const E2: f64 = 6.694_379_990_141e-3;
    let w = 1.0 - E2 * latitude.sin().powi(2);
    let (meridian, prime_vertical) = (A * (1.0 - E2) / w.powf(1.5), A / w.sqrt());
    [meridian, prime_vertical * latitude.cos()].map(f64::to_radians)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_have_their_length() {
        // Published for WGS 84: 110.574 and 111.320 km at the equator, 111.132 and 78.847 km at 45 degrees.
        for (latitude, expected) in [(0.0_f64, [110_574.0, 111_320.0]), (45.0, [111_132.0, 78_847.0])] {
            let found = metres_per_degree(latitude.to_radians());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1.0), "{found:?} at {latitude}");
        }
    }
}
