//! Instructions of a Cortex-M, as capstone decodes them: where they go on, and what they do to the
//! stack pointer.

use capstone::arch::arm::{
    ArchExtraMode, ArchMode, ArmCC, ArmInsn, ArmInsnDetail, ArmOperandType, ArmReg,
};
use capstone::prelude::*;
use capstone::{Capstone, Insn, RegId};

/// Where a program goes on after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// At the next instruction.
    Next,
    /// At an address.
    Jump(u32),
    /// At an address or at the next instruction.
    Branch(u32),
    /// In a function, and then at the next instruction.
    Call(u32),
    /// In a function whose address is in a register, and then at the next instruction.
    IndirectCall,
    /// At one of the places of the table behind the instruction. Its entries have so many bytes.
    Table(u32),
    /// In the caller. It goes on with the next instruction if it `may_stay`.
    Return {
        /// Whether the instruction is conditional.
        may_stay: bool,
    },
    /// Nowhere.
    Nowhere,
}

/// An instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Its length, bytes.
    pub length: u32,
    /// Number of the instructions behind it that it makes conditional (IT).
    pub conditional: usize,
    /// Where the program goes on.
    pub flow: Flow,
    /// By how much the stack grows, bytes; `None` if that is not a constant.
    pub stack_growth: Option<i32>,
    /// Half of an address that it loads into a register.
    pub half: Option<Half>,
    /// The registers that it writes.
    pub writes: Vec<u16>,
    /// A register and the constant that it writes to it.
    pub constant: Option<(u16, u32)>,
    /// Its words in assembly, for messages.
    pub words: String,
}

/// Half of a constant of 32 bits in a register: MOVW and MOVT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Half {
    /// Number of the register.
    pub register: u16,
    /// The 16 bits.
    pub bits: u32,
    /// Whether they are the upper ones.
    pub is_upper: bool,
}

/// A decoder of Thumb instructions.
pub struct Decoder(Capstone);

const WORD: i32 = 4;
/// Registers of VPUSH and VPOP are double words.
const DOUBLE_WORD: i32 = 8;

impl Decoder {
    /// Creates it.
    ///
    /// # Errors
    /// capstone cannot be set up.
    pub fn new() -> Result<Self, String> {
        let builder = Capstone::new().arm().mode(ArchMode::Thumb);
        let builder = builder.extra_mode([ArchExtraMode::MClass].into_iter());
        let capstone = builder.detail(true).build();
        capstone.map(Self).map_err(|error| error.to_string())
    }

    /// Decodes the first instruction of `code`, which lies at `address`. `is_conditional` is whether an
    /// IT instruction before it makes it one.
    ///
    /// # Errors
    /// It is no instruction of a Cortex-M.
    pub fn read(
        &self,
        code: &[u8],
        address: u32,
        is_conditional: bool,
    ) -> Result<Instruction, String> {
        let problem = |why: String| format!("{address:#x}: {why}");
        let read = self.0.disasm_count(code, u64::from(address), 1);
        let read = read.map_err(|error| problem(error.to_string()))?;
        let instruction = read
            .iter()
            .next()
            .ok_or_else(|| problem("not an instruction".to_owned()))?;
        let detail = self.0.insn_detail(instruction);
        let detail = detail.map_err(|error| problem(error.to_string()))?;
        let writes = |register| detail.regs_write().contains(&RegId(register as u16));
        let arch = detail.arch_detail();
        let arm = arch.arm().ok_or_else(|| problem("no details".to_owned()))?;
        let mut parts = Parts::of(instruction, arm);
        parts.is_conditional |= is_conditional;
        let flow = parts
            .flow(writes(ArmReg::ARM_REG_PC))
            .ok_or_else(|| problem(format!("unknown jump: {}", parts.words)))?;
        Ok(Instruction {
            length: instruction.bytes().len() as u32,
            conditional: parts.conditional(),
            flow,
            stack_growth: parts.stack_growth(writes(ArmReg::ARM_REG_SP)),
            half: parts.half(),
            writes: detail
                .regs_write()
                .iter()
                .map(|register| register.0)
                .collect(),
            constant: parts.register_constant(),
            words: parts.words,
        })
    }
}

/// What counts of an instruction.
struct Parts {
    id: u32,
    operands: Vec<ArmOperandType>,
    is_conditional: bool,
    words: String,
}

