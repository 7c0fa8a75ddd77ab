//! One hypothesis: a filter of altitude, bias, wind and receiver error with levels of its own.

use super::knot::Knot;
use crate::filter::gauss_markov::GaussMarkov;
use crate::scalar::{Scalar, ln};

/// The filter, and its log-likelihood.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hypothesis {
    mean: Mean,
    covariance: Covariance,
    /// Variance of the receiver's coloured error over the assumed one, 1. Zero before the start.
    pub receiver_ratio: f32,
    pub log_likelihood: f32,
}

/// Altitude a, bias b, wind w, receiver error r, and its rate q.
#[derive(Clone, Copy, Debug)]
struct Mean {
    a: f32,
    b: f32,
    w: f32,
    r: f32,
    q: f32,
}

/// Covariance of these.
#[derive(Clone, Copy, Debug)]
struct Covariance {
    aa: f32,
    ab: f32,
    aw: f32,
    ar: f32,
    aq: f32,
    bb: f32,
    bw: f32,
    br: f32,
    bq: f32,
    ww: f32,
    wr: f32,
    wq: f32,
    rr: f32,
    rq: f32,
    qq: f32,
}

/// One step of the receiver's coloured error.
#[derive(Clone, Copy, Debug)]
pub(super) enum Receiver {
    /// Of first order.
    Coloured(GaussMarkov),
    /// Of second order, critically damped.
    Smooth(SmoothError),
}

/// Transition of the error and its rate, and their variances in the long run.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmoothError {
    /// Of the error: by the error, and by the rate.
    error: (f32, f32),
    /// Of the rate.
    rate: (f32, f32),
    variance: f32,
    rate_variance: f32,
}

impl SmoothError {
    /// Returns the step over a time in correlation times.
    pub(super) fn step(correlation_times: f32, time_s: f32, variance: f32) -> Self {
        let (rate, keep) = (1.0 / time_s, libm::expf(-correlation_times));
        Self {
            error: (
                keep * (1.0 + correlation_times),
                keep * correlation_times * time_s,
            ),
            rate: (
                -keep * correlation_times * rate,
                keep * (1.0 - correlation_times),
            ),
            variance,
            rate_variance: rate * rate * variance,
        }
    }
}

impl Receiver {
    /// Returns the variance of the error's rate in the long run.
    const fn rate_variance(&self) -> f32 {
        match self {
            Self::Coloured(_) => 0.0,
            Self::Smooth(smooth) => smooth.rate_variance,
        }
    }
}

impl Hypothesis {
    /// Before its start.
    pub(super) const EMPTY: Self = Self {
        mean: Mean {
            a: 0.0,
            b: 0.0,
            w: 0.0,
            r: 0.0,
            q: 0.0,
        },
        covariance: Covariance::ZERO,
        receiver_ratio: 0.0,
        log_likelihood: 0.0,
    };
}

impl Covariance {
    const ZERO: Self = Self {
        aa: 0.0,
        ab: 0.0,
        aw: 0.0,
        ar: 0.0,
        aq: 0.0,
        bb: 0.0,
        bw: 0.0,
        br: 0.0,
        bq: 0.0,
        ww: 0.0,
        wr: 0.0,
        wq: 0.0,
        rr: 0.0,
        rq: 0.0,
        qq: 0.0,
    };

    /// Adds the climb over a knot that bias and wind make: a' = a + l (b + w).
    fn climb(&mut self, l: f32) {
        let before = self.ab + self.aw;
        self.ab += l * (self.bb + self.bw);
        self.aw += l * (self.bw + self.ww);
        self.ar += l * (self.br + self.wr);
        self.aq += l * (self.bq + self.wq);
        self.aa += l * (before + self.ab + self.aw);
    }

    fn keep_bias(&mut self, markov: &GaussMarkov) {
        let keep = markov.keep;
        self.ab *= keep;
        self.bw *= keep;
        self.br *= keep;
        self.bq *= keep;
        self.bb = keep * keep * self.bb + markov.variance;
    }

    fn keep_wind(&mut self, markov: &GaussMarkov) {
        let keep = markov.keep;
        self.aw *= keep;
        self.bw *= keep;
        self.wr *= keep;
        self.wq *= keep;
        self.ww = keep * keep * self.ww + markov.variance;
    }

    fn keep_receiver(&mut self, markov: &GaussMarkov) {
        let keep = markov.keep;
        self.ar *= keep;
        self.br *= keep;
        self.wr *= keep;
        self.rr = keep * keep * self.rr + markov.variance;
    }

