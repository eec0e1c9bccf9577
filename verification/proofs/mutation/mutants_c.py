"""Mutants of a C text in one program: every mutation is compiled in beside the original and chosen by number at run time.

An expression e with the mutation e' becomes (law_mutant == k ? e' : e), a statement is left out when its number is chosen, and the
tables at file scope are written anew for each choice. So hundreds of mutants cost one compilation.
"""

import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pycparser import c_ast, c_generator, c_parser

from codegen.numbers import c_float32
from toolchain.host import run_zig

_HEADERS = {
    "stdint.h": "typedef signed char int8_t;\ntypedef unsigned char uint8_t;\ntypedef short int16_t;\n"
    "typedef unsigned short uint16_t;\ntypedef int int32_t;\ntypedef unsigned int uint32_t;\n"
    "typedef long long int64_t;\ntypedef unsigned long long uint64_t;\n"
    "#define INT32_MAX 0x7FFFFFFF\n#define INT32_MIN (-INT32_MAX - 1)\n#define UINT32_MAX 0xFFFFFFFFu\n",
    "stdbool.h": "#define bool _Bool\n#define true 1\n#define false 0\n",
    "stddef.h": "typedef unsigned long size_t;\n#define NULL ((void *)0)\n",
    "float.h": "#define FLT_EVAL_METHOD 0\n",
}
_SWAPS = {"+": "-", "-": "+", "*": "+", "/": "*", "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
_SWAPS |= {"&": "|", "|": "&", "^": "|", "<<": ">>", ">>": "<<", "&&": "||", "||": "&&"}


@dataclass(frozen=True)
class Mutant:
    """One mutation: its number, the function or table it is in, and what is changed to what."""

    number: int
    place: str
    change: str

    def __str__(self) -> str:
        return f"{self.place}: {self.change}"


@dataclass(frozen=True)
class MutatedC:
    """A C text that holds all its mutants; `void law_choose_mutant(int)` chooses one, 0 none of them."""

    text: str
    mutants: tuple[Mutant, ...]


def mutated_c(texts: dict[str, str], name: str) -> MutatedC:
    """All mutants of the file `name` among `texts`; its headers are read, not mutated."""
    tree = c_parser.CParser().parse(preprocessed(texts, name))
    made = _Made()
    for item in tree.ext:
        if isinstance(item, c_ast.FuncDef):
            made.place = item.decl.name
            _mutate_children(item.body, made)
        elif isinstance(item, c_ast.Decl) and item.init is not None and item.name != "LAW_TABLE_DIGEST":
            _mutate_table(item, made)
    body = c_generator.CGenerator().visit(tree)
    choose = "\n".join(["void law_choose_mutant(int number)", "{", "law_mutant = number;", *made.table_lines, "}\n"])
    declared = "int law_mutant;\nvoid law_choose_mutant(int number);\n"
    return MutatedC(declared + body + choose, tuple(made.mutants))


def preprocessed(texts: dict[str, str], name: str) -> str:
    """The file with its headers and macros resolved, by the compiler that builds the law."""
    with tempfile.TemporaryDirectory() as work:
        for file, text in {**_HEADERS, **texts}.items():
            (Path(work) / file).write_text(text, encoding="utf-8")
        out = Path(work) / "preprocessed.i"
        plain = ["-U__clang__", "-nostdinc"]  # what is for that compiler alone is assembly, and no C
        run_zig(["cc", "-E", "-P", *plain, f"-I{work}", str(Path(work) / name), "-o", str(out)], name)
        return re.sub(r"^#.*$", "", out.read_text(encoding="utf-8"), flags=re.MULTILINE)


@dataclass
class _Made:
    """The mutants made so far, and where the walk is."""

    mutants: list[Mutant] = field(default_factory=list)
    table_lines: list[str] = field(default_factory=list)
    place: str = ""

    def number(self, change: str) -> int:
        """The number of a new mutant."""
        self.mutants.append(Mutant(len(self.mutants) + 1, self.place, change))
        return len(self.mutants)

    def chosen(self, number: int) -> c_ast.Node:
        return c_ast.BinaryOp("==", c_ast.ID("law_mutant"), c_ast.Constant("int", str(number)))


def _mutate_children(node: c_ast.Node, made: _Made) -> None:
    """Wrap every mutable expression below `node`, inner ones first."""
    for slot, child in node.children():
        if isinstance(child, c_ast.Decl) and "static" in (child.storage or []):
            _mutate_constant_reads(child, made)
            continue
        if isinstance(child, c_ast.Typename | c_ast.TypeDecl):
            continue
        if slot == "name" or (isinstance(node, c_ast.StructRef) and slot == "field"):
            continue
        if isinstance(node, c_ast.NamedInitializer) and slot.startswith("name"):
            continue
        if isinstance(node, c_ast.ArrayRef) and isinstance(child, c_ast.Constant) and child.value == "0":
            continue  # the row before the first is none of the table's
        if isinstance(node, c_ast.ArrayRef) and isinstance(child, c_ast.Constant):
            before = c_ast.Constant("int", str(int(child.value) - 1))
            number = made.number(f"{_text(node)}: row {child.value} -> row {before.value}")
            _put(node, slot, c_ast.TernaryOp(made.chosen(number), before, child))
            continue
        changes = [f"{_text(child)} -> {_text(after)}" for after in _mutations(child)]
        _mutate_children(child, made)
        is_target = slot == "lvalue" or (isinstance(node, c_ast.UnaryOp) and node.op in ("&", "sizeof", "++", "--"))
        if not is_target:
            _put(node, slot, _wrapped(child, changes, made))


def _wrapped(node: c_ast.Node, changes: list[str], made: _Made) -> c_ast.Node:
    """The expression with its mutations beside it."""
    for after, change in zip(list(_mutations(node)), changes, strict=True):
        node = c_ast.TernaryOp(made.chosen(made.number(change)), after, node)
    return node


def _text(node: c_ast.Node) -> str:
    """An expression as C text on one line, cut short where it is long."""
    return str(" ".join(c_generator.CGenerator().visit(node).split())[:90])


def _mutations(node: c_ast.Node) -> Iterator[c_ast.Node]:
    if isinstance(node, c_ast.BinaryOp) and node.op in _SWAPS:
        yield c_ast.BinaryOp(_SWAPS[node.op], node.left, node.right)
    elif isinstance(node, c_ast.UnaryOp) and node.op in ("-", "!", "~"):
        yield node.expr
    elif isinstance(node, c_ast.Constant):
        yield c_ast.Constant(node.type, _next_constant(node))
    elif isinstance(node, c_ast.TernaryOp):
        yield c_ast.TernaryOp(node.cond, node.iffalse, node.iftrue)
    elif isinstance(node, c_ast.Assignment):
        yield node.lvalue  # the statement is left out


def _next_constant(node: c_ast.Constant) -> str:
    """A float up by 1/256, zero to one; an integer one down, 0 and 1 one up; its suffix stays."""
    if "float" in node.type or "double" in node.type:
        return c_float32(float(node.value.rstrip("fF")) * 257.0 / 256.0 or 1.0)
    digits = node.value.rstrip("uUlL")
    value = int(digits, 0)
    return f"{value - 1 if value > 1 else value + 1}{node.value[len(digits) :]}"


def _mutate_table(table: c_ast.Decl, made: _Made) -> None:
    """A constant table becomes a variable that each choice writes anew."""
    made.place = table.name
    table.storage, table.quals = [], []
    kind = table.type.type if isinstance(table.type, c_ast.ArrayDecl) else table.type
    kind.quals = []
    entries = [(_designator(entry), entry.expr) for entry in table.init.exprs]
    is_array = isinstance(table.type, c_ast.ArrayDecl)
    largest = max((abs(_number(expression)) for _, expression in entries), default=0.0)
    for place, expression in entries:
        value = _number(expression)
        is_float = "." in c_generator.CGenerator().visit(expression)
        changed = _next_number(value, largest if is_array else value) if is_float else value + 1
        text, other = (c_float32(value), c_float32(changed)) if is_float else (str(int(value)), str(int(changed)))
        number = made.number(f"{place.strip('.')} {text} -> {other}")
        made.table_lines.append(f"{table.name}{place} = (number == {number}) ? {other} : {text};")


def _mutate_constant_reads(table: c_ast.Decl, made: _Made) -> None:
    """A table inside a function becomes automatic, its numbers wrapped as any other."""
    table.storage, table.quals = [], []
    for entry in table.init.exprs:
        _mutate_children(entry, made)


def _designator(entry: c_ast.NamedInitializer) -> str:
    (name,) = entry.name
    return f".{name.name}" if isinstance(name, c_ast.ID) else f"[{name.expr.value}]"


def _number(expression: c_ast.Node) -> float:
    """The value of a literal with or without a sign."""
    if isinstance(expression, c_ast.UnaryOp) and expression.op == "-":
        return -_number(expression.expr)
    text = expression.value
    return float(text.rstrip("fF")) if "." in text or "e" in text else float(int(text.rstrip("uU"), 0))


def _next_number(value: float, scale: float) -> float:
    """One ulp of `scale` up: in a polynomial's table an ulp of its largest coefficient, in which its value is rounded."""
    return value + float(np.spacing(np.float32(scale or 1.0)))


def _put(node: c_ast.Node, slot: str, child: c_ast.Node) -> None:
    """Replace a child of a syntax tree: `slot` is a field, or field[index]."""
    name, bracket, index = slot.partition("[")
    if bracket:
        getattr(node, name)[int(index.rstrip("]"))] = child
    else:
        setattr(node, name, child)
