//! The kernel of a program: the skeleton of `shaders/filter.wgsl` with the traced step printed into it.

use super::GpuError;
use super::layout::{Layout, numbers_a_row};
use crate::filter::{Program, Role, Step};
use crate::precision::Precision;
use crate::tape::lanes::Lane;
use crate::tape::wgsl::{Printer, WgslError, functions, literal};
use std::fmt::Write;

/// A mask of lower bits splits every so many steps.
const _: () =
    assert!(f32::STEPS_PER_SPLIT.is_power_of_two() && f64::STEPS_PER_SPLIT.is_power_of_two(), "a mask of lower bits");

const SKELETON: &str = include_str!("../../../shaders/filter.wgsl");

/// Assembles the WGSL of a program.
///
/// # Errors
/// If the step needs a function that the number format lacks, or a row of the record is too wide for a kernel.
pub fn assemble(program: &Program) -> Result<String, GpuError> {
    print(program, &Layout::new(program))
}

/// The WGSL of a program that lies in memory like this.
///
/// # Errors
/// As [`assemble`].
pub(super) fn print(program: &Program, layout: &Layout) -> Result<String, GpuError> {
    let precision = program.precision();
    if !layout.fits() {
        let limit = Layout::RECORD / Program::BLOCK * Layout::width(precision);
        return Err(GpuError::TooWide { columns: numbers_a_row(program), limit });
    }
    let step = steps(program, layout)?;
    let parts = Parts { program, precision, layout };
    let mut text = String::with_capacity(SKELETON.len() + 2 * step.len());
    for line in SKELETON.lines() {
        let indent = &line[..line.len() - line.trim_start().len()];
        let Some(marker) = line.trim_start().strip_prefix("//# ") else {
            text.push_str(&line.replace("STARTS", &layout.starts().to_string()).replace("SPLIT", &parts.split_mask()));
            text.push('\n');
            continue;
        };
        let block = match marker {
            "types" => parts.types(),
            "functions" => parts.functions().to_owned() + functions(&step),
            "invariants" => parts.invariants(),
            "carried" => parts.carried(),
            "start" => parts.start(),
            "load" => parts.load(),
            "sums" => parts.sums()?,
            "record" => parts.record(),
            "step" => step.clone(),
            "split" => parts.split(),
            "move" => parts.move_sums()?,
            "keep" => parts.keep(),
            "store" => parts.store(),
            unknown => unreachable!("the skeleton has the mark `{unknown}`, for which nothing is printed"),
        };
        for line in block.lines() {
            let _ = writeln!(text, "{indent}{line}");
        }
    }
    Ok(text)
}

/// The steps: the only one, or the one that the row's first number names.
fn steps(program: &Program, layout: &Layout) -> Result<String, WgslError> {
    if let [only] = program.steps() {
        return step(program, layout, only, 0);
    }
    let mut text = format!("switch u32({}) {{\n", column(0, program.precision()));
    for (kind, of) in program.steps().iter().enumerate() {
        let case = if kind + 1 == program.steps().len() { "default".to_owned() } else { format!("case {kind}u") };
        let _ = writeln!(text, "    {case}: {{");
        step(program, layout, of, 1)?.lines().for_each(|line| {
            let _ = writeln!(text, "        {line}");
        });
        text.push_str("    }\n");
    }
    Ok(text + "}\n")
}

/// A step whose columns begin at number `first` of a row, and the assignments that carry its results to the next row.
fn step(program: &Program, layout: &Layout, step: &Step, first: usize) -> Result<String, WgslError> {
    let precision = program.precision();
    let invariants = (0..program.invariants()).map(|i| format!("i{i}"));
    let registers: Vec<String> = (0..program.carried().len()).map(|i| format!("c{i}")).chain(invariants).collect();
    let columns = (0..step.columns()).map(|c| Ok(column(first + c, precision)));
    let constants = step.constants().iter().map(|value| literal(*value, precision));
    let scalars: Vec<String> = columns.chain(constants).collect::<Result<_, _>>()?;
    let printer = Printer { precision, registers: &registers, scalars: &scalars };
    let (mut text, names) = printer.print(step.tape())?;
    if layout.traced > 0 {
        text += &trace(program.carried().len(), step.tape().operations.len(), layout);
    }
    for (i, register) in registers.iter().enumerate().take(program.carried().len()) {
        if names[i] != *register {
            let _ = writeln!(text, "{register} = {};", names[i]);
        }
    }
    Ok(text)
}

