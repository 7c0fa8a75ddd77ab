//! Division by a constant without dividing: of 64 bits, a controller has no instruction for it, and
//! the library's function takes a kilobyte of flash.

/// A number to be divided by (T. Granlund, P. L. Montgomery, "Division by invariant integers using
/// multiplication", 1994).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Divisor {
    by: u64,
    /// 2⁶⁴ times 2 to the `shift`, over the number, rounded up; 0 for 1.
    reciprocal: u64,
    shift: u8,
}

impl Divisor {
    /// By a number from 1 to 2³².
    pub(crate) const fn new(by: u64) -> Self {
        let shift = by.ilog2() as u8;
        let reciprocal = if by.is_power_of_two() {
            0
        } else {
            (1_u128 << (64 + shift)).div_ceil(by as u128) as u64
        };
        Self {
            by,
            reciprocal,
            shift,
        }
    }

    /// The number.
    pub(crate) const fn by(self) -> u64 {
        self.by
    }

    /// The quotient, rounded down, of what is below 2⁶³: the reciprocal is too large by less than
    /// its last bit.
    pub(crate) const fn divide(self, dividend: u64) -> u64 {
        let quotient = if self.reciprocal == 0 {
            dividend
        } else {
            upper_product(dividend, self.reciprocal)
        };
        quotient >> self.shift
    }
}

/// The upper half of the product.
pub(crate) const fn upper_product(a: u64, b: u64) -> u64 {
    const LOW: u64 = 0xffff_ffff;
    let [a_high, b_high] = [a >> 32, b >> 32];
    let [a_low, b_low] = [a & LOW, b & LOW];
    let cross = a_high * b_low + ((a_low * b_low) >> 32);
    let other = a_low * b_high + (cross & LOW);
    a_high * b_high + (cross >> 32) + (other >> 32)
}

#[cfg(test)]
mod tests {
    use super::Divisor;

    #[test]
    fn quotients_are_those_of_a_division() {
        for by in [
            1,
            2,
            3,
            7,
            10,
            1_000,
            1_000_000_000,
            1 << 31,
            (1 << 31) + 1,
            u64::from(u32::MAX),
            1 << 32,
        ] {
            let divisor = Divisor::new(by);
            for bits in 0..=63 {
                for near in [-2_i64, -1, 0, 1, 2] {
                    let multiple = (1_u64 << bits) / by * by;
                    for dividend in [1_u64 << bits, multiple] {
                        let dividend = dividend.checked_add_signed(near);
                        let Some(dividend) = dividend.filter(|dividend| *dividend < 1 << 63) else {
                            continue;
                        };
                        assert_eq!(divisor.divide(dividend), dividend / by, "{dividend} / {by}");
                    }
                }
            }
        }
    }
}