    fn turn_receiver(&mut self, smooth: &SmoothError) {
        let ((a, b), (c, d)) = (smooth.error, smooth.rate);
        for (r, q) in [
            (&mut self.ar, &mut self.aq),
            (&mut self.br, &mut self.bq),
            (&mut self.wr, &mut self.wq),
        ] {
            (*r, *q) = (a * *r + b * *q, c * *r + d * *q);
        }
        // What keeps the variances as they are in the long run: V - F V F'.
        let rr = self.rr - smooth.variance;
        let qq = self.qq - smooth.rate_variance;
        let rq = self.rq;
        self.rr = smooth.variance + a * a * rr + 2.0 * a * b * rq + b * b * qq;
        self.rq = a * c * rr + (a * d + b * c) * rq + b * d * qq;
        self.qq = smooth.rate_variance + c * c * rr + 2.0 * c * d * rq + d * d * qq;
    }
}

impl Hypothesis {
    /// Returns the filter before its start, with what it has found.
    pub(super) fn restarted(&self) -> Self {
        Self {
            receiver_ratio: self.receiver_ratio,
            log_likelihood: self.log_likelihood,
            ..Self::EMPTY
        }
    }

    /// Starts the altitude at a knot; the slow states stay. `wind` and `receiver` are the variances
    /// of the two coloured errors.
    pub(super) fn start(&mut self, knot: &Knot, wind: f32, receiver: f32, step: &Receiver) {
        let Self {
            mean: x,
            covariance: p,
            ..
        } = self;
        let is_new = x.a == 0.0 && x.b == 0.0 && x.w == 0.0 && x.r == 0.0;
        if is_new {
            *p = Covariance {
                bb: knot.known_bias_variance,
                ww: wind,
                rr: receiver,
                qq: step.rate_variance(),
                ..Covariance::ZERO
            };
        }
        x.a = knot.altitude_m - x.r;
        (p.ab, p.aw, p.ar, p.aq) = (-p.br, -p.wr, -p.rr, -p.rq);
        p.aa = p.rr + knot.variance;
    }

    /// Takes the filter over a knot. Returns twice its negative log-likelihood.
    pub(super) fn step(
        &mut self,
        knot: &Knot,
        bias: &GaussMarkov,
        wind: &GaussMarkov,
        receiver: &Receiver,
    ) -> f32 {
        let Self {
            mean: x,
            covariance: p,
            ..
        } = self;
        let lever = -0.01 * knot.length_m;
        x.a += knot.climb_m + lever * (x.b + x.w);
        p.climb(lever);
        match receiver {
            Receiver::Coloured(markov) => {
                x.r *= markov.keep;
                p.keep_receiver(markov);
            }
            Receiver::Smooth(smooth) => {
                let ((a, b), (c, d)) = (smooth.error, smooth.rate);
                (x.r, x.q) = (a * x.r + b * x.q, c * x.r + d * x.q);
                p.turn_receiver(smooth);
            }
        }
        x.b *= bias.keep;
        p.keep_bias(bias);
        x.w *= wind.keep;
        p.keep_wind(wind);
        // The new part of the wind acts on a half of the knot, as a mean.
        p.aa += lever * lever * wind.variance / 3.0;
        self.update(knot)
    }

    /// Updates with the altitude of a knot, which is that of the road and the receiver's error.
    fn update(&mut self, knot: &Knot) -> f32 {
        let Self {
            mean: x,
            covariance: p,
            ..
        } = self;
        let (a, b, w) = (p.aa + p.ar, p.ab + p.br, p.aw + p.wr);
        let (r, q) = (p.ar + p.rr, p.aq + p.rq);
        let variance = a + r + knot.variance;
        let innovation = knot.altitude_m - x.a - x.r;
        let per_variance = 1.0 / variance;
        let moved = per_variance * innovation;
        x.a += a * moved;
        x.b += b * moved;
        x.w += w * moved;
        x.r += r * moved;
        x.q += q * moved;
        let gain = a * per_variance;
        p.aa -= gain * a;
        p.ab -= gain * b;
        p.aw -= gain * w;
        p.ar -= gain * r;
        p.aq -= gain * q;
        let gain = b * per_variance;
        p.bb -= gain * b;
        p.bw -= gain * w;
        p.br -= gain * r;
        p.bq -= gain * q;
        let gain = w * per_variance;
        p.ww -= gain * w;
        p.wr -= gain * r;
        p.wq -= gain * q;
        let gain = r * per_variance;
        p.rr -= gain * r;
        p.rq -= gain * q;
        p.qq -= q * per_variance * q;
        Scalar::min(innovation * moved, LARGEST_INNOVATION) + ln(variance)
    }
}

/// Normalised squared innovation that one counts as at most: beyond five sigmas is no noise.
const LARGEST_INNOVATION: f32 = 25.0;
