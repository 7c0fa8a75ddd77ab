//! Places where a drive turns back on its own road.
//!
//! A point of the road that is driven again in the other direction makes a pair. The bus turned in
//! the middle of the two, by driven distance. All pairs of one trip and the next have nearly the
//! same middle, for any turning loop, and although some streets are one-way.

/// A point of the drive, on a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanePoint {
    /// Driven distance, m.
    pub(super) driven_m: f64,
    pub(super) east_m: f64,
    pub(super) north_m: f64,
}

/// A turn and the road that was driven both before and after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// Driven distance at the turn, m.
    pub(super) driven_m: f64,
    /// Distances of the first and the last place on the retraced road before the turn, m.
    pub(super) before_m: (f64, f64),
    /// The same after the turn.
    pub(super) after_m: (f64, f64),
    /// Length of the retraced road, m.
    retraced_m: f64,
}

/// Smallest fraction of the distance between two turns that is retraced in one trip. The rest is
/// one-way streets and turning loops.
const RETRACED_PART: f64 = 0.6;

impl Turn {
    /// Returns true if the distance to the `next` turn is one trip on a road that one of them
    /// retraces.
    pub(super) fn shares_road_with(&self, next: &Self) -> bool {
        let driven_m = next.driven_m - self.driven_m;
        let before_m = next.driven_m - next.before_m.0;
        let after_m = self.after_m.1 - self.driven_m;
        before_m.max(after_m) > RETRACED_PART * driven_m
    }
}

/// Spacing of the places that are compared, m.
const STEP_M: f64 = 20.0;
/// Largest distance of two places with opposite headings on one road, m: two lanes and the error of
/// GNSS between houses.
const SAME_ROAD_M: f64 = 40.0;
/// Cosine of the angle between headings that are opposite (143° and more).
const OPPOSITE: f64 = -0.8;
/// Largest distance of the half-way points of one turn from its centre, m: half of the length
/// difference of the two directions, due to one-way streets and turning loops.
const SCATTER_M: f64 = 500.0;
/// A retraced road shorter than this, m, is a yard or a spur,
const SHORTEST_M: f64 = 500.0;
/// and so is one shorter than this fraction of the longest.
const SHORTEST_PART: f64 = 0.25;

/// A place with its heading as a unit vector.
struct Headed {
    place: PlanePoint,
    heading: (f64, f64),
}

/// A point and the first later point on the same road in the other direction.
#[derive(Clone, Copy)]
struct ReturnPair {
    before_m: f64,
    after_m: f64,
}

impl ReturnPair {
    fn middle_m(&self) -> f64 {
        0.5 * (self.before_m + self.after_m)
    }
}

/// Returns the turns of a drive, in order. Trips shorter than about 1 km are not separated.
pub(super) fn turns(places: &[PlanePoint]) -> Vec<Turn> {
    let mut pairs = pairs(&headed(places));
    pairs.sort_by(|a, b| a.middle_m().total_cmp(&b.middle_m()));
    let mut turns: Vec<Turn> = Vec::new();
    while let Some(turn) = strongest(&pairs) {
        let longest = turns.first().map_or(0.0, |t| t.retraced_m);
        if turn.retraced_m < SHORTEST_M.max(SHORTEST_PART * longest) {
            break;
        }
        pairs.retain(|pair| (pair.middle_m() - turn.driven_m).abs() > SCATTER_M);
        turns.push(turn);
    }
    turns.sort_by(|a, b| a.driven_m.total_cmp(&b.driven_m));
    turns
}

fn headed(places: &[PlanePoint]) -> Vec<Headed> {
    let mut spaced: Vec<PlanePoint> = Vec::new();
    for place in places {
        if spaced
            .last()
            .is_none_or(|last| place.driven_m - last.driven_m >= STEP_M)
        {
            spaced.push(*place);
        }
    }
    spaced
        .windows(3)
        .filter_map(|three| {
            let east_m = three[2].east_m - three[0].east_m;
            let north_m = three[2].north_m - three[0].north_m;
            let chord_m = east_m.hypot(north_m);
            // A bus that turns on the spot has no heading.
            (chord_m > STEP_M).then(|| Headed {
                place: three[1],
                heading: (east_m / chord_m, north_m / chord_m),
            })
        })
        .collect()
}

fn pairs(headed: &[Headed]) -> Vec<ReturnPair> {
    let retraces = |a: &Headed, b: &Headed| {
        let (dx, dy) = (
            a.place.east_m - b.place.east_m,
            a.place.north_m - b.place.north_m,
        );
        let cosine = a.heading.0 * b.heading.0 + a.heading.1 * b.heading.1;
        dx.hypot(dy) < SAME_ROAD_M && cosine < OPPOSITE
    };
    headed
        .iter()
        .enumerate()
        .filter_map(|(index, a)| {
            let b = headed[index + 1..].iter().find(|b| retraces(a, b))?;
            Some(ReturnPair {
                before_m: a.place.driven_m,
                after_m: b.place.driven_m,
            })
        })
        .collect()
}

/// Returns the turn with the most agreeing pairs; `pairs` are sorted by their half-way points.
fn strongest(pairs: &[ReturnPair]) -> Option<Turn> {
    let mut first = 0;
    let mut most = 0..0;
    for end in 1..=pairs.len() {
        while pairs[end - 1].middle_m() - pairs[first].middle_m() > 2.0 * SCATTER_M {
            first += 1;
        }
        if end - first > most.len() {
            most = first..end;
        }
    }
    let members = &pairs[most];
    let driven_m = members.get(members.len() / 2)?.middle_m();
    let around = members
        .iter()
        .filter(|pair| pair.before_m < driven_m && pair.after_m > driven_m);
    let mut turn = Turn {
        driven_m,
        before_m: (driven_m, 0.0),
        after_m: (f64::INFINITY, driven_m),
        retraced_m: 0.0,
    };
    for pair in around {
        turn.before_m.0 = turn.before_m.0.min(pair.before_m);
        turn.before_m.1 = turn.before_m.1.max(pair.before_m);
        turn.after_m.0 = turn.after_m.0.min(pair.after_m);
        turn.after_m.1 = turn.after_m.1.max(pair.after_m);
        turn.retraced_m += STEP_M;
    }
    Some(turn)
}
