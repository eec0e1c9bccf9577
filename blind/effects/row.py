"""A row of a rig's catalogue: an effect that the diagnosis' library has, judged by a formula there, or one that it has not."""

from collections.abc import Callable, Mapping
from typing import TypedDict, Unpack

from blind.effects.ce150_formulas import Formula, OwnLaw, Sized
from blind.effects.draws import Source
from blind.effects.effect import SCALAR, Effect, Shape, Size
from blind.effects.equivalent import Equivalents
from blind.effects.visited import Visited

Judged = Callable[[float, Shape, Visited], Equivalents]


class Traits(TypedDict, total=False):
    """Fields of an Effect that any row may give, each as it stands there."""

    drawn: Mapping[str, Source]
    fixed: Mapping[str, float]
    signed: bool
    single: tuple[str, ...]
    bounds: tuple[float, float]
    sensor: bool
    needs: str
    hides: str
    loses_frames: bool
    equivalent: Judged


def known(
    name: str,
    depends: str,
    size: Size,
    formula: Formula | None,
    *indices: int,
    law: OwnLaw | None = None,
    twins: str = "",
    **traits: Unpack[Traits],
) -> Effect:
    """An effect of the library, with its size there by its `formula`, for which `law` is the rig's own, or by `equivalent`; raises
    ValueError where neither is given."""
    if formula is None and "equivalent" not in traits:
        raise ValueError(f"{depends}: the table has no formula, and the rig's row gives no equivalent")
    signed, fixed = traits.get("signed", False), traits.get("fixed", {})

    def judged(m: float, shape: Shape, visited: Visited) -> Equivalents:
        assert formula is not None
        a = size.at(m) * shape["sign"] if signed else size.at(m)
        return formula(Sized(a, {**shape, **fixed}, visited, indices[0] if indices else SCALAR, law))

    own: Traits = {"equivalent": judged, **traits}
    return Effect(
        name=name,
        places=(name.partition(".")[0],),
        depends=depends,
        size=size,
        indices=indices or (SCALAR,),
        known=True,
        twins=tuple(twins.split()),
        **own,
    )


def outside(
    name: str,
    places: str,
    depends: str,
    size: Size,
    *indices: int,
    keywords: str = "",
    twins: str = "",
    **traits: Unpack[Traits],
) -> Effect:
    """An effect that the library does not hold; lists of words are one text."""
    return Effect(
        name=name,
        places=tuple(places.split()),
        depends=depends,
        size=size,
        indices=indices or (SCALAR,),
        keywords=tuple(keywords.split()),
        twins=tuple(twins.split()),
        **traits,
    )
