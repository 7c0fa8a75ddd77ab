//! Positions against the way of the wheels and the course.
//!
//! The drive is cut into stretches of 200 m. On each, the chord between two positions is about the
//! way driven: ratio and spread over all stretches show units. Curves make a chord shorter, jumps of
//! the receiver longer; both are rare, and medians ignore them.

use super::distribution::Distribution;
use super::integral::Integral;

/// Length of a stretch, m.
const STRETCH_M: f64 = 200.0;
/// Radius of the earth, m.
const EARTH_M: f64 = 6_371_000.0;
/// Largest latitude and longitude in radians, 1e-7. As degrees, this is in the Gulf of Guinea,
/// some 100 km from any road.
const RADIANS_E7: (i32, i32) = (15_707_964, 31_415_927);
/// Least speed at which a course is known, m/s.
const COURSE_MPS: f64 = 3.0;
/// Least length of the mean of the unit vectors of a stretch that is straight.
const STRAIGHT: f64 = 0.9;

/// A position, 1e-7 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Position {
    latitude_e7: i32,
    longitude_e7: i32,
}

impl Position {
    const fn swapped(self) -> Self {
        Self {
            latitude_e7: self.longitude_e7,
            longitude_e7: self.latitude_e7,
        }
    }

    /// Returns the way to another position, m to the north and to the east.
    fn way_to(self, other: Self) -> (f64, f64) {
        let radians = |e7: f64| (e7 * 1e-7).to_radians();
        let north = f64::from(other.latitude_e7) - f64::from(self.latitude_e7);
        let east = f64::from(other.longitude_e7) - f64::from(self.longitude_e7);
        let latitude = radians(f64::from(self.latitude_e7));
        let east = radians(east) * latitude.cos();
        (radians(north) * EARTH_M, east * EARTH_M)
    }
}

/// Sum of unit vectors.
#[derive(Clone, Copy, Debug, Default)]
struct MeanDirection {
    north: f64,
    east: f64,
    count: u32,
}

impl MeanDirection {
    fn add(&mut self, radians: f64) {
        self.north += radians.cos();
        self.east += radians.sin();
        self.count += 1;
    }

    /// Returns the cosine of the angle to a way, if the direction was steady.
    fn cosine_to(&self, (north, east): (f64, f64)) -> Option<f64> {
        let own = self.north.hypot(self.east);
        let other = north.hypot(east);
        let is_steady = self.count > 0 && own > STRAIGHT * f64::from(self.count) && other > 0.0;
        is_steady.then(|| (self.north * north + self.east * east) / (own * other))
    }
}

/// Mean of the cosines between course and way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Agreement {
    sum: f64,
    count: u32,
}

impl Agreement {
    fn add(&mut self, cosine: Option<f64>) {
        if let Some(cosine) = cosine {
            self.sum += cosine;
            self.count += 1;
        }
    }

    /// Returns the mean cosine if there are at least so many stretches.
    pub(super) fn mean(&self, least: u32) -> Option<f64> {
        (self.count >= least).then(|| self.sum / f64::from(self.count))
    }
}

/// A stretch that is not over yet.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    position: Position,
    wheels_m: f64,
    ground_m: f64,
    course: MeanDirection,
    course_as_radians: MeanDirection,
}

/// What positions, wheels, speed over ground and course say about each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Positions {
    latitude_e7: Option<i32>,
    stretch: Option<Stretch>,
    count: u32,
    in_radians: u32,
    at_zero: u32,
    /// Way of the wheels over chord.
    pub(super) wheels: Distribution,
    /// The same with latitude and longitude swapped.
    pub(super) wheels_if_swapped: Distribution,
    /// Way of the speed over ground over chord.
    pub(super) ground: Distribution,
    pub(super) course: Agreement,
    pub(super) course_if_radians: Agreement,
    pub(super) course_if_swapped: Agreement,
    pub(super) largest_course: f64,
}

impl Positions {
    /// Takes a latitude, 1e-7 degrees.
    pub(super) const fn latitude(&mut self, e7: i32) {
        self.latitude_e7 = Some(e7);
    }

    /// Takes a longitude, 1e-7 degrees, which completes a position.
    pub(super) fn longitude(&mut self, e7: i32, wheels: &Integral, ground: &Integral) {
        let Some(latitude_e7) = self.latitude_e7.take() else {
            return;
        };
        let position = Position {
            latitude_e7,
            longitude_e7: e7,
        };
        self.count = self.count.saturating_add(1);
        let (latitude, longitude) = RADIANS_E7;
        let is_small = latitude_e7.abs() <= latitude && e7.abs() <= longitude;
        self.in_radians += u32::from(is_small);
        self.at_zero += u32::from(latitude_e7 == 0 && e7 == 0);
        let (wheels_m, ground_m) = (wheels.metres(), ground.metres());
        if let Some(stretch) = self.stretch {
            let (north, east) = stretch.position.way_to(position);
            let driven_m = wheels_m - stretch.wheels_m;
            if driven_m < STRETCH_M && north.hypot(east) < STRETCH_M {
                return;
            }
            self.close(&stretch, position, driven_m, ground_m - stretch.ground_m);
        }
        self.stretch = Some(Stretch {
            position,
            wheels_m,
            ground_m,
            course: MeanDirection::default(),
            course_as_radians: MeanDirection::default(),
        });
    }

    fn close(&mut self, stretch: &Stretch, end: Position, wheels_m: f64, ground_m: f64) {
        let way = stretch.position.way_to(end);
        let swapped = stretch.position.swapped().way_to(end.swapped());
        let length = |(north, east): (f64, f64)| north.hypot(east);
        self.wheels.add(wheels_m / length(way));
        self.wheels_if_swapped.add(wheels_m / length(swapped));
        if ground_m > 0.0 {
            self.ground.add(ground_m / length(way));
        }
        self.course.add(stretch.course.cosine_to(way));
        self.course_if_swapped
            .add(stretch.course.cosine_to(swapped));
        self.course_if_radians
            .add(stretch.course_as_radians.cosine_to(way));
    }

    /// Takes a course.
    pub(super) fn course(&mut self, degrees: f64, wheels: &Integral) {
        self.largest_course = self.largest_course.max(degrees.abs());
        let is_known = wheels.speed_mps().is_some_and(|mps| mps >= COURSE_MPS);
        if let Some(stretch) = self.stretch.as_mut().filter(|_| is_known) {
            stretch.course.add(degrees.to_radians());
            stretch.course_as_radians.add(degrees);
        }
    }

    /// Returns whether most positions lie where no road is, as those in radians do.
    pub(super) const fn are_in_radians(&self) -> bool {
        self.count >= 10 && self.in_radians > self.count / 2
    }

    /// Returns whether most positions are exactly zero.
    pub(super) const fn are_zero(&self) -> bool {
        self.at_zero > self.count / 2
    }
}
