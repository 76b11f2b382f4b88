//! Tapes as WGSL: one `let` an operation.

use super::operations::Wgsl;
use super::straight_line::{Argument, Code, Operation, Tape};
use crate::precision::Precision;
use std::fmt::Write;

/// Why a tape cannot be printed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WgslError {
    /// WGSL has no such function in f64.
    #[error("the step needs `{function}`, which GPUs do not have in f64: use --precision f32, or --device cpu")]
    NotInF64 {
        /// Name of the function.
        function: String,
    },
    /// A constant has no literal.
    #[error("the step has the constant {value}, which WGSL cannot write: check the problem's fixed values")]
    NotFinite {
        /// The constant.
        value: String,
    },
}

/// A literal of the kernel's number format.
///
/// # Errors
/// If the value is not finite in it.
pub fn literal(value: f64, precision: Precision) -> Result<String, WgslError> {
    #[expect(clippy::cast_possible_truncation, reason = "rounded once, as the CPU lanes do")]
    let single = value as f32;
    match precision {
        Precision::F32 if single.is_finite() => Ok(format!("{single:?}f")),
        Precision::F64 if value.is_finite() => Ok(format!("{value:?}lf")),
        _ => Err(WgslError::NotFinite { value: value.to_string() }),
    }
}

/// The functions that a printed tape calls and the language lacks: none, or all of ours, which need `positive` of
/// `shaders/lib/single.wgsl`.
#[must_use]
pub fn functions(printed: &str) -> &'static str {
    if printed.contains("f_") { concat!("\n", include_str!("../../shaders/lib/functions.wgsl")) } else { "" }
}

/// Prints a tape. Register `i` is read as `names[i]` until the tape writes it; afterwards it is the `let` that wrote it.
#[derive(Debug)]
pub struct Printer<'a> {
    /// Number format.
    pub precision: Precision,
    /// What stands in each register before the first operation.
    pub registers: &'a [String],
    /// What each scalar is called.
    pub scalars: &'a [String],
}

impl Printer<'_> {
    /// The lines of the tape, and what each register is called after it.
    ///
    /// # Errors
    /// If WGSL lacks a function or a literal.
    pub fn print(&self, tape: &Tape) -> Result<(String, Vec<String>), WgslError> {
        let mut names: Vec<String> = self.registers.to_vec();
        names.resize(tape.registers.max(names.len()), String::new());
        let mut text = String::new();
        for (i, operation) in tape.operations.iter().enumerate() {
            let value = self.value(operation, &names)?;
            let name = format!("v{i}");
            // Writing to a String cannot fail.
            let _ = writeln!(text, "let {name} = {value};");
            names[operation.register as usize] = name;
        }
        Ok((text, names))
    }

    fn value(&self, operation: &Operation, names: &[String]) -> Result<String, WgslError> {
        let of = |argument: Argument| match argument {
            Argument::NONE => String::new(),
            Argument::Register(r) => names[r as usize].clone(),
            Argument::Scalar(s) => self.scalars[s as usize].clone(),
        };
        let [a, b, c, d, e] = operation.arguments.map(of);
        Ok(match operation.code {
            Code::Copy => a,
            Code::Unary(op) => self.call(op.row().name, op.row().wgsl, &[a])?,
            Code::Binary(op) => self.call(op.row().name, op.row().wgsl, &[a, b])?,
            Code::Select => format!("select({c}, {b}, positive({a}))"),
            Code::MultiplyAdd => format!("{a} * {b} + {c}"),
            Code::MultiplySubtract => format!("{a} * {b} - {c}"),
            Code::SubtractProduct => format!("{c} - {a} * {b}"),
            Code::Dot => format!("{a} * {b} + {c} * {d}"),
            Code::DotAdd => format!("({a} * {b} + {e}) + {c} * {d}"),
            Code::MultiplyPositive => format!("{a} * positive_part({b})"),
        })
    }

    fn call(&self, name: &str, wgsl: Wgsl, operands: &[String]) -> Result<String, WgslError> {
        match wgsl {
            Wgsl::Sign if operands.len() == 1 => Ok(format!("{name}{}", operands[0])),
            Wgsl::Sign => Ok(operands.join(&format!(" {name} "))),
            Wgsl::Single(_) if self.precision == Precision::F64 => {
                Err(WgslError::NotInF64 { function: name.to_owned() })
            }
            Wgsl::Call(function) | Wgsl::Single(function) => Ok(format!("{function}({})", operands.join(", "))),
        }
    }
}
