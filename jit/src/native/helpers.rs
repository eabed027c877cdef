//! Functions that machine code calls.

use cranelift_jit::JITBuilder;
use dalembert::jet;
use dalembert::numbers::LENGTH;
use dalembert_numbers::math;

macro_rules! helpers {
    ($($name:ident($($argument:ident),+);)*) => {
        $(
            extern "C" fn $name($($argument: f64),+) -> f64 {
                math::$name($($argument),+)
            }
        )*

        /// The elementary functions by name.
        pub(super) fn register(builder: &mut JITBuilder) {
            $(builder.symbol(stringify!($name), $name as *const u8);)*
            builder.symbol("sin_cos", sin_cos as *const u8);
            builder.symbol("jet_half", jet_half as *const u8);
            builder.symbol("jet_middle", jet_middle as *const u8);
        }
    };
}
helpers! {
    sin(x); cos(x); tan(x); asin(x); acos(x); atan(x); atan2(y, x); exp(x); ln(x); sinh(x); cosh(x); tanh(x);
    powf(x, e);
}

/// Writes sine and cosine.
extern "C" fn sin_cos(x: f64, both: *mut [f64; 2]) {
    // SAFETY: the compiler below hands over a slot for two numbers on the stack of the caller.
    unsafe { *both = [math::sin(x), math::cos(x)] }
}

/// Half of a sum over one series.
extern "C" fn jet_half(a: *const [f64; LENGTH], k: i64) -> f64 {
    // SAFETY: series of a large expansion lie in one piece, each as long.
    jet::half(unsafe { &*a }, usize::try_from(k).unwrap_or(0))
}

/// A sum over two series.
extern "C" fn jet_middle(a: *const [f64; LENGTH], b: *const [f64; LENGTH], k: i64) -> f64 {
    let k = usize::try_from(k).unwrap_or(0);
    // SAFETY: series of a large expansion lie in one piece, each as long.
    let (a, b) = unsafe { (&*a, &*b) };
    jet::shared_middle(a, b, k)
}