/// Stores what the last row of a trajectory begins with, and the values of its step.
fn trace(carried: usize, operations: usize, layout: &Layout) -> String {
    let values = (0..carried).map(|i| format!("c{i}")).chain((0..operations).map(|i| format!("v{i}")));
    let begin = format!("let traced = chunks[chunk].totals + {}u;\n", layout.totals_a_chunk);
    let stores = values.enumerate().fold(begin, |mut text, (i, value)| {
        let _ = writeln!(text, "totals[(traced + {i}u) * stride + candidate] = {value};");
        text
    });
    format!("if (row + 1u == rows && chunks[chunk].last == 1u) {{\n{stores}}}\n")
}

/// Column `c` of the row at hand.
fn column(c: usize, precision: Precision) -> String {
    let width = Layout::width(precision);
    format!("q{}.{}", c / width, ["x", "y", "z", "w"][c % width])
}

/// The pieces that are printed into the skeleton.
struct Parts<'a> {
    program: &'a Program,
    precision: Precision,
    layout: &'a Layout,
}

impl Parts<'_> {
    fn types(&self) -> String {
        let (real, pack) = match self.precision {
            Precision::F32 => ("f32", "vec4<f32>"),
            Precision::F64 => ("f64", "vec2<f64>"),
        };
        format!(
            "alias Real = {real};\nalias Pack = {pack};\nconst RECORD: u32 = {}u;\nconst PACKS_A_ROW: u32 = {}u;",
            Layout::RECORD,
            self.layout.packs_a_row
        )
    }

    /// Comparisons see finite numbers only: in f32 by their bits, which no compiler may assume away.
    const fn functions(&self) -> &'static str {
        match self.precision {
            Precision::F32 => include_str!("../../../shaders/lib/single.wgsl"),
            Precision::F64 => include_str!("../../../shaders/lib/double.wgsl"),
        }
    }

    fn split_mask(&self) -> String {
        let steps = match self.precision {
            Precision::F32 => f32::STEPS_PER_SPLIT,
            Precision::F64 => f64::STEPS_PER_SPLIT,
        };
        format!("{}u", steps - 1)
    }

    fn invariants(&self) -> String {
        lines(0..self.program.invariants(), |i| format!("let i{i} = prologue[{i}u * stride + candidate];"))
    }

    fn carried(&self) -> String {
        lines(0..self.program.carried().len(), |i| format!("var c{i}: Real; // {}", self.program.carried()[i].name))
    }

    /// Initial states: uniform ones from the chunk, the others from the prologue; then sums, products, check.
    fn start(&self) -> String {
        let width = Layout::width(self.precision);
        let (mut uniform, mut varying) = (0, 0);
        "let initial = chunks[chunk].initial;\n".to_owned()
            + &lines(0..self.program.carried().len(), |i| match self.program.carried()[i].role {
                Role::State if self.program.varies()[i] => {
                    varying += 1;
                    format!("c{i} = prologue[(initial + {}u) * stride + candidate];", varying - 1)
                }
                Role::State => {
                    uniform += 1;
                    let at = uniform - 1;
                    format!("c{i} = chunks[chunk].starts[{}].{};", at / width, ["x", "y", "z", "w"][at % width])
                }
                Role::Sum | Role::Product | Role::Check => format!("c{i} = {};", self.neutral(i)),
            })
    }

    fn load(&self) -> String {
        lines(0..self.program.carried().len(), |i| match self.program.carried()[i].role {
            Role::State => format!("c{i} = carried[{i}u * stride + candidate];"),
            _ => format!("c{i} = {};", self.neutral(i)),
        })
    }

    /// Sums restart at 0 in every chunk, products and the check at 1.
    fn neutral(&self, i: usize) -> &'static str {
        if self.program.carried()[i].role == Role::Sum { "Real(0.0)" } else { "Real(1.0)" }
    }

    fn sums(&self) -> Result<String, WgslError> {
        let zero = literal(0.0, self.precision)?;
        Ok(lines(self.slots(), |i| format!("var t{i}: Real = {zero};")))
    }

    fn record(&self) -> String {
        lines(0..self.layout.packs_a_row, |p| format!("let q{p} = record[begin + row * PACKS_A_ROW + {p}u];"))
    }

    /// Carried registers that are summed or multiplied up.
    fn slots(&self) -> impl Iterator<Item = usize> {
        let carried = self.program.carried().iter().enumerate();
        carried.filter(|(_, c)| matches!(c.role, Role::Sum | Role::Product)).map(|(i, _)| i)
    }

    fn split(&self) -> String {
        let products = self.slots().filter(|i| self.program.carried()[*i].role == Role::Product);
        lines(products, |i| format!("t{i} = t{i} + exponent(c{i});\nc{i} = mantissa(c{i});"))
    }

    fn move_sums(&self) -> Result<String, WgslError> {
        let zero = literal(0.0, self.precision)?;
        let sums = self.slots().filter(|i| self.program.carried()[*i].role == Role::Sum);
        Ok(lines(sums, |i| format!("t{i} = t{i} + c{i};\nc{i} = {zero};")))
    }

    /// States for the next chunk.
    fn keep(&self) -> String {
        let states = (0..self.program.carried().len()).filter(|i| self.program.carried()[*i].role == Role::State);
        lines(states, |i| format!("carried[{i}u * stride + candidate] = c{i};"))
    }

    /// Totals: sums, (exponent, mantissa) of products, the check.
    fn store(&self) -> String {
        let mut total = 0;
        let others = (0..self.program.carried().len()).filter(|i| self.program.carried()[*i].role != Role::State);
        lines(others, |i| {
            let mut put = |value: String| {
                total += 1;
                format!("totals[(total + {}u) * stride + candidate] = {value};", total - 1)
            };
            match self.program.carried()[i].role {
                Role::Sum => put(format!("t{i}")),
                Role::Product => put(format!("t{i}")) + "\n" + &put(format!("c{i}")),
                Role::State | Role::Check => put(format!("c{i}")),
            }
        })
    }
}

