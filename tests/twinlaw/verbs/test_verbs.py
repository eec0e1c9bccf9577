"""Each verb explains itself; asking for one loads no other; every file of the verbs' folder is a verb."""

import subprocess
import sys
from pathlib import Path

import pytest

from twinlaw import verbs
from twinlaw.cli.completion import command_tree
from twinlaw.command import main
from twinlaw.verbs import VERBS, build_parser, verb_module, verb_text
from twinlaw.workflows.chain.arithmetics import ARITHMETICS


@pytest.mark.parametrize("word", VERBS)
def test_a_verb_explains_itself(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main([word, "--help"])
    assert left.value.code == 0
    assert verb_text(word) == (verb_module(word).__doc__ or "").strip()
    assert " ".join(verb_text(word).split()[:6]) in " ".join(capsys.readouterr().out.split())


def test_every_file_is_a_verb() -> None:
    files = {path.stem for path in Path(str(verbs.__file__)).parent.glob("*.py")} - {"__init__"}
    assert files == set(VERBS.values())


def test_the_list_of_verbs_loads_none_of_their_tools() -> None:
    program = (
        "import sys\nfrom twinlaw.command import main\n"
        "try: main(['--help'])\nexcept SystemExit: pass\n"
        "print(sorted({'scipy', 'sympy', 'matplotlib', 'control'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_every_verb_that_makes_or_runs_the_generated_law_takes_its_arithmetic_and_in_the_same_words() -> None:
    # `diagnose` finds out what flew; `compare` has controllers that exist in float32 only.
    offers = {}
    for verb in command_tree(build_parser(tuple(VERBS))).commands:
        flags = {flag: option for option in verb.options for flag in option.flags}
        if "--arithmetic" in flags:
            offers[verb.last] = flags["--arithmetic"].words
        assert "--table" not in flags or "--arithmetic" in flags, verb.last
    assert offers.pop("simulate") == ("float64", *ARITHMETICS)
    assert set(offers) == {
        "run",
        "design",
        "generate",
        "build",
        "verify",
        "trace",
        "flash",
        "validate",
        "watch",
        "bench",
    }
    assert set(offers.values()) == {tuple(ARITHMETICS)}


def test_every_verb_that_tells_anything_tells_it_to_a_program_too() -> None:
    # `completion` prints a script, and nothing beside it.
    below = (command for verb in command_tree(build_parser(tuple(VERBS))).commands for command in verb.all)
    mute = [
        entry.at
        for entry in below
        if not entry.commands and "--json" not in {f for o in entry.options for f in o.flags}
    ]
    assert mute == ["completion"]
