//! Which value is in which register at each step, and the code that follows from it.
//!
//! Of straight code it is known when each value is used next, so the register that is needed last is given up (Belady).

use super::Vectors;
use super::encode::{Base, Code, Operand, Place, Register};
use super::lower::{Lowered, Step, Target, Value};
use crate::tape::lanes::LANES;

/// Bytes of a block.
const BLOCK: usize = 8 * LANES;
/// A step after the last one.
const NEVER: u32 = u32::MAX;
/// Places of the scratch memory in which calls find their two operands and leave their result.
pub(super) const OPERANDS: [usize; 2] = [0, 1];
pub(super) const RESULT: usize = 2;

/// Machine code, and the vectors of scratch memory that it works in.
pub(super) struct Assembled {
    pub(super) code: Vec<u8>,
    pub(super) scratch: usize,
}

/// `call` is a function that takes one of the addresses in `arguments` (one for each call) and the scratch memory. What `streams` writes
/// its outputs past the caches.
pub(super) fn assemble(
    lowered: &Lowered,
    (vectors, streams): (Vectors, bool),
    call: usize,
    arguments: &[usize],
) -> Assembled {
    let mut allocation = Allocation::new(&lowered.steps, (vectors, streams));
    allocation.code.prologue();
    let start = allocation.code.bytes.len();
    for (k, step) in lowered.steps.iter().enumerate() {
        let is_used = allocation.next_use[k] != NEVER;
        match *step {
            Step::Store(target, value) => allocation.output(k, target, value),
            Step::Call(number, a, b) if is_used => {
                allocation.call(k, [a, b], call, arguments[number as usize]);
            }
            Step::Input(_) | Step::Scalar(_) => {}
            _ if is_used => allocation.step(k, *step),
            _ => {}
        }
    }
    allocation.code.epilogue(start);
    Assembled { code: allocation.code.bytes, scratch: allocation.slots }
}

struct Allocation<'s> {
    steps: &'s [Step],
    code: Code,
    vectors: Vectors,
    streams: bool,
    /// The value in each register.
    registers: Vec<Option<Value>>,
    /// The register of each value.
    place: Vec<Option<Register>>,
    /// The scratch slot of each value that has been put there.
    slot: Vec<Option<u32>>,
    free_slots: Vec<u32>,
    /// Slots that the last step may still read: free from the next one on.
    freed_slots: Vec<u32>,
    slots: usize,
    /// The step that uses each value next; before a value's own step, its first use.
    next_use: Vec<u32>,
    /// The use after this one, for each operand of each step.
    use_after: Vec<[u32; 3]>,
}

