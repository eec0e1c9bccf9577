"""The text of a file of equations run as a program: a Model, or the line where it goes wrong."""

import ast
import contextlib
import hashlib
import io
import sys
import traceback
from types import ModuleType
from typing import Any, TextIO

from records.errors import BadInput
from records.pages import page
from records.plant import Equations
from sim.model import Model

REMEDY = f"see {page('new-plant.md')}"
# What Python, math and NumPy say of a symbol where they need a number.
_NUMBER_WANTED = ("truth value", "to float", "to int", "ufunc")


def run_file(equations: Equations) -> Model:
    """The Model that the file's `model()` gives; raises BadInput naming file and line for whatever stops it.

    The file is a program and may do what any program of this user may. What it prints goes to stderr, where no answer stands.
    """
    model = _model(equations, sys.stderr)
    if _equations_of(model) != _equations_of(_model(equations, io.StringIO())):
        raise refused(
            equations, line_of(equations, "model"), "equations", "others at each run of the file", "the same at every run",
            "leave out what differs, a random number or the time of day",
        )  # fmt: skip
    return model


def _model(equations: Equations, printed: TextIO) -> Model:
    with contextlib.redirect_stdout(printed):
        try:
            function = _module(equations).__dict__.get("model")
            if not callable(function):
                got = "nothing called `model`" if function is None else f"`model` = {shown(function)}"
                raise refused(equations, 0, "equations", got, "a function model() that gives a Model", REMEDY)
            model = function()
        except BadInput:
            raise
        except SyntaxError as error:
            raise _syntax(equations, error) from error
        except (Exception, SystemExit) as error:
            raise _stopped(equations, error) from error
    if not isinstance(model, Model):
        got = f"model() gives {shown(model)}"
        raise refused(equations, line_of(equations, "model"), "equations", got, "a sim.model.Model", REMEDY)
    return model


def _equations_of(model: Model) -> str:
    """What of a model is equations, as text."""
    return repr((model.states, model.rates, model.axes, model.outputs, model.input_limits))


def refused(equations: Equations, line: int, what: str, got: str, expected: str, remedy: str) -> BadInput:
    """What is wrong with the equations, and where: at the line, or in the file as a whole at 0."""
    return BadInput(what, f"{equations.path}, line {line}" if line else equations.path, got, expected, remedy)


def shown(value: Any) -> str:
    """A value in few words."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


def line_of(equations: Equations, *words: str) -> int:
    """The first line with the first of these words that the file holds at all: a text, an argument, a function; 0: it holds none."""
    lines: dict[str, int] = {}
    for node in ast.walk(ast.parse(equations.text)):
        for word in _words(node):
            lines[word] = min(lines.get(word, sys.maxsize), node.lineno)  # type: ignore[attr-defined]
    return next((lines[word] for word in words if word in lines), 0)


def _words(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.FunctionDef):
        return [node.name]
    return [node.arg] if isinstance(node, ast.keyword) and node.arg else []


def _module(equations: Equations) -> ModuleType:
    """The file as a module under a name that no other text has: what it defines finds it there."""
    module = ModuleType(f"_equations_{hashlib.sha256(equations.text.encode()).hexdigest()[:16]}")
    module.__file__ = equations.path
    sys.modules[module.__name__] = module
    exec(compile(equations.text, equations.path, "exec"), module.__dict__)
    return module


def _syntax(equations: Equations, error: SyntaxError) -> BadInput:
    """A slip of the file itself; one of a file that it imports is told as any other end."""
    if error.filename != equations.path:
        return _stopped(equations, error)
    return refused(
        equations, error.lineno or 0, "equations", f"no Python ({error.msg})", "a Python file", "mend that line"
    )


def _stopped(equations: Equations, error: BaseException) -> BadInput:
    lines = [
        frame.lineno or 0 for frame in traceback.extract_tb(error.__traceback__) if frame.filename == equations.path
    ]
    told = " ".join(str(error).split())[:300]
    got = f"{type(error).__name__}: {told}" if told else type(error).__name__
    remedy = "mend that line"
    if isinstance(error, KeyError):
        remedy = "nothing of that name is declared: give it a ParameterSpec, or correct the name"
    if isinstance(error, ModuleNotFoundError):
        remedy = "the equations are this one file: what it imports must be installed, or stand in it"
    if isinstance(error, TypeError) and any(words in told for words in _NUMBER_WANTED):
        remedy = "names are symbols here: take sympy's sin, Abs, Max in place of math's or NumPy's, and sympy.Piecewise for a choice"
    return refused(equations, lines[-1] if lines else 0, "equations", got, "equations that run", remedy)
