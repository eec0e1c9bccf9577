"""A row of a rig's catalogue: an effect that the diagnosis' library has, judged by a formula there, or one that it has not."""

from collections.abc import Callable, Mapping

from blind.effects.ce150_formulas import Formula, Sized, Start, Term
from blind.effects.draws import Source
from blind.effects.effect import SCALAR, Effect, Shape, Size
from blind.effects.equivalent import Equivalents
from blind.effects.visited import Visited

Judged = Callable[[float, Shape, Visited], Equivalents]


def known(
    name: str,
    depends: str,
    size: Size,
    formula: Formula | None,
    *indices: int,
    bounds: tuple[float, float],
    term: Term | None = None,
    start: Start | None = None,
    equivalent: Judged | None = None,
    drawn: Mapping[str, Source] | None = None,
    fixed: Mapping[str, float] | None = None,
    signed: bool = False,
    single: tuple[str, ...] = (),
    sensor: bool = False,
    needs: str = "",
    hides: str = "",
    twins: str = "",
    loses_frames: bool = False,
) -> Effect:
    """An effect of the library, with its size there by its `formula`, for which `term` and `start` are the rig's own (see `Sized`), or by
    `equivalent`; raises ValueError where neither is given."""
    if formula is None and equivalent is None:
        raise ValueError(f"{depends}: the table has no formula, and the rig's row gives no equivalent")

    def judged(m: float, shape: Shape, visited: Visited) -> Equivalents:
        assert formula is not None
        a = size.at(m) * shape["sign"] if signed else size.at(m)
        return formula(Sized(a, {**shape, **(fixed or {})}, visited, indices[0] if indices else SCALAR, term, start))

    return Effect(
        name=name,
        places=(name.partition(".")[0],),
        depends=depends,
        size=size,
        drawn=drawn or {},
        fixed=fixed or {},
        signed=signed,
        indices=indices or (SCALAR,),
        single=single,
        bounds=bounds,
        equivalent=equivalent or judged,
        known=True,
        sensor=sensor,
        needs=needs,
        hides=hides,
        twins=tuple(twins.split()),
        loses_frames=loses_frames,
    )


def outside(
    name: str,
    places: str,
    depends: str,
    size: Size,
    *indices: int,
    bounds: tuple[float, float],
    drawn: Mapping[str, Source] | None = None,
    fixed: Mapping[str, float] | None = None,
    signed: bool = False,
    keywords: str = "",
    twins: str = "",
    sensor: bool = False,
) -> Effect:
    """An effect that the library does not hold; lists of words are one text."""
    return Effect(
        name=name,
        places=tuple(places.split()),
        depends=depends,
        size=size,
        drawn=drawn or {},
        fixed=fixed or {},
        signed=signed,
        indices=indices or (SCALAR,),
        bounds=bounds,
        sensor=sensor,
        keywords=tuple(keywords.split()),
        twins=tuple(twins.split()),
    )
