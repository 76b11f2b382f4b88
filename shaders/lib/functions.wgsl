// Elementary functions in f32, so that an adapter's own, which may be as coarse as 2^-11, do not decide what a filter costs.
// The recipes and polynomials are those of the CPU lanes (src/tape/elementary/single.rs), after Cephes (Moshier 1992); angles
// are reduced in f32, by pi/2 in three parts: up to 8,000 radians to 1e-7, beyond the error grows with the angle.
// What has no value becomes NaN by its bits, which no compiler may assume away.

fn f_no_value(value: f32, missing: bool) -> f32 {
    return bitcast<f32>(select(0u, 0x7fc00000u, missing) | bitcast<u32>(value));
}

// An angle less n quarter turns, for whole n.
fn f_less_quarters(a: f32, n: f32) -> f32 {
    return ((a - n * 1.5703125f) - n * 4.837512969970703125e-4f) - n * 7.54978995489188216e-8f;
}

fn f_turned(a: f32, shift: i32) -> f32 {
    let n = round(a * 0.63661977f);
    let quarters = i32(n) + shift;
    // An angle too large for its reduction still has a sine within bounds.
    let x = clamp(f_less_quarters(a, n), -1.0f, 1.0f);
    let z = x * x;
    let sine = x + x * (z * ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f));
    let cosine = 1.0f - 0.5f * z
        + z * z * ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f);
    let value = select(sine, cosine, (quarters & 1) == 1);
    return select(value, -value, (quarters & 2) == 2);
}

fn f_sin(a: f32) -> f32 {
    return f_turned(a, 0);
}

fn f_cos(a: f32) -> f32 {
    return f_turned(a, 1);
}

// The angle in [-pi, pi].
fn f_wrap(a: f32) -> f32 {
    return clamp(f_less_quarters(a, 4.0f * round(a * 0.15915494f)), -3.14159274f, 3.14159274f);
}

// exp(x) - 1 within ln(2) / 2.
fn f_expm1_near(x: f32) -> f32 {
    let p = ((((1.9875691500e-4f * x + 1.3981999507e-3f) * x + 8.3334519073e-3f) * x + 4.1665795894e-2f) * x
        + 1.6666665459e-1f) * x + 5.0000001201e-1f;
    return x + x * x * p;
}

// 2^k for whole k in the range of normal numbers.
fn f_two_to(k: i32) -> f32 {
    return bitcast<f32>(u32(k + 127) << 23u);
}

fn f_exp(a: f32) -> f32 {
    let x = clamp(a, -105.0f, 89.0f);
    let n = round(x * 1.44269504f);
    let k = i32(n);
    let half = k / 2;
    let p = 1.0f + f_expm1_near((x - n * 0.693359375f) + n * 2.12194440e-4f);
    return p * f_two_to(half) * f_two_to(k - half);
}

fn f_expm1(a: f32) -> f32 {
    let x = clamp(a, -20.0f, 89.0f);
    let n = round(x * 1.44269504f);
    let k = i32(n);
    let half = k / 2;
    let p = f_expm1_near((x - n * 0.693359375f) + n * 2.12194440e-4f);
    let value = ((1.0f - f_two_to(-min(k, 30))) + p) * f_two_to(half) * f_two_to(k - half);
    return select(value, p, k == 0);
}

// k ln 2 + ln(1 + f) + c for small c, where 2^k (1 + f) is positive.
fn f_ln_sum(k: f32, f: f32, c: f32) -> f32 {
    let z = f * f;
    let p = (((((((7.0376836292e-2f * f - 1.1514610310e-1f) * f + 1.1676998740e-1f) * f - 1.2420140846e-1f) * f
        + 1.4249322787e-1f) * f - 1.6668057665e-1f) * f + 2.0000714765e-1f) * f - 2.4999993993e-1f) * f
        + 3.3333331174e-1f;
    let small = f * z * p + (c - k * 2.12194440e-4f);
    return (f + (small - 0.5f * z)) + k * 0.693359375f;
}

// A positive normal number as 2^k m with m from sqrt(1/2) to sqrt(2): (k, m).
fn f_mantissa(a: f32) -> vec2<f32> {
    let bits = bitcast<u32>(a) + 0x004afb0du;
    return vec2<f32>(f32(i32(bits >> 23u) - 127), bitcast<f32>((bits & 0x007fffffu) + 0x3f3504f3u));
}

fn f_ln(a: f32) -> f32 {
    let small = a < 1.17549435e-38f;
    let parts = f_mantissa(select(a, a * 33554432.0f, small));
    let value = f_ln_sum(select(parts.x, parts.x - 25.0f, small), parts.y - 1.0f, 0.0f);
    return f_no_value(value, !positive(a));
}

fn f_log1p(a: f32) -> f32 {
    let sum = 1.0f + a;
    let parts = f_mantissa(sum);
    let lost = select(a - (sum - 1.0f), 1.0f - (sum - a), parts.x >= 2.0f);
    let near = a > -0.2928f && a < 0.4142f;
    let f = select(parts.y - 1.0f, a, near);
    let value = f_ln_sum(parts.x, f, select(lost / sum, 0.0f, near));
    return f_no_value(value, !positive(sum));
}

// The angle of (x, y), in [-pi, pi].
fn f_atan2(y: f32, x: f32) -> f32 {
    let largest = max(abs(y), abs(x));
    let factor = select(select(1.0f, 16777216.0f, largest < 1e-30f), 0.125f, largest > 1e37f);
    let a = abs(y) * factor;
    let b = abs(x) * factor;
    let first = a < 0.41421356f * b;
    let second = a < 2.4142136f * b;
    let numerator = select(select(-b, a - b, second), a, first);
    let denominator = select(select(a, a + b, second), b, first);
    let centre = select(select(1.57079637f, 0.785398185f, second), 0.0f, first);
    let t = numerator / select(denominator, 1.0f, denominator == 0.0f);
    let z = t * t;
    let p = ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f;
    let from_axis = select(centre + (t + t * (z * p)), 0.0f, a + b == 0.0f);
    let angle = select(from_axis, 3.14159274f - from_axis, x < 0.0f);
    return select(angle, -angle, y < 0.0f);
}

// a^b; of a negative a for whole b alone. The error grows with b ln a.
fn f_power(a: f32, b: f32) -> f32 {
    let size = select(f_exp(b * f_ln(abs(a))), select(0.0f, f_exp(1000.0f), b < 0.0f), a == 0.0f);
    let odd = floor(0.5f * b) != 0.5f * b;
    let value = select(size, select(size, -size, odd), a < 0.0f);
    return f_no_value(select(value, 1.0f, b == 0.0f), a < 0.0f && floor(b) != b);
}
