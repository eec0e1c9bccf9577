"""How one location's number follows from another's: a field of its bits, shifted, perhaps negated."""

from typing import NamedTuple

from verification.static_bound import words
from verification.static_bound.words import MASK, Word


class Relation(NamedTuple):
    """number = (root & mask) * 2^shift, negated where `negated`; `mask` holds no bit that the shift would push out at the top."""

    mask: int = MASK
    shift: int = 0
    negated: bool = False

    def masked(self, mask: int) -> "Relation | None":
        """The relation of number & mask."""
        moved = mask >> self.shift if self.shift >= 0 else mask << -self.shift
        return None if self.negated else self._replace(mask=self.mask & moved)

    def shifted(self, shift: int) -> "Relation | None":
        """The relation of number * 2^shift, bits lost on both sides."""
        if self.negated or abs(shift) >= 32:
            return None
        mask, total = self.mask, self.shift + shift
        if shift > 0 and self.shift < 0:
            mask &= MASK << -self.shift
        return Relation(mask & (MASK >> total) if total > 0 else mask, total)

    def opposite(self) -> "Relation":
        """The relation of -number."""
        return self._replace(negated=not self.negated)

    def number(self, root: Word) -> Word:
        """Numbers that follow from the roots."""
        field = root if self.mask == MASK else words.bit_and(root, words.constant(self.mask))
        moved = (
            words.shift_left(field, self.shift) if self.shift >= 0 else words.shift_right(field, min(-self.shift, 32))
        )
        return words.negate(moved) if self.negated else moved

    def root(self, number: Word, known: Word) -> Word | None:
        """Those of the `known` roots whose number is among `number`; all of them where that cannot be told."""
        if self.negated:
            number = words.negate(number)
        if self.shift >= 0:
            low, high = number.lowest >> self.shift, number.highest >> self.shift
        else:
            low, high = number.lowest << -self.shift, (number.highest + 1 << -self.shift) - 1
            if high > MASK:
                return known
        below = (self.mask & -self.mask) - 1 if self.mask else MASK
        beside = ~self.mask & ~below & MASK
        if beside & ~known.known or not self.mask:
            return known
        if self.mask == MASK and self.shift == 0:
            return words.common(known, number)
        fixed = known.bits & beside
        return words.within(known, low + fixed, min(high, MASK) + fixed + below)


SAME = Relation()
