//! The bytes of the few x86-64 instructions that tapes need (Intel SDM, volume 2: VEX and EVEX prefixes, ModRM).

use super::Vectors;

/// The number of a vector register.
pub(super) type Register = u8;

/// General registers by number.
const RBX: u8 = 3;
const RBP: u8 = 5;
const R13: u8 = 13;
const R15: u8 = 15;

/// Where a function's arguments stay while it runs: registers that calls preserve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Base {
    /// The lanes at work of block number zero.
    Blocks,
    Scalars,
    Scratch,
    /// The lanes at work of the first output.
    Outputs,
}

/// A place in memory: a base and bytes beyond it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) base: Base,
    pub(super) offset: i32,
}

/// The second operand of most instructions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operand {
    Register(Register),
    Memory(Place),
}

/// Opcodes of the map 0F with prefix 66: packed doubles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Packed {
    Add = 0x58,
    Multiply = 0x59,
    Subtract = 0x5c,
    Minimum = 0x5d,
    Divide = 0x5e,
    Maximum = 0x5f,
    And = 0x54,
    ExclusiveOr = 0x57,
}

impl Packed {
    pub(super) fn commutes(self) -> bool {
        // minimum and maximum tell their operands apart where one is NaN
        !matches!(self, Packed::Subtract | Packed::Divide | Packed::Minimum | Packed::Maximum)
    }
}

/// Opcodes with their map and prefix, by the numbers that these have in VEX and EVEX.
#[derive(Clone, Copy)]
struct Opcode {
    map: u8,
    prefix: u8,
    code: u8,
}

impl Opcode {
    /// Of the map 0F with prefix 66, to which most belong.
    const fn plain(code: u8) -> Opcode {
        Opcode { map: 1, prefix: 1, code }
    }
}

const SQUARE_ROOT: Opcode = Opcode::plain(0x51);
const COMPARE: Opcode = Opcode::plain(0xc2);
const SHIFT: Opcode = Opcode::plain(0x73);
const LOAD: Opcode = Opcode::plain(0x10);
const STORE: Opcode = Opcode::plain(0x11);
/// Past the caches, to an address that is a multiple of the register's length.
const STREAM: Opcode = Opcode::plain(0x2b);
/// By the highest bits of a register; four lanes alone.
const SELECT: Opcode = Opcode { map: 3, prefix: 1, code: 0x4b };
/// By a mask; eight lanes alone, as all that follow.
const BLEND: Opcode = Opcode { map: 2, prefix: 1, code: 0x65 };
const SPREAD: Opcode = Opcode { map: 2, prefix: 1, code: 0x19 };
const HIGHEST_BITS: Opcode = Opcode { map: 2, prefix: 2, code: 0x39 };
const FROM_MASK: Opcode = Opcode { map: 2, prefix: 2, code: 0x38 };
/// The one mask register in use; 0 would mean that there is none.
const MASK: u8 = 1;
/// What is compared: whether one of two is NaN.
const UNORDERED: u8 = 3;

/// Machine code as it grows.
#[derive(Debug)]
pub(super) struct Code {
    pub(super) bytes: Vec<u8>,
    vectors: Vectors,
}

