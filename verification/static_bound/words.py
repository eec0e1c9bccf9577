"""Sets of 32-bit words: an arc of the ring modulo 2^32 together with the bits that are known.

A word x belongs to `Word(start, span, known, bits)` when (x - start) mod 2^32 <= span and x & known == bits. Arcs that wrap serve signed
and unsigned numbers alike. Every operation returns a set that contains all true results; it may contain more.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

# One analysis asks for the same sets again and again: of half a million only 20 000 differ.
_remembered = lru_cache(maxsize=1 << 15)
MASK = 0xFFFFFFFF
SIGN = 0x80000000


class Word(NamedTuple):
    """What is known of one 32-bit word."""

    start: int
    span: int
    known: int
    bits: int

    @property
    def constant(self) -> int | None:
        """The value where there is only one."""
        return self.start if self.span == 0 else None

    @property
    def lowest(self) -> int:
        """Smallest value, read as unsigned."""
        return self.start if self.start + self.span <= MASK else 0

    @property
    def highest(self) -> int:
        """Largest value, read as unsigned."""
        end = self.start + self.span
        return end if end <= MASK else MASK

    @property
    def signed_range(self) -> tuple[int, int]:
        """Smallest and largest value, read as two's complement."""
        low = self.start - 2 * (self.start & SIGN)
        return (low, low + self.span) if low + self.span < SIGN else (-SIGN, SIGN - 1)

    def members(self, most: int) -> Iterator[int] | None:
        """All values, or None where there may be more than `most`."""
        stride = (~self.known & (self.known + 1)) or 1
        first = self.start + (self.bits - self.start) % stride
        if self.span // stride >= most:
            return None
        candidates = (x & MASK for x in range(first, self.start + self.span + 1, stride))
        return (x for x in candidates if x & self.known == self.bits)


TOP = Word(0, MASK, 0, 0)


def constant(value: int) -> Word:
    """The set of one value."""
    value &= MASK
    return Word(value, 0, MASK, value)


def interval(low: int, high: int) -> Word:
    """All words from `low` to `high` inclusive (either may be negative)."""
    return _settled(low & MASK, min(high - low, MASK), 0, 0) or TOP


def bit_pattern(known: int, bits: int) -> Word:
    """All words whose bits under `known` are `bits`."""
    return _settled(0, MASK, known & MASK, bits & known & MASK) or TOP


@_remembered
def _settled(start: int, span: int, known: int, bits: int) -> Word | None:
    """Let arc and bits sharpen each other; None where they contradict."""
    low, high = bits, bits | ~known & MASK
    if start + span > MASK:
        if high - low < span:
            start, span = low, high - low
    else:
        first, last = max(start, low), min(start + span, high)
        if first > last:
            return None
        start, span = first, last - first
    if start + span <= MASK:
        same = MASK & ~((1 << (start ^ start + span).bit_length()) - 1)
        if (start ^ bits) & same & known:
            return None
        known, bits = known | same, bits & ~same | start & same
    if known == MASK:
        return Word(bits, 0, MASK, bits)
    return Word(start, span, known, bits)


@_remembered
def within(word: Word, low: int, high: int) -> Word | None:
    """The part of `word` on the arc from `low` to `high`; where two pieces remain, the smaller of both sets that covers them."""
    if low > high:
        return None
    span = min(high - low, MASK)
    offset = (low - word.start) & MASK  # where the arc begins, seen from the word
    if offset > word.span:
        overlap = offset + span - (MASK + 1)  # how far the arc, come round, reaches into the word
        return _settled(word.start, min(overlap, word.span), word.known, word.bits) if overlap >= 0 else None
    if offset + span > MASK:
        return word if word.span <= span else _settled(low & MASK, span, word.known, word.bits)
    return _settled(low & MASK, min(span, word.span - offset), word.known, word.bits)


@_remembered
def common(a: Word, b: Word) -> Word | None:
    """A set that holds every word of both; None where there is none."""
    if (a.bits ^ b.bits) & a.known & b.known:
        return None
    part = within(a, b.start, b.start + b.span)
    return part and _settled(part.start, part.span, part.known | b.known, part.bits | b.bits)