impl Parts {
    fn of(instruction: &Insn<'_>, arm: &ArmInsnDetail<'_>) -> Self {
        let text = |part: Option<&str>| part.unwrap_or_default().to_owned();
        Self {
            id: instruction.id().0,
            operands: arm.operands().map(|operand| operand.op_type).collect(),
            is_conditional: !matches!(arm.cc(), ArmCC::ARM_CC_AL | ArmCC::ARM_CC_INVALID),
            words: text(instruction.mnemonic()) + " " + &text(instruction.op_str()),
        }
    }

    fn is(&self, ids: &[ArmInsn]) -> bool {
        ids.iter().any(|id| *id as u32 == self.id)
    }

    /// Returns the constant among the operands, if there is only one.
    fn constant(&self) -> Option<i32> {
        let constants = self.operands.iter().filter_map(|operand| match operand {
            ArmOperandType::Imm(constant) => Some(*constant),
            _ => None,
        });
        let constants: Vec<i32> = constants.collect();
        <[i32; 1]>::try_from(constants).ok().map(|[only]| only)
    }

    fn register(&self, place: usize) -> Option<u32> {
        match self.operands.get(place)? {
            ArmOperandType::Reg(register) => Some(u32::from(register.0)),
            _ => None,
        }
    }

    fn flow(&self, writes_pc: bool) -> Option<Flow> {
        use ArmInsn::*;
        let target = self.constant().map(|address| address as u32);
        let returns = Flow::Return {
            may_stay: self.is_conditional,
        };
        Some(match () {
            () if self.is(&[ARM_INS_CBZ, ARM_INS_CBNZ]) => Flow::Branch(target?),
            () if self.is(&[ARM_INS_B]) && self.is_conditional => Flow::Branch(target?),
            () if self.is(&[ARM_INS_B]) => Flow::Jump(target?),
            () if self.is(&[ARM_INS_BL]) => Flow::Call(target?),
            () if self.is(&[ARM_INS_BLX]) => Flow::IndirectCall,
            () if self.is(&[ARM_INS_TBB]) => Flow::Table(1),
            () if self.is(&[ARM_INS_TBH]) => Flow::Table(2),
            () if self.is(&[ARM_INS_UDF, ARM_INS_TRAP, ARM_INS_BKPT]) => Flow::Nowhere,
            () if self.is(&[ARM_INS_BX]) && self.register(0) == Some(ArmReg::ARM_REG_LR) => returns,
            // LDMIA with the stack pointer, too, has this name.
            () if self.is(&[ARM_INS_POP]) && writes_pc => returns,
            () if self.is(&[ARM_INS_BX]) || writes_pc => return None,
            () => Flow::Next,
        })
    }

    fn stack_growth(&self, writes_sp: bool) -> Option<i32> {
        use ArmInsn::*;
        let registers = self.operands.len() as i32;
        match () {
            () if self.is(&[ARM_INS_PUSH]) => Some(WORD * registers),
            () if self.is(&[ARM_INS_POP]) => Some(-WORD * registers),
            () if self.is(&[ARM_INS_VPUSH]) => Some(DOUBLE_WORD * registers),
            () if self.is(&[ARM_INS_VPOP]) => Some(-DOUBLE_WORD * registers),
            () if !writes_sp => Some(0),
            // By a constant only. A conditional one grows it in one of two ways.
            () if self.is_conditional => None,
            () if self.is(&[ARM_INS_SUB, ARM_INS_SUBW]) && self.only_sp() => self.constant(),
            () if self.is(&[ARM_INS_ADD, ARM_INS_ADDW]) && self.only_sp() => {
                self.constant().map(|bytes| -bytes)
            }
            // `str r, [sp, #-4]!` and `ldr r, [sp], #4` stand for PUSH and POP of one register.
            () if self.is(&[ARM_INS_STR]) => {
                self.displacement().filter(|of| *of == -WORD).map(|_| WORD)
            }
            () if self.is(&[ARM_INS_LDR]) && self.words.ends_with("[sp], #4") => Some(-WORD),
            () => None,
        }
    }

    /// Returns whether no other register than the stack pointer is an operand.
    fn only_sp(&self) -> bool {
        self.operands.iter().all(|operand| match operand {
            ArmOperandType::Reg(register) => u32::from(register.0) == ArmReg::ARM_REG_SP,
            ArmOperandType::Imm(_) => true,
            _ => false,
        })
    }

    fn displacement(&self) -> Option<i32> {
        self.operands.iter().find_map(|operand| match operand {
            ArmOperandType::Mem(place) => Some(place.disp()),
            _ => None,
        })
    }

    /// IT is followed by one letter for each instruction but the first.
    fn conditional(&self) -> usize {
        let name = self.words.split(' ').next().unwrap_or_default();
        if self.is(&[ArmInsn::ARM_INS_IT]) {
            name.len() - 1
        } else {
            0
        }
    }

