//! Plan view of lines, coloured by a value.

use super::plot::{Mark, Plot, Series, WIDTH};
use plotters::style::RGBColor;

/// Width and height of the axes, pixels.
const AXES_PX: (f64, f64) = (90.0, 100.0);
/// Smallest and largest height of a plan, pixels.
const HEIGHT_PX: (f64, f64) = (320.0, 900.0);
/// Points nearer than this are drawn as one, pixels.
const STEP_PX: f64 = 1.5;
/// Offset of a line to the right of its way, pixels, if there are several lines. Both directions of
/// a road are then visible.
const ASIDE_PX: f64 = 2.0;
/// Length of a degree of latitude, m.
const DEGREE_M: f64 = 111_200.0;

/// A line in its direction of travel.
#[derive(Clone, Debug, Default)]
pub struct PlanLine {
    /// Latitude and longitude, deg, and the value there.
    pub points: Vec<(f64, f64, f64)>,
}

/// Colours for values. A value has the colour of the first class whose upper limit is above it.
#[derive(Clone, Debug)]
pub struct Classes {
    /// Upper limits of all classes but the last.
    pub limits: Vec<f64>,
    /// Colours of the classes, one more than limits.
    pub colours: Vec<RGBColor>,
    /// Unit of the values.
    pub unit: &'static str,
}

impl Classes {
    fn of(&self, value: f64) -> usize {
        self.limits.partition_point(|&limit| limit <= value)
    }

    fn name(&self, class: usize) -> String {
        let (first, last) = (class == 0, class == self.limits.len());
        let unit = self.unit;
        match class {
            _ if first => format!("below {} {unit}", self.limits[0]),
            _ if last => format!("above {} {unit}", self.limits[class - 1]),
            _ => format!("{} to {}", self.limits[class - 1], self.limits[class]),
        }
    }
}

/// Draws lines with north up and both axes in km from the middle.
#[must_use]
pub fn plan(lines: &[PlanLine], classes: &Classes) -> Plot {
    let all = || lines.iter().flat_map(|line| &line.points);
    let Some(&(_, reference_deg, _)) = all().next() else {
        return Plot::new("east (km)", "north (km)");
    };
    // Longitudes are relative to one point, so a line across the date line stays continuous.
    let turn = |longitude: f64| (longitude - reference_deg + 540.0).rem_euclid(360.0) - 180.0;
    let (south, north) = extent(all().map(|point| point.0));
    let (west, east) = extent(all().map(|point| turn(point.1)));
    let (middle_deg, centre_deg) = (0.5 * (south + north), 0.5 * (west + east));
    let wide_km = 1e-3 * DEGREE_M * middle_deg.to_radians().cos();
    let high_km = 1e-3 * DEGREE_M;
    let (width, height) = ((east - west) * wide_km, (north - south) * high_km);
    let across_px = f64::from(WIDTH) - AXES_PX.0;
    let most_px = HEIGHT_PX.1 - AXES_PX.1;
    let pixel_km = (width / across_px).max(height / most_px).max(1e-5);
    let aside_km = if lines.len() > 1 {
        ASIDE_PX * pixel_km
    } else {
        0.0
    };

    let mut plot = Plot::new("east (km)", "north (km)");
    plot.equal_scales = true;
    plot.height = (height / pixel_km + AXES_PX.1).clamp(HEIGHT_PX.0, HEIGHT_PX.1) as u32;
    let mut drawn: Vec<Vec<(f64, f64)>> = vec![Vec::new(); classes.colours.len()];
    let mut begins: Vec<Vec<usize>> = vec![Vec::new(); classes.colours.len()];
    for line in lines {
        let points = line.points.iter().map(|&(latitude, longitude, value)| {
            let x = (turn(longitude) - centre_deg) * wide_km;
            let y = (latitude - middle_deg) * high_km;
            (x, y, value)
        });
        let points = aside(&thinned(points, STEP_PX * pixel_km), aside_km);
        let mut before = None;
        for pair in points.windows(2) {
            let class = classes.of(pair[0].2);
            let drawn = &mut drawn[class];
            if before != Some(class) {
                begins[class].push(drawn.len());
                drawn.push((pair[0].0, pair[0].1));
            }
            drawn.push((pair[1].0, pair[1].1));
            before = Some(class);
        }
    }
    for (class, (points, begins)) in drawn.into_iter().zip(begins).enumerate() {
        plot.series.push(Series {
            name: classes.name(class),
            points,
            colour: classes.colours[class],
            mark: Mark::Lines(begins),
        });
    }
    plot
}

fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// Returns points at least this far apart, each with the mean value up to the next.
fn thinned(points: impl Iterator<Item = (f64, f64, f64)>, step: f64) -> Vec<(f64, f64, f64)> {
    let mut thinned_points: Vec<(f64, f64, f64)> = Vec::new();
    let (mut sum, mut count) = (0.0, 0.0);
    let mut last = None;
    for (x, y, value) in points {
        let is_near = thinned_points
            .last()
            .is_some_and(|before| (x - before.0).hypot(y - before.1) < step);
        if is_near {
            sum += value;
            count += 1.0;
            last = Some((x, y));
        } else {
            (sum, count) = (value, 1.0);
            thinned_points.push((x, y, value));
            last = None;
        }
        if let Some(before) = thinned_points.last_mut() {
            before.2 = sum / count;
        }
    }
    // The last point is the end of the line.
    if let (Some((x, y)), Some(&(_, _, value))) = (last, thinned_points.last()) {
        thinned_points.push((x, y, value));
    }
    thinned_points
}

/// Returns the points moved to the right of their direction.
fn aside(points: &[(f64, f64, f64)], by: f64) -> Vec<(f64, f64, f64)> {
    (0..points.len())
        .map(|i| {
            let (x, y, value) = points[i];
            let (a, b) = (
                points[i.saturating_sub(1)],
                points[(i + 1).min(points.len() - 1)],
            );
            let (dx, dy) = (b.0 - a.0, b.1 - a.1);
            let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
            (x + by * dy / length, y - by * dx / length, value)
        })
        .collect()
}
