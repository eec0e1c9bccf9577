"""What one instruction does to a state (DDI0419 A6.7). Branches and calls are not here."""

from collections.abc import Callable

from verification.static_bound import words
from verification.static_bound.elf_image import ElfImage
from verification.static_bound.liveness import FLAG_WRITERS, effects, slot, written_register
from verification.static_bound.relation import SAME, Relation
from verification.static_bound.state import NOWHERE, Derive, Flags, State
from verification.static_bound.thumb import LOADS, PC, SP, STORES, Instruction
from verification.static_bound.words import MASK, TOP, Word

MOST_ADDRESSES = 256  # a table that is read at more places than this is not looked up
MOST_VALUES = 32  # nor is one that gives more different words
MOST_SHIFTS = 40

LOGIC: dict[str, Callable[[Word, Word], Word]] = {
    "ands": words.bit_and,
    "tst": words.bit_and,
    "eors": words.bit_xor,
    "orrs": words.bit_or,
    "bics": lambda a, b: words.bit_and(a, words.invert(b)),
    "mvns": lambda a, b: words.invert(b),
    "muls": words.multiply,
    "movs": lambda a, b: b,
}
SHIFTS = {"lsls": words.shift_left, "lsrs": words.shift_right, "asrs": words.shift_right_signed}


def step(state: State, i: Instruction, sp: int, image: ElfImage, frame_escapes: bool) -> list[State]:
    """States behind the instruction: one, or one for each word that a table in flash may have given."""
    if i.op == "ldr" and i.n == SP:
        place = slot(sp + i.imm)
        return [state.with_derived(i.d, place, _copied, state.at(place))]
    if i.op in LOADS or i.op == "ldr_literal":
        return [state.with_value(i.d, word) for word in loaded(state, i, image)]
    if i.op in STORES:
        return [_stored(state, i, sp, frame_escapes)]
    if i.op in ("push", "pop"):
        return [_moved_block(state, i, sp)]
    if i.op in FLAG_WRITERS:
        return [_computed(state, i)]
    return [_without_flags(state, i, sp, frame_escapes)]


def operand(state: State, register: int, i: Instruction) -> Word:
    """Value of a register as the instruction reads it."""
    if register == PC:
        return words.constant(i.address + 4)
    return state.at(register) if 0 <= register < SP else TOP


def second_operand(state: State, i: Instruction) -> Word:
    """Value of register m, or the immediate operand where there is no m."""
    return operand(state, i.m, i) if i.m >= 0 else words.constant(i.imm)


def data_address(state: State, i: Instruction) -> Word:
    """Where a load with a base register reads."""
    return words.add(operand(state, i.n, i), second_operand(state, i))


def loaded(state: State, i: Instruction, image: ElfImage) -> list[Word]:
    """The words that a load may give, as few sets as its address allows."""
    if i.op == "ldr_literal":
        return [words.constant(image.read(i.imm, 4) or 0)]
    size = {"ldr": 4, "ldrh": 2, "ldrsh": 2}.get(i.op, 1)
    places = data_address(state, i).members(MOST_ADDRESSES)
    contents = {image.read(place, size) for place in places if place % size == 0} if places else {None}
    signed = i.op in ("ldrsh", "ldrsb")
    if None in contents or not 0 < len(contents) <= MOST_VALUES:
        half = 1 << (8 * size - 1)
        return [TOP if size == 4 else words.interval(-half, half - 1) if signed else words.interval(0, 2 * half - 1)]
    values = sorted(value for value in contents if value is not None)
    return [words.constant(value - (value >> (8 * size - 1) << (8 * size)) if signed else value) for value in values]


def _stored(state: State, i: Instruction, sp: int, frame_escapes: bool) -> State:
    if i.n == SP:
        return state.with_derived(slot(sp + i.imm), i.d, _copied, state.at(i.d))
    return without_frame(state) if frame_escapes else state


def without_frame(state: State) -> State:
    """The state after a store that may have gone anywhere into the frame."""
    return state.without(frozenset(place for place in state.values if place > PC + 1))


def _moved_block(state: State, i: Instruction, sp: int) -> State:
    lowest = sp - 4 * len(i.registers) if i.op == "push" else sp
    for k, register in enumerate(i.registers):
        place = slot(lowest + 4 * k)
        if i.op == "push":
            state = state.with_value(place, operand(state, register, i))
        elif register < SP:
            state = state.with_value(register, state.at(place))
    return state


def _without_flags(state: State, i: Instruction, sp: int, frame_escapes: bool) -> State:
    match i.op:
        case "mov" if i.d < SP and i.m < SP:
            return state.with_derived(i.d, i.m, _copied, state.at(i.m))
        case "uxtb" | "uxth":
            mask = 0xFF if i.op == "uxtb" else 0xFFFF
            return state.with_derived(i.d, i.m, lambda relation: relation.masked(mask), _plain_result(state, i))
        case "mov" | "adr" | "add_high" | "sxtb" | "sxth":
            return state.with_value(i.d, _plain_result(state, i)) if i.d < SP else state
        case "stm":
            return (without_frame(state) if frame_escapes else state).without(frozenset({i.n}))
    _, overwritten = effects(i, sp)
    return state.without(overwritten | {written_register(i)})


def _plain_result(state: State, i: Instruction) -> Word:
    source = operand(state, i.m, i)
    match i.op:
        case "adr":
            return words.constant(i.imm)
        case "add_high":
            return words.add(operand(state, i.n, i), source) if SP not in (i.n, i.m) else TOP
        case "uxtb" | "uxth":
            return words.bit_and(source, words.constant(0xFF if i.op == "uxtb" else 0xFFFF))
        case "sxtb" | "sxth":
            half = 0x80 if i.op == "sxtb" else 0x8000
            inside = source.signed_range[0] >= -half and source.signed_range[1] < half
            return source if inside else words.interval(-half, half - 1)
    return source


