//! Registers by liveness.

use super::graph::Id;
use super::straight_line::{Argument, Code, Operation, Output, Tape, TooLarge};
use super::terms::{Term, Terms};
use std::collections::{HashMap, HashSet};

/// Register assignment in one pass over the ordered operations.
pub(super) struct Assignment<'a, U> {
    uniform: U,
    remaining: HashMap<Id, usize>,
    place: HashMap<Id, usize>,
    target: HashMap<Id, usize>,
    input_of: HashMap<usize, Id>,
    outputs: HashSet<Id>,
    saved: HashMap<Id, usize>,
    fixed: usize,
    free: Vec<usize>,
    next: usize,
    scalars: Vec<Id>,
    scalar_index: HashMap<Id, u16>,
    operations: Vec<Operation>,
    placed: &'a HashMap<Id, usize>,
}

impl<'a, U: Fn(Id) -> bool> Assignment<'a, U> {
    pub(super) fn new(placed: &'a HashMap<Id, usize>, outputs: &[Output], terms: &Terms, uniform: U) -> Self {
        let mut remaining: HashMap<Id, usize> = HashMap::new();
        for operand in terms.of.values().flat_map(|t| &t.operands) {
            *remaining.entry(*operand).or_default() += 1;
        }
        let fixed = outputs.iter().map(|o| o.register + 1).max().unwrap_or(0).max(placed.len());
        let mut target = HashMap::new();
        for output in outputs {
            target.entry(output.id).or_insert(output.register);
        }
        let mut this = Self {
            uniform,
            remaining,
            place: placed.clone(),
            target,
            input_of: placed.iter().map(|(id, r)| (*r, *id)).collect(),
            outputs: outputs.iter().map(|o| o.id).collect(),
            saved: HashMap::new(),
            fixed,
            free: Vec::new(),
            next: fixed,
            scalars: Vec::new(),
            scalar_index: HashMap::new(),
            operations: Vec::new(),
            placed,
        };
        this.save_shifted_inputs(outputs);
        this
    }

    /// An output that is another register's input is copied away before anything can overwrite it.
    fn save_shifted_inputs(&mut self, outputs: &[Output]) {
        for output in outputs {
            let shifted = self.placed.get(&output.id).is_some_and(|r| *r != output.register);
            if shifted && !self.saved.contains_key(&output.id) {
                let source = self.argument(output.id);
                let register = self.temporary();
                self.push(Code::Copy, register, &[source]);
                self.saved.insert(output.id, register);
            }
        }
    }

    pub(super) fn emit(&mut self, id: Id, term: &Term) {
        let arguments: Vec<Argument> = term.operands.iter().map(|o| self.argument(*o)).collect();
        for operand in &term.operands {
            self.release(*operand);
        }
        let register = self.destination(id);
        let (code, arguments) = canonical(term.code, arguments);
        self.push(code, register, &arguments);
        self.place.insert(id, register);
    }

    /// The output's own register if its input is dead by now, else a temporary one.
    fn destination(&mut self, id: Id) -> usize {
        if let Some(&register) = self.target.get(&id)
            && self.input_of.get(&register).is_none_or(|input| self.remaining.get(input).is_none_or(|n| *n == 0))
        {
            return register;
        }
        self.temporary()
    }

    fn temporary(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.next += 1;
            self.next - 1
        })
    }

    /// One use less; a temporary that nobody needs any more is free.
    fn release(&mut self, id: Id) {
        let Some(count) = self.remaining.get_mut(&id) else { return };
        *count -= 1;
        if *count == 0
            && !self.outputs.contains(&id)
            && let Some(&register) = self.place.get(&id).filter(|r| **r >= self.fixed)
        {
            self.free.push(register);
        }
    }

    fn argument(&mut self, id: Id) -> Argument {
        if let Some(&register) = self.place.get(&id) {
            return Argument::Register(narrow(register));
        }
        debug_assert!((self.uniform)(id), "an operand is in a register or a scalar");
        let next = narrow(self.scalars.len());
        let index = *self.scalar_index.entry(id).or_insert(next);
        if index == next {
            self.scalars.push(id);
        }
        Argument::Scalar(index)
    }

    fn push(&mut self, code: Code, register: usize, arguments: &[Argument]) {
        let mut all = [Argument::NONE; 5];
        all[..arguments.len()].copy_from_slice(arguments);
        self.operations.push(Operation { code, register: narrow(register), arguments: all });
    }

    /// Copies what did not end in its own register.
    pub(super) fn finish(mut self, outputs: &[Output]) -> Result<Tape, TooLarge> {
        for output in outputs {
            let source = match self.saved.get(&output.id) {
                Some(copy) if self.placed[&output.id] != output.register => Argument::Register(narrow(*copy)),
                _ => self.argument(output.id),
            };
            if source != Argument::Register(narrow(output.register)) {
                self.push(Code::Copy, output.register, &[source]);
            }
        }
        let (registers, scalars) = (self.next, self.scalars.len());
        // One number fewer for scalars: the last one is `Argument::NONE`.
        if registers > TooLarge::LIMIT + 1 || scalars > TooLarge::LIMIT {
            return Err(TooLarge { registers, scalars });
        }
        Ok(Tape { operations: self.operations, registers, scalars: self.scalars })
    }
}

/// Scalars go last among the operands that commute, so that the machines need fewer cases.
fn canonical(code: Code, mut arguments: Vec<Argument>) -> (Code, Vec<Argument>) {
    let commutes = match code {
        Code::Binary(op) => op.row().commutes,
        Code::MultiplyAdd | Code::MultiplySubtract | Code::SubtractProduct => true,
        _ => false,
    };
    let pairs = match code {
        Code::Dot | Code::DotAdd => 2,
        _ => usize::from(commutes),
    };
    for pair in 0..pairs {
        if matches!(arguments[2 * pair..2 * pair + 2], [Argument::Scalar(_), Argument::Register(_)]) {
            arguments.swap(2 * pair, 2 * pair + 1);
        }
    }
    (code, arguments)
}

/// The number in an operation. One that does not fit makes [`Assignment::finish`] refuse the whole tape.
pub(super) fn narrow(place: usize) -> u16 {
    u16::try_from(place).unwrap_or(u16::MAX)
}
