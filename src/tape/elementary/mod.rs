//! Elementary functions of our own, so that a result does not change with the system's C library, and lanes run side by side.
//!
//! They are straight lines in which every branch is a choice between two values, so that loops over lanes become vector code;
//! nothing is contracted, so that every instruction set gives the same bits. The recipes and coefficients are published:
//! f64 those of fdlibm (Sun Microsystems 1993), f32 those of Cephes (Moshier 1992), whose polynomials WGSL evaluates too
//! (`shaders/lib/functions.wgsl`). Errors are measured in `tests/functions`.

/// Runs `near` on lanes, all at once where it serves them all; those that are `far` are taken one by one.
pub(super) fn reaching<T: Copy>(lanes: &mut [T], near: fn(&mut [T]), is_far: fn(T) -> bool, far: fn(T) -> T) {
    if !lanes.iter().any(|lane| is_far(*lane)) {
        return near(lanes);
    }
    for lane in lanes {
        if is_far(*lane) { *lane = far(*lane) } else { near(std::slice::from_mut(lane)) }
    }
}

/// Declares loops over lanes, each compiled for several instruction sets, from functions of a number.
macro_rules! over_lanes {
    ($float:ty: $($name:ident = |$a:ident $(, $b:ident)?| $value:expr;)+) => {
        /// Loops over lanes.
        pub(in crate::tape) mod lanes {
            use multiversion::multiversion;

            $(
                #[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
                pub(in crate::tape) fn $name(lanes: &mut [$float] $(, $b: &[$float])?) {
                    over_lanes!(@loop lanes, $a $(, $b)?, $value);
                }
            )+
        }
    };
    (@loop $lanes:ident, $a:ident, $value:expr) => {
        for lane in $lanes {
            let $a = *lane;
            *lane = $value;
        }
    };
    (@loop $lanes:ident, $a:ident, $b:ident, $value:expr) => {
        for (lane, other) in $lanes.iter_mut().zip($b) {
            let ($a, $b) = (*lane, *other);
            *lane = $value;
        }
    };
}

pub(super) mod double;
pub(super) mod single;

#[cfg(test)]
mod tests;
