//! Local polynomial regression (Cleveland 1979, without the robust weights).

/// Returns at every `x` the value of the polynomial of `N` coefficients that fits the points within
/// `half_width` with triangular weights. `x` must not decrease. A trend of that degree is
/// reproduced exactly, also at the ends and beside gaps, where a moving average has a bias. With
/// too few points for the degree the value is their weighted mean.
pub fn smooth<const N: usize>(x: &[f64], y: &[f64], half_width: f64) -> Vec<f64> {
    fit::<N>(x, y, |_| 1.0, half_width)
}

/// Returns what [`smooth`] does for points of which each counts with its weight.
pub fn smooth_weighted<const N: usize>(
    x: &[f64],
    y: &[f64],
    weight: &[f64],
    half_width: f64,
) -> Vec<f64> {
    fit::<N>(x, y, |i| weight[i], half_width)
}

fn fit<const N: usize>(
    x: &[f64],
    y: &[f64],
    weight_of: impl Fn(usize) -> f64,
    half_width: f64,
) -> Vec<f64> {
    let mut first = 0;
    let mut end = 0;
    let scale = 1.0 / half_width;
    x.iter()
        .map(|&centre| {
            while x[first] < centre - half_width {
                first += 1;
            }
            while end < x.len() && x[end] <= centre + half_width {
                end += 1;
            }
            let mut normal = [[0.0; N]; N];
            let mut right = [0.0; N];
            for i in first..end {
                let (x, y) = (x[i], y[i]);
                let u = (x - centre) * scale;
                let weight = weight_of(i) * (1.0 - u.abs());
                let mut powers = [1.0; N];
                for k in 1..N {
                    powers[k] = powers[k - 1] * u;
                }
                for row in 0..N {
                    for column in 0..N {
                        normal[row][column] += weight * powers[row] * powers[column];
                    }
                    right[row] += weight * powers[row] * y;
                }
            }
            value_at_centre(normal, right)
        })
        .collect()
}

/// Returns the constant term of the solution of the normal equations, by Gaussian elimination from
/// the highest power down. The matrix is symmetric and positive, so pivots need no search.
fn value_at_centre<const N: usize>(mut normal: [[f64; N]; N], mut right: [f64; N]) -> f64 {
    // u is within ±1. A pivot this small relative to the weight means too few points.
    const SINGULAR: f64 = 1e-9;
    let mean = right[0] / normal[0][0];
    let threshold = SINGULAR * normal[0][0];
    for pivot in (1..N).rev() {
        if normal[pivot][pivot] <= threshold {
            return mean;
        }
        let pivot_row = normal[pivot];
        for row in 0..pivot {
            let factor = normal[row][pivot] / pivot_row[pivot];
            for (value, above) in normal[row].iter_mut().zip(pivot_row) {
                *value -= factor * above;
            }
            right[row] -= factor * right[pivot];
        }
    }
    if normal[0][0] <= threshold {
        return mean;
    }
    right[0] / normal[0][0]
}