@_remembered
def join(a: Word, b: Word) -> Word:
    """A set that holds all words of either: the shorter arc over both."""
    known = a.known & b.known & ~(a.bits ^ b.bits)
    choices = [(a.start, max(a.span, ((b.start - a.start) & MASK) + b.span))]
    choices.append((b.start, max(b.span, ((a.start - b.start) & MASK) + a.span)))
    start, span = min(choices, key=lambda arc: arc[1])
    return _settled(start if span < MASK else 0, min(span, MASK), known, a.bits & known) or TOP


@_remembered
def add(a: Word, b: Word) -> Word:
    """a + b modulo 2^32."""
    if a.span == b.span == 0:
        return constant(a.start + b.start)
    known, bits = _added_bits(a, b)
    span = a.span + b.span
    if span >= MASK:
        return bit_pattern(known, bits)
    return _settled((a.start + b.start) & MASK, span, known, bits) or TOP


def _added_bits(a: Word, b: Word) -> tuple[int, int]:
    """A sum's bit is known where both operands' bits are and the carry into it is the same for smallest and largest operands."""
    low, high = a.bits + b.bits, (a.bits | ~a.known & MASK) + (b.bits | ~b.known & MASK)
    carry_low, carry_high = low ^ a.bits ^ b.bits, high ^ (a.bits | ~a.known & MASK) ^ (b.bits | ~b.known & MASK)
    known = a.known & b.known & ~(carry_low ^ carry_high) & MASK
    return known, low & known


def negate(a: Word) -> Word:
    """-a modulo 2^32."""
    return add(invert(a), constant(1))


def invert(a: Word) -> Word:
    """Bitwise complement."""
    return _settled((~(a.start + a.span)) & MASK, a.span, a.known, ~a.bits & a.known) or TOP


def subtract(a: Word, b: Word) -> Word:
    """a - b modulo 2^32."""
    return constant(a.start - b.start) if a.span == b.span == 0 else add(add(a, invert(b)), constant(1))


def bit_and(a: Word, b: Word) -> Word:
    """Bitwise conjunction."""
    if a.span == b.span == 0:
        return constant(a.start & b.start)
    zeros = (a.known & ~a.bits) | (b.known & ~b.bits)
    ones = a.bits & b.bits
    result = bit_pattern(zeros | ones, ones)
    for word, mask in ((a, b), (b, a)):
        if (
            mask.span == 0 and ~word.known & ~mask.start & MASK == 0
        ):  # only known bits are taken away: the arc moves as a whole
            start = (word.start - (word.bits & ~mask.start)) & MASK
            return _settled(start, word.span, result.known, result.bits) or TOP
    return within(result, 0, min(a.highest, b.highest)) or TOP


def bit_or(a: Word, b: Word) -> Word:
    """Bitwise disjunction."""
    return invert(bit_and(invert(a), invert(b)))


def bit_xor(a: Word, b: Word) -> Word:
    """Bitwise exclusive disjunction."""
    if b.constant == SIGN:
        return add(a, b)
    known = a.known & b.known
    return bit_pattern(known, (a.bits ^ b.bits) & known)


def shift_left(a: Word, amount: int) -> Word:
    """a * 2^amount modulo 2^32, amount 0..32."""
    shifted = bit_pattern(a.known << amount | (1 << amount) - 1, a.bits << amount)
    if a.start + a.span <= MASK and (a.start + a.span) << amount <= MASK:
        return within(shifted, a.start << amount, (a.start + a.span) << amount) or TOP
    return shifted


def shift_right(a: Word, amount: int) -> Word:
    """a / 2^amount rounded down, unsigned, amount 0..32."""
    top = MASK & ~(MASK >> amount)
    shifted = bit_pattern(a.known >> amount | top, a.bits >> amount)
    return within(shifted, a.lowest >> amount, a.highest >> amount) or TOP


def shift_right_signed(a: Word, amount: int) -> Word:
    """a / 2^amount rounded down, two's complement, amount 0..32."""
    low, high = a.signed_range
    return interval(low >> amount, high >> amount)


def multiply(a: Word, b: Word) -> Word:
    """a * b modulo 2^32: exact for constants, an interval where nothing overflows."""
    if a.highest * b.highest <= MASK:
        return interval(a.lowest * b.lowest, a.highest * b.highest)
    if a.constant is not None and b.constant is not None:
        return constant(a.constant * b.constant)
    return TOP
