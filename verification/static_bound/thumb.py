"""ARMv6-M Thumb instructions as records: what each reads, writes and where it leads (DDI0419 A5, A6.7)."""

from dataclasses import dataclass

from records.errors import VerificationFailed

SP, LR, PC = 13, 14, 15
CONDITIONS = ("eq", "ne", "hs", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le")
TWO_REGISTER_OPS = (
    "ands", "eors", "lsls", "lsrs", "asrs", "adcs", "sbcs", "rors",
    "tst", "rsbs", "cmp", "cmn", "orrs", "muls", "bics", "mvns",
)  # fmt: skip
REGISTER_OFFSET_OPS = ("str", "strh", "strb", "ldrsb", "ldr", "ldrh", "ldrb", "ldrsh")
IMMEDIATE_OFFSET_OPS = {0x6: ("str", "ldr", 4), 0x7: ("strb", "ldrb", 1), 0x8: ("strh", "ldrh", 2)}
LOADS = frozenset({"ldr", "ldrh", "ldrb", "ldrsh", "ldrsb"})
STORES = frozenset({"str", "strh", "strb"})


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction: `d`, `n`, `m` are register numbers (-1: none), `imm` its immediate operand, `target` an absolute address."""

    address: int
    size: int
    op: str
    d: int = -1
    n: int = -1
    m: int = -1
    imm: int = 0
    registers: tuple[int, ...] = ()
    condition: str = ""
    target: int = 0

    @property
    def next_address(self) -> int:
        """Address behind this instruction."""
        return self.address + self.size


def decode(first: int, second: int, address: int) -> Instruction:
    """Decode the halfword `first` at `address`; `second` is the one behind it. Raises VerificationFailed where it is undefined."""
    if first >> 11 == 0b11110:
        return _long(first, second, address)
    found = _by_top_bits(first, address)
    if found is None:
        raise VerificationFailed(f"0x{address:08x}: halfword 0x{first:04x} is no ARMv6-M instruction")
    return found


def _by_top_bits(code: int, at: int) -> Instruction | None:
    top = code >> 12
    low, middle, high, imm8 = code & 7, code >> 3 & 7, code >> 8 & 7, code & 0xFF
    if top <= 1:
        return _shift_or_add(code, at)
    if top <= 3:
        op = ("movs", "cmp", "adds", "subs")[code >> 11 & 3]
        return Instruction(at, 2, op, d=high, n=-1 if op == "movs" else high, imm=imm8)
    if top == 4:
        return _data_processing(code, at)
    if top == 5:
        return Instruction(at, 2, REGISTER_OFFSET_OPS[code >> 9 & 7], d=low, n=middle, m=code >> 6 & 7)
    if top <= 8:
        store, load, size = IMMEDIATE_OFFSET_OPS[top]
        return Instruction(at, 2, load if code >> 11 & 1 else store, d=low, n=middle, imm=size * (code >> 6 & 31))
    if top == 9:
        return Instruction(at, 2, "ldr" if code >> 11 & 1 else "str", d=high, n=SP, imm=4 * imm8)
    if top == 10:
        if code >> 11 & 1:
            return Instruction(at, 2, "add_sp_to", d=high, imm=4 * imm8)
        return Instruction(at, 2, "adr", d=high, imm=((at + 4) & ~3) + 4 * imm8)
    return _miscellaneous(code, at) if top == 11 else _multiple_or_branch(code, at)


def _shift_or_add(code: int, at: int) -> Instruction:
    low, middle, third, kind = code & 7, code >> 3 & 7, code >> 6 & 7, code >> 11 & 3
    if kind < 3:
        amount = code >> 6 & 31
        if kind == 0 and amount == 0:
            return Instruction(at, 2, "movs", d=low, m=middle)
        return Instruction(at, 2, ("lsls", "lsrs", "asrs")[kind], d=low, n=middle, imm=amount or 32)
    op = "subs" if code >> 9 & 1 else "adds"
    if code >> 10 & 1:
        return Instruction(at, 2, op, d=low, n=middle, imm=third)
    return Instruction(at, 2, op, d=low, n=middle, m=third)


def _data_processing(code: int, at: int) -> Instruction | None:
    low, middle = code & 7, code >> 3 & 7
    if code >> 11 & 1:
        return Instruction(at, 2, "ldr_literal", d=code >> 8 & 7, imm=((at + 4) & ~3) + 4 * (code & 0xFF))
    if not code >> 10 & 1:
        op = TWO_REGISTER_OPS[code >> 6 & 15]
        return Instruction(at, 2, op, d=low, n=low, m=middle)
    d, m = low | code >> 4 & 8, code >> 3 & 15
    match code >> 8 & 3:
        case 0:
            return Instruction(at, 2, "add_pc" if d == PC else "add_high", d=d, n=d, m=m)
        case 1:
            return Instruction(at, 2, "cmp", d=d, n=d, m=m)
        case 2:
            return Instruction(at, 2, "mov_pc" if d == PC else "mov", d=d, m=m)
        case _:
            return None if m == PC else Instruction(at, 2, "blx" if code >> 7 & 1 else "bx", m=m)


def _miscellaneous(code: int, at: int) -> Instruction | None:
    low, middle, pair = code & 7, code >> 3 & 7, code >> 6 & 3
    listed = tuple(r for r in range(8) if code >> r & 1)
    match code >> 8 & 15:
        case 0:
            return Instruction(at, 2, "add_sp", imm=4 * (code & 0x7F) * (-1 if code >> 7 & 1 else 1))
        case 2:
            return Instruction(at, 2, ("sxth", "sxtb", "uxth", "uxtb")[pair], d=low, m=middle)
        case 4 | 5:
            return Instruction(at, 2, "push", registers=listed + ((LR,) if code >> 8 & 1 else ()))
        case 6 if code & 0xFFEF == 0xB662:
            return Instruction(at, 2, "cps")
        case 10 if pair != 2:
            return Instruction(at, 2, ("rev", "rev16", "", "revsh")[pair], d=low, m=middle)
        case 12 | 13:
            return Instruction(at, 2, "pop", registers=listed + ((PC,) if code >> 8 & 1 else ()))
        case 14:
            return Instruction(at, 2, "bkpt", imm=code & 0xFF)
        case 15 if code & 15 == 0:
            return Instruction(at, 2, {0x20: "wfe", 0x30: "wfi"}.get(code & 0xFF, "nop"))
        case _:
            return None


def _multiple_or_branch(code: int, at: int) -> Instruction | None:
    top, condition = code >> 12, code >> 8 & 15
    if top == 12:
        listed = tuple(r for r in range(8) if code >> r & 1)
        return Instruction(at, 2, "ldm" if code >> 11 & 1 else "stm", n=code >> 8 & 7, registers=listed)
    if top == 13 and condition < 14:
        target = at + 4 + 2 * _signed(code & 0xFF, 8)
        return Instruction(at, 2, "b_if", condition=CONDITIONS[condition], target=target)
    if top == 13 and condition == 15:
        return Instruction(at, 2, "svc", imm=code & 0xFF)
    if top == 14 and not code >> 11 & 1:
        return Instruction(at, 2, "b", target=at + 4 + 2 * _signed(code & 0x7FF, 11))
    return None


def _long(first: int, second: int, at: int) -> Instruction:
    if second & 0xD000 == 0xD000:
        s = first >> 10 & 1
        i1, i2 = 1 ^ second >> 13 & 1 ^ s, 1 ^ second >> 11 & 1 ^ s
        offset = s << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1
        return Instruction(at, 4, "bl", target=at + 4 + _signed(offset, 25))
    if first & 0xFFF0 == 0xF380 and second & 0xFF00 == 0x8800:
        return Instruction(at, 4, "msr", n=first & 15, imm=second & 0xFF)
    if first == 0xF3EF and second & 0xF000 == 0x8000:
        return Instruction(at, 4, "mrs", d=second >> 8 & 15, imm=second & 0xFF)
    if first == 0xF3BF and second & 0xFFF0 in (0x8F40, 0x8F50, 0x8F60):
        return Instruction(at, 4, "barrier")
    raise VerificationFailed(f"0x{at:08x}: 0x{first:04x} 0x{second:04x} is no ARMv6-M instruction")


def _signed(value: int, bits: int) -> int:
    return value - (1 << bits) if value >> (bits - 1) else value
