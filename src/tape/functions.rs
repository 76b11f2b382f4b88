//! The functions of formulas, a row for each: its name, its operands, and the nodes that it becomes. Values, derivatives,
//! differences and WGSL are those of these nodes ([`super::operations`]).

use super::graph::{Graph, Id};
use super::operations::{Binary, Unary};

/// Declares [`Function`] by its rows: variant, name, operands, nodes.
macro_rules! functions {
    ($($variant:ident $name:literal |$g:ident, $($operand:ident),+| $nodes:expr;)+) => {
        /// Functions a formula may call.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[expect(missing_docs, reason = "the names are the functions")]
        pub enum Function { $($variant),+ }

        impl Function {
            /// Every function with the name it has in formulas.
            pub const ALL: [(&'static str, Self); [$($name),+].len()] = [$(($name, Self::$variant)),+];

            /// Its name in formulas.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// Number of arguments.
            #[must_use]
            pub const fn arity(self) -> usize {
                match self { $(Self::$variant => [$(stringify!($operand)),+].len()),+ }
            }
        }

        impl Graph {
            /// A function of formulas; NaN where `arguments` are not as many as [`Function::arity`] says.
            pub fn call(&mut self, function: Function, arguments: &[Id]) -> Id {
                match (function, arguments) {
                    $((Function::$variant, &[$($operand),+]) => { let $g = &mut *self; $nodes })+
                    _ => self.constant(f64::NAN),
                }
            }
        }
    };
}

functions! {
    Sqrt "sqrt" |g, a| g.unary(Unary::Sqrt, a);
    Exp "exp" |g, a| g.unary(Unary::Exp, a);
    Ln "ln" |g, a| g.unary(Unary::Ln, a);
    Sin "sin" |g, a| g.unary(Unary::Sin, a);
    Cos "cos" |g, a| g.unary(Unary::Cos, a);
    Tan "tan" |g, a| g.unary(Unary::Tan, a);
    Atan "atan" |g, a| g.unary(Unary::Atan, a);
    Atan2 "atan2" |g, y, x| g.binary(Binary::Atan2, y, x);
    Abs "abs" |g, a| g.unary(Unary::Abs, a);
    Min "min" |g, a, b| g.binary(Binary::Min, a, b);
    Max "max" |g, a, b| g.binary(Binary::Max, a, b);
}