fn lines(items: impl IntoIterator<Item = usize>, line: impl FnMut(usize) -> String) -> String {
    items.into_iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::trace;
    use crate::model::Problem;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use std::path::Path;

    /// A kernel that is looked into is the kernel, with lines that store.
    #[test]
    fn a_traced_kernel_is_the_same_but_for_its_stores() {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/matlab_plant.toml"));
        let text = text.unwrap().replace("steps = 500", "steps = 90\nmissing = 0.2");
        let problem = Problem::parse(&text, "plant.toml").unwrap();
        let log = crate::simulate::simulate(&problem, None).unwrap();
        let program = trace(&problem, &log, &problem.tune.scorers(), None).unwrap();
        assert_eq!(program.steps().len(), 2, "kinds of rows");
        let traced = print(&program, &Layout::traced(&program)).unwrap();
        let module = naga::front::wgsl::parse_str(&traced).unwrap();
        Validator::new(ValidationFlags::all(), Capabilities::FLOAT64).validate(&module).unwrap();
        let stores = |line: &&str| {
            let line = line.trim_start();
            !["if (row + 1u == rows", "let traced", "totals[(traced"].iter().any(|begin| line.starts_with(begin))
        };
        let operations: usize = program.steps().iter().map(|step| step.tape().operations.len()).sum();
        let kept: Vec<&str> = traced.lines().filter(stores).collect();
        let plain = assemble(&program).unwrap();
        assert_eq!(traced.lines().count() - kept.len(), 2 * (2 + program.carried().len()) + operations);
        // What is left of the stores closes their braces.
        let (mut kept, mut closed) = (kept.into_iter(), 0);
        for line in plain.lines() {
            closed += kept.by_ref().take_while(|found| *found != line).filter(|found| found.trim() == "}").count();
        }
        assert_eq!((closed, kept.count()), (2, 0));
    }
}
