"""The language of a mapping: arithmetic over the signals of a file, read with `ast` and never evaluated as Python.

    expression  :=  number | pi | nan | reference | - expression | expression OP expression | FUNCTION(expression, ...)
    OP          :=  + - * / ^, and the same with MATLAB's dot before them
    reference   :=  name [pick], the name as in the file: run1.psi_rad, ScopeData.signals(2).values, 'Elevation [deg]'
    pick        :=  (:,2) a column, (1,:) a row, counted from 1 as MATLAB does; [1] or [:,1] a column counted from 0

A name that is no Python name needs no quotes where the file has it. A factor or divisor of constants that is 0, or any constant beside a
signal that is no finite number, is refused when it is read.
"""

import ast
import keyword
import re
from collections.abc import Collection, Mapping

import numpy as np

from recordings.mapping.evaluation import (
    FUNCTIONS,
    BadExpression,
    Node,
    Number,
    Operation,
    Quantity,
    Reference,
    evaluate,
)

LONGEST = 500  # characters, and terms within terms: a mapping is typed by hand
DEEPEST = 50
CONSTANTS: Mapping[str, float] = {"pi": float(np.pi), "nan": float("nan")}
_SIGNS: Mapping[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "^"}


def parse(text: str, names: Collection[str] = ()) -> Node:
    """The tree of an expression; `names` are those of the file, of which one that is no Python name is found as it stands.

    Raises BadExpression.
    """
    if len(text) > LONGEST:
        raise BadExpression(f"{len(text)} characters, more than {LONGEST}")
    if text.strip() in names:
        return Reference(text.strip())
    plain, stands_for = _with_plain_names(text.strip(), names)
    try:
        tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        comma = "a decimal comma; write a point" if re.search(r"\d,\d", plain) else ""
        raise BadExpression(comma or "no expression; a name with blanks or signs needs quotes: 'Psi [deg]'") from error
    if _depth(tree) > DEEPEST:
        raise BadExpression(f"more than {DEEPEST} terms within terms")
    node = _node(tree, stands_for)
    if isinstance(node, Number) and not (np.isfinite(node.value) or text.strip().lower() == "nan"):
        raise BadExpression(f"{node.value} is no number")
    return node


def _with_plain_names(text: str, names: Collection[str]) -> tuple[str, Mapping[str, str]]:
    """The text as Python reads it: odd names and quoted ones by stand-ins, ranges `:` as `...`, MATLAB's operators."""
    stands_for: dict[str, str] = {}

    def stand_in(name: str) -> str:
        stands_for[f"_name_{len(stands_for)}_"] = name
        return f" _name_{len(stands_for) - 1}_ "

    there = (
        name for name in names if name in text and re.search(r"[^\W\d]", name)
    )  # a heading "2" would take the place of a number
    odd = sorted((name for name in there if not _is_plain(name)), key=len, reverse=True)
    found = "|".join(_bounded(name) for name in odd)
    quoted = r"'([^']*)'|\"([^\"]*)\"|`([^`]*)`"
    pattern = re.compile(f"{quoted}|({found})" if found else quoted)
    pieces = pattern.sub(lambda match: stand_in(next(part for part in match.groups() if part is not None)), text)
    if "#" in pieces:
        raise BadExpression("'#' in it; a name with signs needs quotes")
    pieces = re.sub(r"\.([*/^])", r"\1", pieces).replace("^", "**").replace(":", "...")
    return pieces.strip(), stands_for


def _bounded(name: str) -> str:
    """The pattern of a name that is no part of a longer word."""
    before, after = (r"\b" if name[end].isalnum() else "" for end in (0, -1))
    return f"{before}{re.escape(name)}{after}"


def _is_plain(name: str) -> bool:
    """Whether Python reads the name as it stands."""
    parts = re.sub(r"[\[(]\d+[\])]", "", name).split(".")
    return all(part.isascii() and part.isidentifier() and not keyword.iskeyword(part) for part in parts)