    fn register_constant(&self) -> Option<(u16, u32)> {
        use ArmInsn::*;
        let moves = self.is(&[ARM_INS_MOV, ARM_INS_MOVS, ARM_INS_MOVW]) && !self.is_conditional;
        let [ArmOperandType::Reg(register), ArmOperandType::Imm(constant)] = &*self.operands else {
            return None;
        };
        moves.then_some((register.0, *constant as u32))
    }

    fn half(&self) -> Option<Half> {
        let is_upper = self.is(&[ArmInsn::ARM_INS_MOVT]);
        if !is_upper && !self.is(&[ArmInsn::ARM_INS_MOVW]) {
            return None;
        }
        Some(Half {
            register: self.register(0)? as u16,
            bits: self.constant()? as u32 & 0xffff,
            is_upper,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(code: &[u8]) -> Instruction {
        Decoder::new().unwrap().read(code, 0x1000, false).unwrap()
    }

    #[test]
    fn what_moves_the_stack_pointer_is_known() {
        let growth = |code: &[u8]| read(code).stack_growth;
        assert_eq!(growth(&[0xf0, 0xb5]), Some(20), "push {{r4-r7, lr}}");
        assert_eq!(
            growth(&[0x2d, 0xe9, 0x00, 0x0f]),
            Some(16),
            "push.w {{r8-r11}}"
        );
        assert_eq!(
            growth(&[0x2d, 0xed, 0x04, 0x8b]),
            Some(16),
            "vpush {{d8, d9}}"
        );
        assert_eq!(
            growth(&[0x4d, 0xf8, 0x04, 0xbd]),
            Some(4),
            "str r11, [sp, #-4]!"
        );
        assert_eq!(growth(&[0x84, 0xb0]), Some(16), "sub sp, #16");
        assert_eq!(
            growth(&[0xad, 0xf5, 0x04, 0x7d]),
            Some(528),
            "sub.w sp, sp, #528"
        );
        assert_eq!(growth(&[0x04, 0xb0]), Some(-16), "add sp, #16");
        assert_eq!(
            growth(&[0x5d, 0xf8, 0x04, 0xbb]),
            Some(-4),
            "ldr r11, [sp], #4"
        );
        assert_eq!(growth(&[0x00, 0xbf]), Some(0), "nop");
        // A place on the stack that is known only at run time.
        assert_eq!(growth(&[0x85, 0x46]), None, "mov sp, r0");
    }

    #[test]
    fn where_a_program_goes_on_is_known() {
        let flow = |code: &[u8]| read(code).flow;
        assert_eq!(flow(&[0x00, 0xe0]), Flow::Jump(0x1004), "b");
        assert_eq!(flow(&[0x00, 0xd0]), Flow::Branch(0x1004), "beq");
        assert_eq!(flow(&[0x08, 0xb1]), Flow::Branch(0x1006), "cbz");
        assert_eq!(flow(&[0x00, 0xf0, 0x02, 0xf8]), Flow::Call(0x1008), "bl");
        assert_eq!(flow(&[0x98, 0x47]), Flow::IndirectCall, "blx r3");
        assert_eq!(flow(&[0xdf, 0xe8, 0x00, 0xf0]), Flow::Table(1), "tbb");
        let returns = Flow::Return { may_stay: false };
        assert_eq!(flow(&[0x70, 0x47]), returns, "bx lr");
        assert_eq!(flow(&[0xf0, 0xbd]), returns, "pop {{r4-r7, pc}}");
        assert_eq!(flow(&[0xfe, 0xde]), Flow::Nowhere, "udf");
    }

    #[test]
    fn what_follows_it_is_conditional() {
        assert_eq!(read(&[0x08, 0xbf]).conditional, 1, "it eq");
        assert_eq!(read(&[0x1e, 0xbf]).conditional, 3, "ittt ne");
        assert_eq!(read(&[0x00, 0xbf]).conditional, 0, "nop");
        // Decoded alone it looks like a return for good.
        let decoder = Decoder::new().unwrap();
        let returns = decoder.read(&[0x70, 0x47], 0x1000, true).unwrap();
        assert_eq!(returns.flow, Flow::Return { may_stay: true }, "bxeq lr");
    }

    #[test]
    fn a_jump_that_is_not_understood_is_an_error() {
        let problem = Decoder::new().unwrap().read(&[0x18, 0x47], 0x1000, false);
        assert_eq!(problem.unwrap_err(), "0x1000: unknown jump: bx r3");
    }
}
