//! Steps to a program: what is needed, in order, each result in a register that is free by then.

use super::program::{Operand, Program, Step};
use super::steps::{Arg, Steps};

/// The program that makes `outputs`.
pub(super) fn program(steps: &Steps, outputs: &[Arg]) -> Program {
    let count = steps.nodes.len();
    // The last step that uses each result; those of outputs are used to the end.
    let mut last_use: Vec<Option<usize>> = vec![None; count];
    for output in outputs {
        if let Arg::Step(i) = output {
            last_use[*i as usize] = Some(count);
        }
    }
    for i in (0..count).rev() {
        if last_use[i].is_some() {
            for arg in &steps.nodes[i].args {
                if let Arg::Step(arg) = arg {
                    let last = &mut last_use[*arg as usize];
                    *last = Some(last.map_or(i, |last| last.max(i)));
                }
            }
        }
    }
    let mut made = Maker::default();
    let mut register_of = vec![0; count];
    for (i, node) in steps.nodes.iter().enumerate().filter(|(i, _)| last_use[*i].is_some()) {
        let first = made.args.len() as u32;
        for arg in &node.args {
            let operand = made.operand(steps, *arg, &register_of);
            made.args.push(operand);
        }
        let mut done: Vec<u32> = node.args.iter().filter_map(|arg| step_of(*arg)).collect();
        done.sort_unstable();
        done.dedup();
        for arg in done {
            if last_use[arg as usize] == Some(i) {
                made.free.push(register_of[arg as usize]);
            }
        }
        let out = made.register();
        register_of[i] = out;
        made.steps.push(Step { action: node.action.clone(), first, count: node.args.len() as u8, out });
    }
    let operands = outputs.iter().map(|arg| made.operand(steps, *arg, &register_of)).collect();
    let needed: Vec<bool> = last_use.iter().map(Option::is_some).collect();
    Program {
        steps: made.steps.into(),
        args: made.args.into(),
        constants: made.constants.into(),
        outputs: operands,
        registers: made.registers,
        asks: steps.asks(&needed),
    }
}

fn step_of(arg: Arg) -> Option<u32> {
    match arg {
        Arg::Step(i) => Some(i),
        Arg::Constant(_) => None,
    }
}

#[derive(Default)]
struct Maker {
    steps: Vec<Step>,
    args: Vec<Operand>,
    constants: Vec<[f64; 4]>,
    /// Where constants of the graph have gone.
    constant_of: std::collections::HashMap<u32, usize>,
    registers: u32,
    free: Vec<u32>,
}

impl Maker {
    fn operand(&mut self, steps: &Steps, arg: Arg, register_of: &[u32]) -> Operand {
        match arg {
            Arg::Step(i) => Operand::register(register_of[i as usize]),
            Arg::Constant(i) => {
                let constants = &mut self.constants;
                let at = *self.constant_of.entry(i).or_insert_with(|| {
                    constants.push(steps.constants[i as usize]);
                    constants.len() - 1
                });
                Operand::constant(at)
            }
        }
    }

    fn register(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.registers += 1;
            self.registers - 1
        })
    }
}