def _node(tree: ast.expr, stands_for: Mapping[str, str]) -> Node:
    if isinstance(tree, ast.Constant) and isinstance(tree.value, int | float) and not isinstance(tree.value, bool):
        return _number(tree.value)
    if isinstance(tree, ast.Name) and tree.id in CONSTANTS:
        return Number(CONSTANTS[tree.id])
    if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, (ast.USub, ast.UAdd)):
        inner = _node(tree.operand, stands_for)
        return inner if isinstance(tree.op, ast.UAdd) else _operation("negative", (inner,))
    if isinstance(tree, ast.BinOp) and type(tree.op) in _SIGNS:
        sides = (_node(tree.left, stands_for), _node(tree.right, stands_for))
        return _operation(_SIGNS[type(tree.op)], sides)
    if isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name) and _is_function(tree):
        function = FUNCTIONS[tree.func.id]
        if len(tree.args) not in function.arguments or tree.keywords:
            raise BadExpression(f"{tree.func.id}() with {len(tree.args)} arguments")
        return _operation(tree.func.id, tuple(_node(argument, stands_for) for argument in tree.args))
    if isinstance(tree, (ast.Name, ast.Attribute, ast.Call, ast.Subscript)):
        return _reference(tree, stands_for)
    if isinstance(tree, ast.Tuple):
        raise BadExpression("a comma in it; a decimal sign is a point")
    raise BadExpression("more than numbers, names, picks, + - * / ^ and functions")


def _depth(tree: ast.AST) -> int:
    """How many terms stand within one another, counted layer by layer."""
    layer, depth = [tree], 0
    while layer:
        layer = [child for node in layer for child in ast.iter_child_nodes(node)]
        depth += 1
    return depth


def _is_function(tree: ast.Call) -> bool:
    ranges = any(isinstance(argument, ast.Constant) and argument.value is ... for argument in tree.args)
    return isinstance(tree.func, ast.Name) and tree.func.id in FUNCTIONS and not ranges


def _number(value: float) -> Number:
    try:
        return Number(float(value))
    except OverflowError as error:
        raise BadExpression("a number with too many digits") from error


def _operation(name: str, arguments: tuple[Node, ...]) -> Node:
    """Constants are worked out at once; one beside a signal must be finite, and as a factor or divisor not 0."""
    if all(isinstance(argument, Number) for argument in arguments):
        worked_out = evaluate(Operation(name, arguments), lambda reference: Quantity(np.zeros(())), lambda unit: 0.0)
        if not np.isfinite(worked_out.values):
            raise BadExpression("a constant in it is no finite number")
        return Number(float(worked_out.values))
    for argument in arguments:
        if isinstance(argument, Number) and not np.isfinite(argument.value):
            raise BadExpression(f"{argument.value} is no finite number")
        if isinstance(argument, Number) and argument.value == 0.0 and name in "*/":
            raise BadExpression("a factor of 0" if name == "*" or argument is arguments[0] else "a division by 0")
    return Operation(name, arguments)


def _reference(tree: ast.expr, stands_for: Mapping[str, str]) -> Reference:
    if isinstance(tree, ast.Name):
        return Reference(stands_for.get(tree.id, tree.id))
    if isinstance(tree, ast.Attribute):
        return Reference(f"{_reference(tree.value, stands_for).text}.{tree.attr}")
    if isinstance(tree, ast.Call) and not tree.keywords:
        base = _named(tree.func, stands_for)
        numbers = [_index(argument) for argument in tree.args]
        shown = ",".join(":" if number is None else str(number) for number in numbers)
        if 0 in numbers:
            raise BadExpression(f"{base}({shown}) counts from 0, (...) from 1 as MATLAB does")
        return Reference(f"{base}({shown})", base, tuple(None if number is None else number - 1 for number in numbers))
    if isinstance(tree, ast.Subscript):
        base = _named(tree.value, stands_for)
        entries = tree.slice.elts if isinstance(tree.slice, ast.Tuple) else [tree.slice]
        numbers = [_index(entry) for entry in entries]
        shown = ",".join(":" if number is None else str(number) for number in numbers)
        return Reference(f"{base}[{shown}]", base, (None, numbers[0]) if len(numbers) == 1 else tuple(numbers))
    raise BadExpression("more than names, (:,2) and [1] in a reference")


def _named(tree: ast.expr, stands_for: Mapping[str, str]) -> str:
    if not isinstance(tree, (ast.Name, ast.Attribute, ast.Call, ast.Subscript)):
        raise BadExpression("a pick of what is no signal")
    return _reference(tree, stands_for).text


def _index(tree: ast.expr) -> int | None:
    if isinstance(tree, ast.Constant) and tree.value is ...:
        return None
    if isinstance(tree, ast.Constant) and type(tree.value) is int and 0 <= tree.value < 2**31:
        return tree.value
    raise BadExpression("a pick that is neither ':' nor a whole number")