impl Code {
    pub(super) fn new(vectors: Vectors) -> Code {
        Code { bytes: Vec::new(), vectors }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// All lanes; `first` is the register operand that the prefix holds.
    fn vector(&mut self, opcode: Opcode, to: u8, first: u8, second: Operand) {
        match self.vectors {
            Vectors::Four => self.vex(opcode, to, first, second),
            Vectors::Eight => self.evex(opcode, 0, to, first, second),
        }
    }

    fn vex(&mut self, opcode: Opcode, to: u8, first: u8, second: Operand) {
        let is_high = match second {
            Operand::Register(register) => register >= 8,
            Operand::Memory(place) => number(place.base) >= 8,
        };
        let length_and_prefix = (!first & 15) << 3 | 1 << 2 | opcode.prefix;
        if opcode.map == 1 && !is_high {
            self.bytes(&[0xc5, inverted(to >= 8, 7) | length_and_prefix, opcode.code]);
        } else {
            let map = inverted(to >= 8, 7) | 1 << 6 | inverted(is_high, 5) | opcode.map;
            self.bytes(&[0xc4, map, length_and_prefix, opcode.code]);
        }
        self.operands(to, second, 1);
    }

    /// Eight lanes; a number of the scalars is read into all of them. `mask` is a mask register, or 0.
    fn evex(&mut self, opcode: Opcode, mask: u8, to: u8, first: u8, second: Operand) {
        let bit = |register: u8, k: u8| register >> k & 1 == 1;
        let (fourth, fifth, is_spread) = match second {
            Operand::Register(register) => (bit(register, 3), bit(register, 4), false),
            Operand::Memory(place) => (bit(number(place.base), 3), false, place.base == Base::Scalars),
        };
        let high = inverted(bit(to, 3), 7) | inverted(fifth, 6) | inverted(fourth, 5) | inverted(bit(to, 4), 4);
        let wide = 1 << 7 | (!first & 15) << 3 | 1 << 2 | opcode.prefix;
        // what spreads a number by itself needs no bit for it
        let spreads = u8::from(is_spread && opcode.code != SPREAD.code) << 4;
        let last = 2 << 5 | spreads | inverted(bit(first, 4), 3) | mask;
        self.bytes(&[0x62, high | opcode.map, wide, last, opcode.code]);
        self.operands(to, second, if is_spread { 8 } else { 64 });
    }

    /// `unit` is what small offsets are counted in.
    fn operands(&mut self, to: u8, second: Operand, unit: i32) {
        let middle = (to & 7) << 3;
        match second {
            Operand::Register(register) => self.bytes(&[0b1100_0000 | middle | register & 7]),
            Operand::Memory(place) => {
                let base = number(place.base) & 7;
                match i8::try_from(place.offset / unit) {
                    Ok(offset) if place.offset % unit == 0 => {
                        self.bytes(&[0b0100_0000 | middle | base, offset as u8]);
                    }
                    _ => {
                        self.bytes(&[0b1000_0000 | middle | base]);
                        self.bytes(&place.offset.to_le_bytes());
                    }
                }
            }
        }
    }

    pub(super) fn packed(&mut self, op: Packed, to: Register, a: Register, b: Operand) {
        self.vector(Opcode::plain(op as u8), to, a, b);
    }

    pub(super) fn square_root(&mut self, to: Register, a: Operand) {
        self.vector(SQUARE_ROOT, to, 0, a);
    }

    /// All bits of a lane where one of the two is NaN.
    pub(super) fn unordered(&mut self, to: Register, a: Register, b: Operand) {
        match self.vectors {
            Vectors::Four => {
                self.vex(COMPARE, to, a, b);
                self.bytes(&[UNORDERED]);
            }
            Vectors::Eight => {
                self.evex(COMPARE, 0, MASK, a, b);
                self.bytes(&[UNORDERED]);
                self.evex(FROM_MASK, 0, to, 0, Operand::Register(MASK));
            }
        }
    }

    /// The bits of each lane, moved up.
    pub(super) fn shift(&mut self, to: Register, a: Register, by: u8) {
        // the destination is in the prefix, 6 is a part of the opcode
        self.vector(SHIFT, 6, to, Operand::Register(a));
        self.bytes(&[by]);
    }

    /// `set` where the highest bit of the mask is set, else `clear`.
    pub(super) fn select(&mut self, to: Register, mask: Register, set: Register, clear: Register) {
        match self.vectors {
            Vectors::Four => {
                self.vex(SELECT, to, clear, Operand::Register(set));
                self.bytes(&[mask << 4]);
            }
            Vectors::Eight => {
                self.evex(HIGHEST_BITS, 0, MASK, 0, Operand::Register(mask));
                self.evex(BLEND, MASK, to, clear, Operand::Register(set));
            }
        }
    }

    pub(super) fn load(&mut self, to: Register, from: Place) {
        let is_spread = self.vectors == Vectors::Eight && from.base == Base::Scalars;
        self.vector(if is_spread { SPREAD } else { LOAD }, to, 0, Operand::Memory(from));
    }

    pub(super) fn store(&mut self, to: Place, from: Register) {
        self.vector(STORE, from, 0, Operand::Memory(to));
    }

    pub(super) fn stream(&mut self, to: Place, from: Register) {
        self.vector(STREAM, from, 0, Operand::Memory(to));
    }

    /// Saves what a function has to preserve and keeps its five arguments (System V). Calls find the stack at a multiple of 16.
    pub(super) fn prologue(&mut self) {
        self.bytes(&[0x53, 0x55, 0x41, 0x55, 0x41, 0x56, 0x41, 0x57]); // push rbx, rbp, r13, r14, r15
        self.bytes(&[0x48, 0x89, 0xfb]); // mov rbx, rdi
        self.bytes(&[0x48, 0x89, 0xf5]); // mov rbp, rsi
        self.bytes(&[0x49, 0x89, 0xd5]); // mov r13, rdx
        self.bytes(&[0x49, 0x89, 0xcf]); // mov r15, rcx
        self.bytes(&[0x4d, 0x89, 0xc6]); // mov r14, r8
    }

    /// Back to `start` for the next lanes as long as there are some, then back to the caller.
    pub(super) fn epilogue(&mut self, start: usize) {
        let bytes = 8 * self.vectors.lanes() as u8;
        self.bytes(&[0x48, 0x83, 0xc3, bytes]); // add rbx, …
        self.bytes(&[0x49, 0x83, 0xc7, bytes]); // add r15, …
        self.bytes(&[0x49, 0xff, 0xce]); // dec r14
        let back = start as i64 - (self.bytes.len() as i64 + 6);
        self.bytes(&[0x0f, 0x85]); // jnz
        self.bytes(&(back as i32).to_le_bytes());
        self.bytes(&[0xc5, 0xf8, 0x77]); // vzeroupper
        self.bytes(&[0x41, 0x5f, 0x41, 0x5e, 0x41, 0x5d, 0x5d, 0x5b, 0xc3]); // pop r15, r14, r13, rbp, rbx; ret
    }

    /// Calls a function with one number and the scratch memory as its arguments. No vector register survives.
    pub(super) fn call(&mut self, function: usize, argument: usize) {
        self.bytes(&[0xc5, 0xf8, 0x77]); // vzeroupper
        self.bytes(&[0x48, 0xbf]); // mov rdi, …
        self.bytes(&(argument as u64).to_le_bytes());
        self.bytes(&[0x4c, 0x89, 0xee]); // mov rsi, r13
        self.bytes(&[0x48, 0xb8]); // mov rax, …
        self.bytes(&(function as u64).to_le_bytes());
        self.bytes(&[0xff, 0xd0]); // call rax
    }
}

/// A bit that says no when it is set.
fn inverted(set: bool, bit: u8) -> u8 {
    if set { 0 } else { 1 << bit }
}

fn number(base: Base) -> u8 {
    match base {
        Base::Blocks => RBX,
        Base::Scalars => RBP,
        Base::Scratch => R13,
        Base::Outputs => R15,
    }
}
