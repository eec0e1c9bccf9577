"""What is an effect's own stands with the effect: no machinery knows one by its name, its kind or the symbol of a number."""

import ast
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pytest

import sim.effects
from sim.added_effects import every_effect
from sim.effect import Role
from sim.plants import MODELS
from tests.test_project import ROOT

MACHINERY = ("diagnosis", "identification", "twinlaw", "logcheck", "replay")
EFFECTS = tuple(every_effect())
NAMES, KINDS = {effect.name for effect in EFFECTS}, {effect.kind for effect in EFFECTS}
SYMBOLS = {parameter.symbol for effect in EFFECTS for parameter in effect.parameters}
ASKED_OF_A_TEXT = {
    "startswith",
    "endswith",
    "removeprefix",
    "removesuffix",
    "partition",
    "rpartition",
    "split",
    "find",
    "index",
}
ASKED_OF_A_TEXT |= {"count", "match", "search", "fullmatch", "compile"}
LEAST_PIECE = 4  # letters: shorter ones stand in many words
TIME_COLUMN = "t_s"  # of every log, and by chance a symbol as well

# Names of other things that are written like one of an effect's: module -> what they are, and the words.
OTHER_THINGS: Mapping[str, tuple[str, set[str]]] = {
    "diagnosis/decide/unknown.py": ("a functional class, and the ending of a place", {"limit", "_rotor"}),
    "diagnosis/decide/column_wiring.py": ("arrays of a filter input", {"r"}),
    "diagnosis/experiment/menu.py": ("the unit of a way", {"m"}),
    "diagnosis/experiment/next_experiment.py": ("the unit of a way", {"m"}),
    "diagnosis/filter/filter_input.py": ("arrays of a filter input", {"r"}),
    "diagnosis/filter/kalman.py": ("fields of c/filter.h", {"K", "p", "q", "r", "s", "w"}),
    "diagnosis/library/effect_library.py": ("the vector of coefficients", {"p"}),
    "diagnosis/validate/simulated.py": ("fields of c/filter.h", {"p", "q", "r", "s", "w"}),
    "identification/envelope/truth/fly.py": ("the air of another aircraft's flight", {"gust"}),
    "identification/experiments/ce150/models.py": ("a parameter of the plant", {"K"}),
    "identification/experiments/velagic/experiments.py": ("an experiment", {"gyroscopic"}),
    "identification/experiments/table.py": ("what data need and no plant file has", {"offset."}),
    "identification/frequency/lateral.py": ("the bank of another aircraft's flight", {"Phi_0"}),
    "identification/frequency/responses/conditioned.py": ("references of a record", {"r"}),
    "identification/frequency/result.py": ("a cost", {"J"}),
    "identification/proof/linear_rotor.py": ("a parameter of the plant", {"K"}),
    "replay/law.py": ("rows of a controller's table", {"a", "c", "p", "q"}),
    "replay/causes/lone.py": ("rows of a controller's table", {"a", "p"}),
    "replay/variants.py": ("rows of a controller's table", {"a", "p"}),
    "twinlaw/command.py": ("modes of a file", {"r", "w"}),
    "twinlaw/pages/diagnose/answers.py": ("a heading", {"phase"}),
    "twinlaw/pages/diagnose/why.py": ("a heading", {"limit"}),
    "twinlaw/pages/diagnose/words.py": (
        "what of a rig changes, as classes say it",
        {"gain", "limit", "rate", "torque"},
    ),
    "twinlaw/pages/identify/report.py": ("an experiment", {"gravity"}),
    "twinlaw/pages/run/design_page.py": ("rows of a controller's table", {"p", "q"}),
    "twinlaw/pages/run/design.py": ("headings", {"delay", "phase"}),
    "twinlaw/verbs/trace.py": ("a heading", {"difference"}),
    "twinlaw/watching/events.py": ("series of a picture", {"p", "r"}),
    "twinlaw/workflows/identify/by_time.py": ("what data need and no plant file has", {"offset."}),
}


def _modules() -> Iterator[tuple[str, ast.Module]]:
    for package in MACHINERY:
        for path in sorted((ROOT / package).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def _texts(nodes: Iterator[ast.expr | None]) -> Iterator[str]:
    return (node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str))


def _literals(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """All strings of a module but its docstrings, pieces of f-strings among them."""
    documented = [node for node in nodes if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)]
    docstrings = {id(node.body[0].value) for node in documented if node.body and isinstance(node.body[0], ast.Expr)}
    return _texts(node for node in nodes if isinstance(node, ast.Constant) and id(node) not in docstrings)


