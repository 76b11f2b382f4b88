// f64 by comparisons: WGSL has neither bits nor logarithms of it.

// Whether a is positive and finite.
fn positive(a: f64) -> bool {
    return a > 0.0lf && a < 1.7e308lf;
}

// The power of two, a multiple of 64, that brings a close to 1.
fn exponent(a: f64) -> f64 {
    var b = a;
    var e = 0.0lf;
    if (b >= 1.3407807929942597e154lf) { b = b * 7.458340731200207e-155lf; e = e + 512.0lf; }
    if (b >= 1.157920892373162e77lf) { b = b * 8.636168555094445e-78lf; e = e + 256.0lf; }
    if (b >= 3.402823669209385e38lf) { b = b * 2.938735877055719e-39lf; e = e + 128.0lf; }
    if (b >= 1.8446744073709552e19lf) { b = b * 5.421010862427522e-20lf; e = e + 64.0lf; }
    if (b < 7.458340731200207e-155lf) { b = b * 1.3407807929942597e154lf; e = e - 512.0lf; }
    if (b < 8.636168555094445e-78lf) { b = b * 1.157920892373162e77lf; e = e - 256.0lf; }
    if (b < 2.938735877055719e-39lf) { b = b * 3.402823669209385e38lf; e = e - 128.0lf; }
    if (b < 5.421010862427522e-20lf) { b = b * 1.8446744073709552e19lf; e = e - 64.0lf; }
    return e;
}

// a / 2^exponent(a), exactly.
fn mantissa(a: f64) -> f64 {
    var b = a;
    if (b >= 1.3407807929942597e154lf) { b = b * 7.458340731200207e-155lf; }
    if (b >= 1.157920892373162e77lf) { b = b * 8.636168555094445e-78lf; }
    if (b >= 3.402823669209385e38lf) { b = b * 2.938735877055719e-39lf; }
    if (b >= 1.8446744073709552e19lf) { b = b * 5.421010862427522e-20lf; }
    if (b < 7.458340731200207e-155lf) { b = b * 1.3407807929942597e154lf; }
    if (b < 8.636168555094445e-78lf) { b = b * 1.157920892373162e77lf; }
    if (b < 2.938735877055719e-39lf) { b = b * 3.402823669209385e38lf; }
    if (b < 5.421010862427522e-20lf) { b = b * 1.8446744073709552e19lf; }
    return b;
}

// a where it is positive and finite, else 0.
fn positive_part(a: f64) -> f64 {
    return select(0.0lf, a, positive(a));
}