impl<'s> Allocation<'s> {
    fn new(steps: &'s [Step], (vectors, streams): (Vectors, bool)) -> Allocation<'s> {
        let mut next_use = vec![NEVER; steps.len()];
        let mut use_after = vec![[NEVER; 3]; steps.len()];
        for (k, step) in steps.iter().enumerate().rev() {
            // what nobody uses is not computed, and uses nothing
            if next_use[k] == NEVER && !matches!(step, Step::Store(..)) {
                continue;
            }
            let operands = step.operands();
            use_after[k] = operands.map(|value| value.map_or(NEVER, |value| next_use[value as usize]));
            operands.into_iter().flatten().for_each(|value| next_use[value as usize] = k as u32);
        }
        Allocation {
            steps,
            code: Code::new(vectors),
            vectors,
            streams,
            registers: vec![None; vectors.registers()],
            place: vec![None; steps.len()],
            slot: vec![None; steps.len()],
            free_slots: Vec::new(),
            freed_slots: Vec::new(),
            slots: RESULT + 1,
            next_use,
            use_after,
        }
    }

    fn step(&mut self, k: usize, step: Step) {
        match step {
            Step::Packed(op, a, b) => {
                let in_memory_only = |value: Value| self.place[value as usize].is_none();
                let (a, b) = if op.commutes() && in_memory_only(a) && !in_memory_only(b) { (b, a) } else { (a, b) };
                let first = self.load(a, &[b]);
                let second = self.operand(b, a);
                let to = self.define(k);
                self.code.packed(op, to, first, second);
            }
            Step::SquareRoot(a) => {
                let operand = Operand::Register(self.load(a, &[]));
                let to = self.define(k);
                self.code.square_root(to, operand);
            }
            Step::Unordered(a, b) => {
                let first = self.load(a, &[b]);
                let second = Operand::Register(self.load(b, &[a]));
                let to = self.define(k);
                self.code.unordered(to, first, second);
            }
            Step::Shift(a, by) => {
                let from = self.load(a, &[]);
                let to = self.define(k);
                self.code.shift(to, from, by);
            }
            Step::Select { mask, set, clear } => {
                let among = [mask, set, clear];
                let [mask, set, clear] = among.map(|value| self.load(value, &among));
                let to = self.define(k);
                self.code.select(to, mask, set, clear);
            }
            Step::Input(_) | Step::Scalar(_) | Step::Call(..) | Step::Store(..) => {}
        }
    }

    /// The second operand of a step: from memory if it is there, since that takes no instruction of its own.
    fn operand(&mut self, value: Value, other: Value) -> Operand {
        match self.home(value) {
            Some(place) if self.place[value as usize].is_none() => Operand::Memory(place),
            _ => Operand::Register(self.load(value, &[other])),
        }
    }

    /// The lanes in memory that a value can be read from.
    fn home(&self, value: Value) -> Option<Place> {
        match (self.steps[value as usize], self.slot[value as usize]) {
            (Step::Input(block), _) => Some(block_place(block)),
            (Step::Scalar(index), _) => {
                Some(Place { base: Base::Scalars, offset: (index as usize * 8 * self.vectors.spread()) as i32 })
            }
            (_, Some(slot)) => Some(self.slot_place(slot as usize)),
            _ => None,
        }
    }

    /// The register of a value, loaded if it is in none; registers of `others` stay.
    fn load(&mut self, value: Value, others: &[Value]) -> Register {
        if let Some(register) = self.place[value as usize] {
            return register;
        }
        let register = self.free_register(others);
        self.code.load(register, self.home(value).expect("a value is in a register or in memory"));
        self.put(value, register);
        register
    }

    fn put(&mut self, value: Value, register: Register) {
        self.registers[register as usize] = Some(value);
        self.place[value as usize] = Some(register);
    }

    /// A register that holds nothing needed; what it held is in memory if it is needed again.
    fn free_register(&mut self, keep: &[Value]) -> Register {
        if let Some(free) = self.registers.iter().position(Option::is_none) {
            return free as Register;
        }
        let last = |register: &usize| match self.registers[*register] {
            Some(value) if keep.contains(&value) => None,
            Some(value) => Some(self.next_use[value as usize]),
            None => None,
        };
        let register = (0..self.registers.len()).filter(|r| last(r).is_some()).max_by_key(|r| last(r));
        let register = register.expect("a step has three operands at most");
        let value = self.registers[register].expect("no register is free");
        self.save(value, register as Register);
        self.registers[register] = None;
        self.place[value as usize] = None;
        register as Register
    }

    /// Writes a value to the scratch memory unless it can be read from memory as it is.
    fn save(&mut self, value: Value, register: Register) {
        if self.home(value).is_some() || self.next_use[value as usize] == NEVER {
            return;
        }
        let slot = self.free_slots.pop().unwrap_or_else(|| {
            self.slots += 1;
            (self.slots - 1) as u32
        });
        self.slot[value as usize] = Some(slot);
        self.code.store(self.slot_place(slot as usize), register);
    }

    /// After the operands of step `k` have been read: gives up those that are not used again.
    fn release(&mut self, k: usize) {
        self.free_slots.append(&mut self.freed_slots);
        for (operand, next) in self.steps[k].operands().into_iter().zip(self.use_after[k]) {
            let Some(value) = operand.map(|value| value as usize) else { continue };
            self.next_use[value] = next;
            if next != NEVER {
                continue;
            }
            if let Some(register) = self.place[value].take() {
                self.registers[register as usize] = None;
            }
            self.freed_slots.extend(self.slot[value].take());
        }
    }

    /// The register that step `k` writes, which may be one of an operand's.
    fn define(&mut self, k: usize) -> Register {
        self.release(k);
        let register = self.free_register(&[]);
        self.put(k as Value, register);
        register
    }

    fn slot_place(&self, slot: usize) -> Place {
        Place { base: Base::Scratch, offset: (slot * 8 * self.vectors.lanes()) as i32 }
    }

    fn output(&mut self, k: usize, target: Target, value: Value) {
        let register = self.load(value, &[]);
        match target {
            Target::Block(block) => self.code.store(block_place(block), register),
            Target::Output(index) => {
                let place = Place { base: Base::Outputs, offset: (index as usize * BLOCK) as i32 };
                if self.streams { self.code.stream(place, register) } else { self.code.store(place, register) }
            }
        }
        self.release(k);
    }

    fn call(&mut self, k: usize, operands: [Value; 2], function: usize, argument: usize) {
        for (operand, slot) in operands.into_iter().zip(OPERANDS) {
            let register = self.load(operand, &[]);
            self.code.store(self.slot_place(slot), register);
        }
        self.release(k);
        for register in 0..self.registers.len() {
            if let Some(value) = self.registers[register].take() {
                self.save(value, register as Register);
                self.place[value as usize] = None;
            }
        }
        self.code.call(function, argument);
        let register = self.free_register(&[]);
        self.code.load(register, self.slot_place(RESULT));
        self.put(k as Value, register);
    }
}

fn block_place(block: u32) -> Place {
    Place { base: Base::Blocks, offset: (block as usize * BLOCK) as i32 }
}