def _keys(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Strings by which a number could be asked for: in brackets, before a colon, compared, listed, or asked of `get`."""
    for node in nodes:
        if isinstance(node, ast.Subscript):
            yield from _texts(iter([node.slice]))
        elif isinstance(node, ast.Dict):
            yield from _texts(iter(node.keys))
        elif isinstance(node, ast.Compare):
            yield from _texts(iter([node.left, *node.comparators]))
        elif isinstance(node, ast.Tuple | ast.List | ast.Set):
            yield from _texts(iter(node.elts))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in ("get", "pop"):
            yield from _texts(iter(node.args[:1]))


def _pieces(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Strings by which a part of a name could be recognised: what texts are asked to begin or end with, to hold or to match."""
    for node in nodes:
        if isinstance(node, ast.Compare):
            yield from _texts(iter([node.left, *node.comparators]))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in ASKED_OF_A_TEXT:
            yield from _texts(part for entry in node.args for part in ast.walk(entry) if isinstance(part, ast.expr))


def _is_piece(text: str) -> bool:
    core = text.strip("._^$* ")
    return len(core) >= LEAST_PIECE and any(core in kind for kind in KINDS)


def _named(module: ast.Module) -> set[str]:
    """What of the library a module knows: names and kinds alone or behind a dot in any string, or a piece of a kind, and symbols where they
    could be asked for."""
    nodes = list(ast.walk(module))
    named = {text for text in _literals(nodes) if text in NAMES or text in KINDS or text.rpartition(".")[2] in KINDS}
    return named | {text for text in _pieces(nodes) if _is_piece(text)} | ({*_keys(nodes)} & SYMBOLS) - {TIME_COLUMN}


def test_no_machinery_names_an_effect() -> None:
    # Truth: a new effect is one file, so nobody else may wait for its name. What is listed must be there, or the list grows old.
    found = {path: named for path, module in _modules() if (named := _named(module))}
    assert found == {path: words for path, (_, words) in OTHER_THINGS.items()}


@pytest.mark.parametrize(
    "source",
    [
        'x = values["sigma"]',
        'x = name.endswith("_sensor.lag")',
        'x = f"{axis}.gust"',
        'x = {"t_0": 1.0}',
        'KINDS = ("tilt",)',
        'x = effect.kind.startswith("quant")',
        'x = "spring" in name',
        'x = re.compile("dead.*")',
    ],
)
def test_one_that_is_named_would_be_seen(source: str) -> None:
    assert _named(ast.parse(source))


@pytest.mark.parametrize(
    "source", ['"""A gust of the azimuth.tilt."""', 'x = log["t_s"]', 'x = Limit(1.0, "s", "a gust")']
)
def test_what_names_none_is_left_alone(source: str) -> None:
    assert not _named(ast.parse(source))


def test_a_file_in_the_folder_is_all_that_a_new_effect_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = (ROOT / "sim" / "effects" / "quadratic_drag.py").read_text(encoding="utf-8")
    (tmp_path / "oil.py").write_text(source.replace(".quadratic_drag", ".oil"), encoding="utf-8")
    monkeypatch.setattr(sim.effects, "__path__", [*sim.effects.__path__, str(tmp_path)])
    known, found = sim.effects.FAMILIES, tuple(sim.effects._families())
    (new,) = set(found) - set(known)
    assert [family for family in found if family is not new] == list(known)
    assert found.index(new) == len(sim.effects.INNER)
    assert "azimuth.oil" in {effect.name for effect in new(MODELS["ce150"]())}


def test_a_role_is_one_number_s() -> None:
    for effect in EFFECTS:
        roles = [parameter.role for parameter in effect.parameters if parameter.role is not Role.NUMBER]
        assert len(roles) == len(set(roles)), effect.name
        assert not effect.swings or effect.having(Role.RATE, Role.WAVES), effect.name
        assert not effect.is_noise or (effect.having(Role.STRENGTH) and effect.having(Role.MEMORY)), effect.name


def test_what_is_believed_has_a_reason_and_lies_within_reach() -> None:
    for effect in EFFECTS:
        assert effect.prior.reason, effect.name
        for parameter in effect.parameters:
            unlikely = parameter.unlikely
            if unlikely is not None:
                assert unlikely.reason, effect.name
                assert unlikely.log_odds < 0.0, effect.name
                reached = unlikely.steps or parameter.lower < unlikely.below or unlikely.above < parameter.upper
                assert reached, effect.name


def test_a_role_that_an_effect_lacks_is_said() -> None:
    spring = next(effect for effect in EFFECTS if effect.name == "azimuth.cable_spring")
    with pytest.raises(LookupError, match=r"azimuth\.cable_spring has no INSTANT"):
        spring.symbol(Role.INSTANT)
