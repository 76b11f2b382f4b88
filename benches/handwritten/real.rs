//! The number format of a hand-written filter.

use std::ops::{Add, Div, Mul, Sub};

/// f32 or f64.
pub(crate) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Into<f64>
{
    /// Rounded from f64.
    fn of(value: f64) -> Self;
    /// A positive normal number as (mantissa in [1, 2), exponent), without branches.
    fn split(self) -> (Self, Self);
}

impl Real for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits();
        // 2^52 + e has e in its last bits: an exact conversion that needs no integer-to-double instruction.
        let exponent = Self::from_bits(0x4330_0000_0000_0000 | (bits >> 52)) - (4_503_599_627_370_496.0 + 1023.0);
        (Self::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000), exponent)
    }
}

impl Real for f32 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits();
        let exponent = Self::from_bits(0x4b00_0000 | (bits >> 23)) - (8_388_608.0 + 127.0);
        (Self::from_bits((bits & 0x007f_ffff) | 0x3f80_0000), exponent)
    }
}
