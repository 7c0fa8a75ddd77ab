//! Noise.

/// Reproducible noise: the sum of twelve uniform numbers, with mean 0 and variance 1.
pub struct Noise(pub u64);

impl Noise {
    pub fn draw(&mut self) -> f32 {
        let mut sum = 0.0;
        for _ in 0..12 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (self.0 >> 40) as f32 / (1_u64 << 24) as f32;
        }
        sum - 6.0
    }
}
