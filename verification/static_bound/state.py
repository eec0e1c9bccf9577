"""What is known of the processor before an instruction: words by location, and where the flags come from."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from verification.static_bound import words
from verification.static_bound.relation import SAME, Relation
from verification.static_bound.words import MASK, SIGN, TOP, Word

NOWHERE = -1
Derive = Callable[[Relation], Relation | None]


class Flags(NamedTuple):
    """Flags of the last instruction that set them.

    After a subtraction `a - b` (kind "subtract") all conditions are decided by `a` and `b`; otherwise Z and N by `result`, C by `carry`.
    After a shift of `a` by the constant `b` (kind "lsls", "lsrs") or a test of the bits `b` (kind "ands") Z also tells of `a`.
    The registers `b_at` and `result_at` still hold `b` and the result. `a` follows from `root` by `relation`, as do `relatives`.
    """

    kind: str = ""
    a: Word = TOP
    b: Word = TOP
    result: Word = TOP
    relation: Relation = SAME
    root: Word = TOP
    relatives: tuple[tuple[int, Relation], ...] = ()
    b_at: int = NOWHERE
    result_at: int = NOWHERE
    carry: int | None = None


UNKNOWN_FLAGS = Flags()
Origins = Mapping[int, tuple[int, Relation]]
NO_ORIGINS: Origins = {}


class State(NamedTuple):
    """Words known by location (TOP where absent) and flags. A state is never changed once it is made.

    `origins` gives locations that follow from another one, which has not changed since, and how they do.
    """

    values: dict[int, Word]
    flags: Flags
    origins: Origins = NO_ORIGINS

    def at(self, location: int) -> Word:
        """What is known of a location."""
        return self.values.get(location, TOP)

    def with_value(self, location: int, word: Word) -> "State":
        """The state after `location` was overwritten."""
        values = {**self.values, location: word}
        if word == TOP:
            del values[location]
        return State(values, _forget(self.flags, location), self._origins_without(location))

    def with_derived(self, location: int, source: int, derive: Derive, word: Word) -> "State":
        """The state after `location` was overwritten by what `derive` makes of `source`; `word` is the result."""
        root, relation = self.origins.get(source, (source, SAME))
        after, derived = self.with_value(location, word), derive(relation)
        if root == location:
            copies = [place for place, origin in self.origins.items() if origin == (root, SAME) and place != location]
            root = copies[0] if copies else NOWHERE
        origins = after.origins
        if derived and root != NOWHERE:
            origins = {**origins, location: (root, derived)}
        of_source = [derive(relation) for place, relation in self.flags.relatives if place == source]
        more = tuple((location, relation) for relation in of_source if relation)
        return State(after.values, after.flags._replace(relatives=after.flags.relatives + more), origins)

    def without(self, locations: frozenset[int]) -> "State":
        """The state after `locations` were overwritten with something unknown."""
        flags = self.flags
        for location in locations:
            flags = _forget(flags, location)
        origins = {
            place: (root, how)
            for place, (root, how) in self.origins.items()
            if place not in locations and root not in locations
        }
        return State({place: word for place, word in self.values.items() if place not in locations}, flags, origins)

    def limited_to(self, live: frozenset[int], flags_live: bool) -> "State":
        """The state without what is not read any more; a copy takes the place of an origin that ends."""
        state = self
        for root in {root for root, _ in self.origins.values()} - live:
            state = state._replace(origins=state._origins_without(root))
        origins = {place: origin for place, origin in state.origins.items() if place in live}
        values = {place: word for place, word in self.values.items() if place in live}
        return State(values, self.flags if flags_live else UNKNOWN_FLAGS, origins)

    def related(self, location: int) -> tuple[Relation, Word, tuple[tuple[int, Relation], ...]]:
        """How a location follows from its root, what is known of that, and all that follows from the root, itself included."""
        root, relation = self.origins.get(location, (location, SAME))
        family = tuple((place, how) for place, (of, how) in self.origins.items() if of == root)
        return relation, self.at(root), ((root, SAME), *family)

    def _origins_without(self, location: int) -> Origins:
        if not self.origins:
            return self.origins
        rest = {place: origin for place, origin in self.origins.items() if place != location}
        copies = [place for place, origin in rest.items() if origin == (location, SAME)]
        heir = copies[0] if copies else NOWHERE
        moved = {place: (heir if root == location else root, how) for place, (root, how) in rest.items()}
        return {place: (root, how) for place, (root, how) in moved.items() if root not in (NOWHERE, place)}


def _forget(flags: Flags, location: int) -> Flags:
    if any(place == location for place, _ in flags.relatives):
        flags = flags._replace(relatives=tuple(r for r in flags.relatives if r[0] != location))
    if location == flags.b_at:
        flags = flags._replace(b_at=NOWHERE)
    return flags._replace(result_at=NOWHERE) if location == flags.result_at else flags


def join_states(a: State, b: State) -> State:
    """A state that holds whatever either holds."""
    shared = a.values.keys() & b.values.keys()
    values = {place: words.join(a.values[place], b.values[place]) for place in shared}
    flags = a.flags if a.flags == b.flags else _joined_flags(a.flags, b.flags)
    origins = {place: origin for place, origin in a.origins.items() if b.origins.get(place) == origin}
    return State({place: word for place, word in values.items() if word != TOP}, flags, origins)


def _joined_flags(a: Flags, b: Flags) -> Flags:
    same_places = (a.relation, a.relatives, a.b_at, a.result_at) == (b.relation, b.relatives, b.b_at, b.result_at)
    if a.kind != b.kind or not same_places:
        return UNKNOWN_FLAGS
    return a._replace(
        a=words.join(a.a, b.a),
        b=words.join(a.b, b.b),
        result=words.join(a.result, b.result),
        root=words.join(a.root, b.root),
        carry=a.carry if a.carry == b.carry else None,
    )


OPPOSITE = {"eq": "ne", "hs": "lo", "mi": "pl", "vs": "vc", "hi": "ls", "ge": "lt", "gt": "le"}
OPPOSITE |= {second: first for first, second in OPPOSITE.items()}


def assume_all(state: State, condition: str) -> list[State]:
    """States that together hold all of `state` where `condition` holds; an arc around zero that must not be zero is cut into two."""
    around_zero = state.flags.result.start + state.flags.result.span > MASK
    if condition == "ne" and around_zero:
        halves = [assume(state, sign) for sign in ("mi", "pl")]
        parts = [half and assume(half, "ne") for half in halves]
    else:
        parts = [assume(state, condition)]
    return [part for part in parts if part]


def assume(state: State, condition: str) -> State | None:
    """The state where `condition` holds, None where it cannot."""
    flags = state.flags
    result = _result_where(flags.result, condition)
    if result is None:
        return None
    if flags.kind != "subtract":
        carries = {"hs": 1, "hi": 1, "lo": 0}
        possible = flags.carry is None or carries.get(condition, flags.carry) == flags.carry
        source = _source_where(flags, condition)
        return _refined(state, flags._replace(a=source, result=result)) if possible and source else None
    pair = _operands_where(flags.a, flags.b, condition)
    if pair is None:
        return None
    narrower = words.common(result, words.subtract(*pair))
    return narrower and _refined(state, flags._replace(a=pair[0], b=pair[1], result=narrower))


def _source_where(flags: Flags, condition: str) -> Word | None:
    """What was shifted or tested, where the result is zero or not."""
    amount = flags.b.constant or 0
    match flags.kind, condition:
        case "lsrs", "eq":
            return words.within(flags.a, 0, (1 << amount) - 1)
        case "lsrs", "ne":
            return words.within(flags.a, 1 << amount, MASK)
        case "lsls", "eq":
            return words.common(flags.a, words.bit_pattern(MASK >> amount, 0))
        case "lsls", "ne":
            return words.within(flags.a, 1, MASK)
        case "ands", "eq":
            return words.common(flags.a, words.bit_pattern(amount, 0))
        case "ands", "ne" if amount and amount & (amount - 1) == 0:
            return words.common(flags.a, words.bit_pattern(amount, amount))
    return flags.a


def _refined(state: State, flags: Flags) -> State | None:
    """The state with what its flags tell carried over to all locations concerned."""
    root = flags.relation.root(flags.a, flags.root)
    if root is None:
        return None
    found = [(place, relation.number(root)) for place, relation in flags.relatives]
    found += [(place, flags.a) for place, relation in flags.relatives if relation == flags.relation]
    found += [
        (place, word) for place, word in ((flags.b_at, flags.b), (flags.result_at, flags.result)) if place != NOWHERE
    ]
    known = dict(state.values)
    for place, word in found:
        both = words.common(known.get(place, TOP), word)
        if both is None:
            return None
        if both != TOP:
            known[place] = both
    return State(known, flags._replace(root=root), state.origins)


def _result_where(result: Word, condition: str) -> Word | None:
    match condition:
        case "eq":
            return words.common(result, words.constant(0))
        case "ne":
            return words.within(result, 1, MASK)
        case "mi":
            return words.within(result, SIGN, MASK)
        case "pl":
            return words.within(result, 0, SIGN - 1)
    return result


def _operands_where(a: Word, b: Word, condition: str) -> tuple[Word, Word] | None:
    match condition:
        case "eq":
            both = words.common(a, b)
            return (both, both) if both else None
        case "ne":
            return _unequal(a, b)
        case "mi" | "pl" if b.constant == 0:
            sign = words.within(a, SIGN, MASK) if condition == "mi" else words.within(a, 0, SIGN - 1)
            return (sign, b) if sign else None
        case "lo" | "ls":
            return _ordered(a, b, (a.lowest, a.highest), (b.lowest, b.highest), (0, MASK), condition == "lo")
        case "hi" | "hs":
            return _swapped(_ordered(b, a, (b.lowest, b.highest), (a.lowest, a.highest), (0, MASK), condition == "hi"))
        case "lt" | "le":
            return _ordered(a, b, a.signed_range, b.signed_range, (-SIGN, SIGN - 1), condition == "lt")
        case "gt" | "ge":
            return _swapped(_ordered(b, a, b.signed_range, a.signed_range, (-SIGN, SIGN - 1), condition == "gt"))
    return a, b


Range = tuple[int, int]


def _ordered(
    a: Word, b: Word, a_range: Range, b_range: Range, limits: Range, strictly: bool
) -> tuple[Word, Word] | None:
    """Both operands where a < b (or a <= b), read in the number range `limits`."""
    less = words.within(a, limits[0], b_range[1] - strictly)
    more = words.within(b, a_range[0] + strictly, limits[1])
    return (less, more) if less and more else None


def _swapped(pair: tuple[Word, Word] | None) -> tuple[Word, Word] | None:
    return pair and (pair[1], pair[0])


def _unequal(a: Word, b: Word) -> tuple[Word, Word] | None:
    rest_a = words.within(a, b.start + 1, b.start + MASK) if b.span == 0 else a
    rest_b = words.within(b, a.start + 1, a.start + MASK) if a.span == 0 else b
    return (rest_a, rest_b) if rest_a and rest_b else None
