// f32 as bits: what a compiler that assumes finite numbers cannot simplify away.

// Whether a is positive and finite: its bits lie between those of 0 and of infinity.
fn positive(a: f32) -> bool {
    return bitcast<u32>(a) - 1u < 0x7f7fffffu;
}

// a = mantissa * 2^exponent with the mantissa in [1, 2), for positive normal a.
fn exponent(a: f32) -> f32 {
    return f32(i32((bitcast<u32>(a) >> 23u) & 0xffu) - 127);
}

// 0, what is below the normal numbers and what is not finite get the mantissa 0: the host sees ln 0 and fails the candidate.
fn mantissa(a: f32) -> f32 {
    let bits = bitcast<u32>(a);
    let normal = ((bits & 0x7f800000u) - 1u) < 0x7f7fffffu;
    return select(0.0f, bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u), normal);
}

// a where it is positive and finite, else 0.
fn positive_part(a: f32) -> f32 {
    return select(0.0f, a, positive(a));
}