def _computed(state: State, i: Instruction) -> State:
    """An instruction that sets the flags."""
    a, b = operand(state, i.n, i), second_operand(state, i)
    if i.op in ("subs", "cmp", "rsbs"):
        return _subtracted(state, i, a, b)
    if i.op in LOGIC:
        result, carry = LOGIC[i.op](a, b), state.flags.carry
    elif i.op in SHIFTS:
        result, carry = _shifted(i, a, b)
    else:
        result, carry = _added(i, a, b, state.flags.carry)
    after = _written(state, i, a, b, result)
    return State(after.values, _flags(state, i, a, b, result, carry), after.origins)


def _written(state: State, i: Instruction, a: Word, b: Word, result: Word) -> State:
    """The state with the result in the register that the instruction writes, if it writes one."""
    d, (source, derive) = written_register(i), _derivation(i, a, b)
    if d < 0:
        return state
    return state.with_derived(d, source, derive, result) if source >= 0 else state.with_value(d, result)


def _copied(relation: Relation) -> Relation:
    return relation


def _derivation(i: Instruction, a: Word, b: Word) -> tuple[int, Derive]:
    """The register that the result follows from, and how; NOWHERE where it follows from none alone."""
    by_constant = i.m < 0
    match i.op:
        case "movs" if not by_constant:
            return i.m, _copied
        case "lsls" | "lsrs" if by_constant:
            shift = i.imm if i.op == "lsls" else -i.imm
            return i.n, lambda relation: relation.shifted(shift)
        case "ands" if a.constant is not None:
            mask = a.start
            return i.m, lambda relation: relation.masked(mask)
        case "ands" | "bics" if b.constant is not None:
            mask = b.start if i.op == "ands" else ~b.start & MASK
            return i.n, lambda relation: relation.masked(mask)
        case "rsbs":
            return i.m, Relation.opposite
    return NOWHERE, _copied


def _flags(state: State, i: Instruction, a: Word, b: Word, result: Word, carry: int | None) -> Flags:
    """Flags of all but subtractions."""
    d = written_register(i)
    if i.op == "bics" and b.constant is not None:
        b = words.invert(b)
    if i.op in ("lsls", "lsrs") and i.m < 0:
        return Flags(i.op, a, b, result, *_family(state, i.n, d), NOWHERE, d, carry)
    if i.op in ("ands", "tst") and a.constant is not None:
        return Flags("ands", b, a, result, *_family(state, i.m, d), NOWHERE, d, carry)
    if i.op in ("ands", "tst", "bics") and b.constant is not None:
        return Flags("ands", a, b, result, *_family(state, i.n, d), NOWHERE, d, carry)
    return Flags(result=result, result_at=d, carry=carry)


def _family(state: State, source: int, d: int) -> tuple[Relation, Word, tuple[tuple[int, Relation], ...]]:
    """How `source` follows from its root, what is known of that, and who else does, when `d` is overwritten."""
    if not 0 <= source < SP:
        return SAME, TOP, ()
    relation, root, relatives = state.related(source)
    return relation, root, tuple(relative for relative in relatives if relative[0] != d)


def _subtracted(state: State, i: Instruction, a: Word, b: Word) -> State:
    a_at, b_at, d = i.n, i.m, written_register(i)
    if i.op == "rsbs":
        a, b, a_at, b_at = words.constant(0), operand(state, i.m, i), NOWHERE, i.m
    result = words.subtract(a, b) if a_at != b_at else words.constant(0)
    after = _written(state, i, a, b, result)
    carry = 1 if a.lowest >= b.highest else 0 if a.highest < b.lowest else None
    b_at = b_at if b_at != d and b_at < SP else NOWHERE
    return State(after.values, Flags("subtract", a, b, result, *_family(state, a_at, d), b_at, d, carry), after.origins)


def _added(i: Instruction, a: Word, b: Word, carry_in: int | None) -> tuple[Word, int | None]:
    """ADDS, ADCS, SBCS (a + not b + carry) and CMN; RORS is not followed."""
    if i.op == "rors":
        return TOP, None
    second = words.invert(b) if i.op == "sbcs" else b
    carries = [0] if i.op in ("adds", "cmn") else [0, 1] if carry_in is None else [carry_in]
    sums = [words.add(words.add(a, second), words.constant(c)) for c in carries]
    result = words.join(sums[0], sums[-1])
    if i.op == "sbcs" and i.n == i.m:
        result = words.constant(carries[0] - 1) if len(carries) == 1 else words.interval(-1, 0)
    smallest, largest = a.lowest + second.lowest + carries[0], a.highest + second.highest + carries[-1]
    return result, 1 if smallest > MASK else 0 if largest <= MASK else None


def _shifted(i: Instruction, a: Word, b: Word) -> tuple[Word, int | None]:
    if i.m < 0:
        bit = 32 - i.imm if i.op == "lsls" else i.imm - 1
        return SHIFTS[i.op](a, i.imm), a.bits >> bit & 1 if a.known >> bit & 1 else None
    amounts = words.bit_and(b, words.constant(0xFF)).members(MOST_SHIFTS)
    if amounts is None:
        return TOP, None
    results = [SHIFTS[i.op](a, min(amount, 32)) for amount in amounts]
    result = results[0]
    for other in results[1:]:
        result = words.join(result, other)
    return result, None
