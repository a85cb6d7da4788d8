//! The bytes of the few x86-64 instructions that tapes need (Intel SDM, volume 2: VEX prefix and ModRM).

/// A vector register of four lanes, 0 to 15.
pub(super) type Ymm = u8;

/// General registers by number.
const RBX: u8 = 3;
const RBP: u8 = 5;
const R13: u8 = 13;

/// Where a function's arguments stay while it runs: registers that calls preserve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Base {
    /// The lanes at work of block number zero.
    Blocks,
    Scalars,
    Scratch,
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
    Register(Ymm),
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

const SQUARE_ROOT: u8 = 0x51;
const COMPARE: u8 = 0xc2;
const SHIFT: u8 = 0x73;
const LOAD: u8 = 0x10;
const STORE: u8 = 0x11;
const SELECT: u8 = 0x4b;

/// Opcode maps by their number in the prefix.
const MAP_0F: u8 = 1;
const MAP_0F3A: u8 = 3;

/// Machine code as it grows.
#[derive(Debug, Default)]
pub(super) struct Code(pub(super) Vec<u8>);

impl Code {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// Four lanes, prefix 66; `first` is the register operand that the prefix holds.
    fn vector(&mut self, map: u8, opcode: u8, to: u8, first: u8, second: Operand) {
        let is_high = match second {
            Operand::Register(register) => register >= 8,
            Operand::Memory(place) => number(place.base) >= 8,
        };
        let inverted = |set: bool, bit: u8| if set { 0 } else { 1 << bit };
        let length_and_prefix = (!first & 15) << 3 | 0b101;
        if map == MAP_0F && !is_high {
            self.bytes(&[0xc5, inverted(to >= 8, 7) | length_and_prefix, opcode]);
        } else {
            let map = inverted(to >= 8, 7) | 1 << 6 | inverted(is_high, 5) | map;
            self.bytes(&[0xc4, map, length_and_prefix, opcode]);
        }
        let middle = (to & 7) << 3;
        match second {
            Operand::Register(register) => self.bytes(&[0b1100_0000 | middle | register & 7]),
            Operand::Memory(place) => {
                let base = number(place.base) & 7;
                match i8::try_from(place.offset) {
                    Ok(offset) => self.bytes(&[0b0100_0000 | middle | base, offset as u8]),
                    Err(_) => {
                        self.bytes(&[0b1000_0000 | middle | base]);
                        self.bytes(&place.offset.to_le_bytes());
                    }
                }
            }
        }
    }

    pub(super) fn packed(&mut self, op: Packed, to: Ymm, a: Ymm, b: Operand) {
        self.vector(MAP_0F, op as u8, to, a, b);
    }

    pub(super) fn square_root(&mut self, to: Ymm, a: Operand) {
        self.vector(MAP_0F, SQUARE_ROOT, to, 0, a);
    }

    /// All bits of a lane where one of the two is NaN.
    pub(super) fn unordered(&mut self, to: Ymm, a: Ymm, b: Operand) {
        self.vector(MAP_0F, COMPARE, to, a, b);
        self.bytes(&[3]);
    }

    /// The bits of each lane, moved up.
    pub(super) fn shift(&mut self, to: Ymm, a: Ymm, by: u8) {
        // the destination is in the prefix, 6 is a part of the opcode
        self.vector(MAP_0F, SHIFT, 6, to, Operand::Register(a));
        self.bytes(&[by]);
    }

    /// `set` where the highest bit of the mask is set, else `clear`.
    pub(super) fn select(&mut self, to: Ymm, mask: Ymm, set: Ymm, clear: Ymm) {
        self.vector(MAP_0F3A, SELECT, to, clear, Operand::Register(set));
        self.bytes(&[mask << 4]);
    }

    pub(super) fn load(&mut self, to: Ymm, from: Place) {
        self.vector(MAP_0F, LOAD, to, 0, Operand::Memory(from));
    }

    pub(super) fn store(&mut self, to: Place, from: Ymm) {
        self.vector(MAP_0F, STORE, from, 0, Operand::Memory(to));
    }

    /// Saves what a function has to preserve and keeps its four arguments (System V).
    pub(super) fn prologue(&mut self) {
        self.bytes(&[0x53, 0x55, 0x41, 0x55, 0x41, 0x56]); // push rbx, rbp, r13, r14
        self.bytes(&[0x48, 0x83, 0xec, 8]); // sub rsp, 8: calls find the stack at a multiple of 16
        self.bytes(&[0x48, 0x89, 0xfb]); // mov rbx, rdi
        self.bytes(&[0x48, 0x89, 0xf5]); // mov rbp, rsi
        self.bytes(&[0x49, 0x89, 0xd5]); // mov r13, rdx
        self.bytes(&[0x49, 0x89, 0xce]); // mov r14, rcx
    }

    /// Back to `start` for the next four lanes as long as there are some, then back to the caller.
    pub(super) fn epilogue(&mut self, start: usize) {
        self.bytes(&[0x48, 0x83, 0xc3, 32]); // add rbx, 32
        self.bytes(&[0x49, 0xff, 0xce]); // dec r14
        let back = start as i64 - (self.0.len() as i64 + 6);
        self.bytes(&[0x0f, 0x85]); // jnz
        self.bytes(&(back as i32).to_le_bytes());
        self.bytes(&[0xc5, 0xf8, 0x77]); // vzeroupper
        self.bytes(&[0x48, 0x83, 0xc4, 8]); // add rsp, 8
        self.bytes(&[0x41, 0x5e, 0x41, 0x5d, 0x5d, 0x5b, 0xc3]); // pop r14, r13, rbp, rbx; ret
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

fn number(base: Base) -> u8 {
    match base {
        Base::Blocks => RBX,
        Base::Scalars => RBP,
        Base::Scratch => R13,
    }
}
