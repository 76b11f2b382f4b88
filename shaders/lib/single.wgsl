// f32 as bits: what a compiler that assumes finite numbers cannot simplify away.

// Whether a is positive and finite: its bits lie between those of 0 and of infinity.
fn positive(a: f32) -> bool {
    return bitcast<u32>(a) - 1u < 0x7f7fffffu;
}

// a = mantissa * 2^exponent with the mantissa in [1, 2), for positive normal a.
fn exponent(a: f32) -> f32 {
    return f32(i32((bitcast<u32>(a) >> 23u) & 0xffu) - 127);
}

// What is not finite keeps an exponent of 128, and its mantissa becomes 0: the host sees ln 0 and fails the candidate.
fn mantissa(a: f32) -> f32 {
    let bits = bitcast<u32>(a);
    return select(bitcast<f32>((bits & 0x807fffffu) | 0x3f800000u), 0.0f, (bits & 0x7f800000u) == 0x7f800000u);
}
