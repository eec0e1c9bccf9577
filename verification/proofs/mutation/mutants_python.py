"""Mutants of the Python twin: one change each in its equations or its arithmetic, run as a module of its own."""

import ast
import types
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_CODEGEN = Path(__file__).resolve().parents[3] / "codegen"
# Per arithmetic: the files that are the twin, later ones importing earlier ones, and the class of the last.
TWINS = {
    "float32": (("law_equations", "twin"), "Float32Twin"),
    "fixed": (("fixed/arithmetic", "fixed/equations", "fixed/twin"), "FixedTwin"),
}
_OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Add,
    ast.FloorDiv: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
_COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}


@dataclass(frozen=True)
class PythonMutant:
    """One change: the module, its line and its text, what is changed to what; `index` counts the places of change in the module."""

    place: str
    line: int
    change: str
    index: int
    source: str

    def __str__(self) -> str:
        return f"{self.place}.py:{self.line}: {self.change} in {self.source}"


def python_mutants(arithmetic: str) -> tuple[PythonMutant, ...]:
    """Every mutant of the twin's files, in the order of the text."""
    modules, _ = TWINS[arithmetic]
    found: list[PythonMutant] = []
    for module in modules:
        lines = (_CODEGEN / f"{module}.py").read_text(encoding="utf-8").splitlines()
        found += [
            PythonMutant(module, node.lineno, _change(node), index, lines[node.lineno - 1].strip())
            for index, node in enumerate(_mutable_nodes(_tree(module)))
        ]
    return tuple(found)


def mutated_twin(arithmetic: str, mutant: PythonMutant | None) -> Any:
    """The class of the twin with this change in its files, or as it is."""
    modules, name = TWINS[arithmetic]
    made: dict[str, types.ModuleType] = {}
    for module in modules:
        tree = _tree(module)
        if mutant is not None and mutant.place == module:
            _mutate(list(_mutable_nodes(tree))[mutant.index])
            ast.fix_missing_locations(tree)
        made[module] = _executed(module, tree, made)
    return getattr(made[modules[-1]], name)


def _tree(module: str) -> ast.Module:
    return ast.parse((_CODEGEN / f"{module}.py").read_text(encoding="utf-8"))


def _executed(module: str, tree: ast.Module, made: dict[str, types.ModuleType]) -> types.ModuleType:
    """The module from its tree; what it imports from the twin's other files comes from `made`."""
    own = types.ModuleType("codegen." + module.replace("/", "."))
    kept = []
    for statement in tree.body:
        imported = (statement.module or "") if isinstance(statement, ast.ImportFrom) else ""
        source = imported.removeprefix("codegen.").replace(".", "/")
        if isinstance(statement, ast.ImportFrom) and source in made:
            other = made[source]
            for alias in statement.names:
                setattr(own, alias.asname or alias.name, getattr(other, alias.name))
        else:
            kept.append(statement)
    tree.body = kept
    exec(compile(tree, f"{module}.py", "exec"), own.__dict__)
    return own


def _mutable_nodes(tree: ast.Module) -> Iterator[Any]:
    """Expressions inside functions that have a mutation; messages, annotations and defaults have none."""
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            for statement in function.body:
                yield from _in_statement(statement)


def _in_statement(statement: ast.AST) -> Iterator[Any]:
    if isinstance(statement, ast.FunctionDef | ast.Raise | ast.Assert):
        return
    for node in ast.iter_child_nodes(statement):
        if isinstance(statement, ast.AnnAssign) and node is statement.annotation:
            continue
        if _is_mutable(node):
            yield node
        yield from _in_statement(node)


def _is_mutable(node: ast.AST) -> bool:
    if isinstance(node, ast.BinOp):
        return type(node.op) in _OPERATORS
    if isinstance(node, ast.Compare):
        return type(node.ops[0]) in _COMPARISONS
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    return isinstance(node, ast.IfExp) or (isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Invert))


def _change(node: Any) -> str:
    before = ast.unparse(node)
    copy = ast.parse(before, mode="eval").body
    _mutate(copy)
    return f"{before} -> {ast.unparse(copy)}"[:110]


def _mutate(node: Any) -> None:
    """Change the node in place."""
    if isinstance(node, ast.BinOp):
        node.op = _OPERATORS[type(node.op)]()
    elif isinstance(node, ast.Compare):
        node.ops[0] = _COMPARISONS[type(node.ops[0])]()
    elif isinstance(node, ast.IfExp):
        node.body, node.orelse = node.orelse, node.body
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        node.value = node.value + 1
    else:
        node.op = ast.UAdd()
