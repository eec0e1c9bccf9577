"""The fixed-point law's words as a Gappa script: sums and products are exact, floors are floors, real numbers are in steps of the word.

Products without the product of the low halves are 0 to 3 below the exact ones, as codegen/fixed/arithmetic.py says; for the script
that difference is a number of which no more is known.
"""

from verification.proofs.rounding.gappa_script import GappaBook, Pair, dyadic


class GappaWords(GappaBook):
    """The law's decisions on words, of which only those within declared ranges occur."""

    header = "@floor = int<dn>;\n@away = int<aw>;\n"

    def constant(self, value: float, places: int, made_up: float = 0.0, neglected: float = 0.0) -> Pair:
        """A number of the table: as the nearest word holds it, and as the table states it, with terms left out of it."""
        word, steps, left_out = round(value * 2.0**places + made_up), value * 2.0**places, neglected * 2.0**places
        if left_out:
            unknown = self._unknown(-left_out, left_out)
            number = self._pair(dyadic(word), f"{dyadic(steps)} + {unknown}", (), (unknown,))
        else:
            number = self._pair(dyadic(word), None if word == steps else dyadic(steps))
        self._constants[number.f] = (float(word), steps)
        return number

    def stored(self, name: str) -> str:
        return name

    def operation(self, sign: str, one: Pair, other: Pair | int) -> Pair:
        """Exact; a number that the law adds to a word before it rounds is no part of the real law."""
        if isinstance(other, Pair):
            return self._both(f"{{}} {sign} {{}}", one, other)
        if sign == "*":
            return self._both(f"{{}} * {other}", one)
        return self._beside(one, f"+ {other}")

    def restricted(self, number: Pair, low: float, high: float) -> Pair:
        return self.known(number, (low, high))

    def word(self, name: str, value: Pair) -> Pair:
        return value

    def floored(self, value: Pair, places: int) -> Pair:
        if not places:
            return value
        return self._pair(f"floor({value.f} * 1b-{places})", f"{value.r} * 1b-{places}", (value.f,), (value.r,))

    def accepted(self, value: Pair, last: Pair) -> Pair:
        return value

    def held(self, value: Pair, low: Pair, high: Pair) -> Pair:
        return self.clamp(value, low, high)

    def towards(self, value: Pair, target: Pair, gain: Pair) -> Pair:
        step = self._both("{} * {} * 1b-31", gain, target - value)
        return value + self._pair(f"away({step.f})", step.r, (step.f,), (step.r,))

    def whole(self, total: Pair, places: int) -> tuple[bool, Pair]:
        move = self.floored(total, places)
        return self.is_within(move, 30), move

    def fraction(self, value: Pair, places: int) -> Pair:
        """What an earlier sum left below its last place: nothing in the real law."""
        unknown = self._unknown(0.0, 2.0**places)
        return self._pair(unknown, "0", (unknown,))

    def is_within(self, value: Pair, bits: int) -> bool:
        """Asked of the prover: the real law never gives up its feedback."""
        self.demand_size(value, 2.0**bits, "feedback may leave its words")
        return True

    def both(self, one: bool, other: bool) -> bool:
        return one and other

    def wrapped(self, value: Pair, bits: int) -> Pair:
        return value

    def scaled(self, value: Pair, x: Pair) -> Pair:
        product, below = self._both("{} * {} * 1b-32", value, x), self._unknown(0.0, 3.0)
        return self._beside(product, f"- {below}", below)

    def narrow_product(self, value: Pair, x: Pair) -> Pair:
        return value * x

    def short_product(self, value: Pair, x: Pair) -> Pair:
        return value * x

    def scaled_short(self, value: Pair, x: Pair) -> Pair:
        return self.floored(value * x, 16)

    def _both(self, text: str, *numbers: Pair) -> Pair:
        """The same of the words and of the real numbers; exact where all of these are."""
        f, r = [number.f for number in numbers], [number.r for number in numbers]
        return self._pair(text.format(*f), None if f == r else text.format(*r), tuple(f), tuple(r))

    def _beside(self, number: Pair, added: str, *uses: str) -> Pair:
        """The word with what its real number knows nothing of; Gappa sees that both belong together where both are sums."""
        return self._pair(f"{number.f} {added}", f"{number.r} {added[0]} 0", (number.f, *uses), (number.r,))

    def _unknown(self, low: float, high: float) -> str:
        """The name of any real number of low..high."""
        return self.within(low, high).f
