"""Tables of pages hold what commands wrote: row by row, to the digits of the page."""

import json
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from recordings.datasets.files import datasets_folder
from records.text.units import unit_of
from tests.docs.reading.commands import fenced
from tests.docs.reading.numbers import NUMBER, agrees, last_digit
from tests.docs.reading.results import COMMANDS, FOLDER, HOURS, made, result
from tests.docs.reading.tables import line
from tests.docs.test_files import KNOWN
from tests.real_rigs import parts
from tests.test_project import ROOT
from twinlaw.cli import console
from twinlaw.workflows.diagnose.each import HEADING, row

BLIND = (ROOT / "docs" / "blind.md").read_text(encoding="utf-8")
REAL = (ROOT / "docs" / "real-data.md").read_text(encoding="utf-8")
SEEDS = (ROOT / "docs" / "seeds.md").read_text(encoding="utf-8")


def rows(beginning: str, page: str = SEEDS) -> Iterator[list[str]]:
    """The cells of each row of the table whose heading begins so; a number in each as it is written, an empty cell where there is none."""
    lines = page[page.index(beginning) :].splitlines()[2:]
    for told in lines:
        if not told.startswith("|"):
            return
        yield [cell.strip().removesuffix(" %").removeprefix("+") for cell in told.strip("|").split("|")]


def hold(numbers: list[str], keys: list[str], factors: tuple[float, ...] = ()) -> None:
    """Each number is what its key of a result gives, times its factor."""
    for number, key, factor in zip(numbers, keys, factors or (1,) * len(keys), strict=True):
        assert agrees(number, f"{factor}*results.{key}"), (number, key)


def test_every_result_has_its_command_and_its_file() -> None:
    assert {path.stem for path in FOLDER.glob("*.json")} == {*COMMANDS, *HOURS}


@pytest.mark.soak
@pytest.mark.parametrize("name", COMMANDS)
def test_a_result_is_what_its_commands_print(name: str) -> None:
    if name.startswith("real_") and not datasets_folder().is_dir():
        pytest.skip(f"no recordings in {datasets_folder()}: see recordings/datasets/registry.toml")
    # Within 5 %, or a thousandth: so far other processors may move a figure; a change of the program that the file missed moves it further.
    # How far two flights differ hangs on which encoder step comes a row earlier in one of them, and that on the last digits: a fifth.
    told, stored = (dict(leaves(found)) for found in (json.loads(made(name)), result(name)))
    assert set(told) == set(stored)
    for key, value in stored.items():
        reach = 0.2 if ".flight_rms." in key else 0.05
        assert told[key] == (pytest.approx(value, rel=reach, abs=1e-3) if isinstance(value, float) else value), key


def leaves(found: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of a result by the keys that lead to it."""
    entries = found.items() if isinstance(found, dict) else enumerate(found) if isinstance(found, list) else ()
    if not isinstance(found, dict | list):
        yield key, found
    for name, entry in entries:
        yield from leaves(entry, f"{key}.{name}")


def test_the_coverage_of_60_sets_of_flights_is_what_the_sweep_counted() -> None:
    found = result("sweep_coverage")["parameters"]
    told = [cells for row in rows("| | true | mean |") for cells in (row[:6], row[6:]) if cells[0]]
    assert {cells[0] for cells in told} == set(found)
    for name, *cells in told:
        keys = [f"sweep_coverage.parameters.{name}.{key}" for key in ("true", "mean", "scatter", "stated", "inside")]
        hold(cells, keys, (1, 1, 1, 1, 100))


def test_the_intervals_of_100_rigs_hold_the_truth_as_often_as_the_page_says() -> None:
    page = (ROOT / "docs" / "identification.md").read_text(encoding="utf-8")
    told = {name: share for share, names in rows("| inside | parameters |", page) for name in names.split(", ")}
    assert set(told) == set(result("coverage")["coverage"])
    hold(list(told.values()), [f"coverage.coverage.{name}" for name in told], (100,) * len(told))


def test_the_genetic_algorithm_s_table_is_what_the_identification_wrote() -> None:
    for stage, cells in zip("0000111223", rows("| stage | parameter | the paper"), strict=True):
        name = cells[1].split()[0]
        search, own = f"velagic.stages.{stage}.searches", f"velagic.estimates.{name}"
        hold(
            [cells[2], cells[3], cells[6]],
            [f"velagic.truth.{name}", f"{search}.0.values.{name}", f"{own}.value"],
        )
        truth = result("velagic")["truth"][name]
        for number, place in ((cells[4], 0), (cells[5], 1)):
            found = result("velagic")["stages"][int(stage)]["searches"][place]["values"][name]
            assert 100.0 * (found / truth - 1.0) == pytest.approx(float(number), abs=0.51 * last_digit(number))
        assert agrees(cells[7], f"100*results.{own}.sd/results.{own}.value")


def test_how_fast_the_fit_is_stands_in_both_pages_as_bench_measured_it() -> None:
    took, *ratios = re.findall(r"(\S+) s, (\S+) times faster than SciPy and (\S+) times faster than lmfit", SEEDS)[0]
    hold([took, *ratios], ["bench.fits.0.cpu_s", "bench.fits.2.ratio", "bench.fits.3.ratio"])


def test_how_fast_each_tool_flies_is_what_bench_measured() -> None:
    page = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    told = {tool: cells for tool, *cells in rows("| tool | simulated s", page)}
    measured = result("bench")["closed_loop"]
    assert set(told) == {entry["tool"] for entry in measured}
    for entry in measured:
        for cell, key in zip(
            told[entry["tool"]], ("simulated_s_per_cpu_s", "kernel_ratio", "batch_ratio"), strict=True
        ):
            assert (cell == "") == (entry[key] is None)
            assert not cell or _rounded(entry[key], cell) == float(cell.replace(" ", "")), (entry["tool"], key)


def _rounded(number: float, cell: str) -> float:
    """To as many digits as a page's number has; zeros at the end of a whole one are none."""
    digits = re.sub(r"\D", "", cell)
    return float(f"{number:.{len(digits if '.' in cell else digits.rstrip('0'))}g}")


def test_the_answer_to_a_folder_of_logs_is_what_the_command_prints() -> None:
    shown = fenced("docs/sweeps.md", "text")
    assert shown == [f"{console.table(map(row, result('each')['answers']), HEADING)}\n"]


def test_a_table_s_row_that_is_off_by_its_last_digit_is_seen() -> None:
    number = next(rows("| stage | parameter | the paper"))[6]
    wrong = re.sub(r"\d$", lambda last: str((int(last[0]) + 2) % 10), number)
    assert agrees(number, "results.velagic.estimates.a_1.value")
    assert not agrees(wrong, "results.velagic.estimates.a_1.value")


def test_results_are_in_the_project() -> None:
    assert not KNOWN or {f"docs/results/{name}.json" for name in COMMANDS} <= set(KNOWN)


def test_the_splits_of_real_rigs_are_those_that_were_diagnosed() -> None:
    for part in parts(result("real_rigs")):
        assert f"\n{part}\n" in REAL, part[:200]


@pytest.mark.parametrize(
    ("page", "heading", "name"),
    [
        ("faults", "| count | frames |", "million_frames"),
        ("faults", "| count | |", "million_steps"),
        ("proofs", "| arithmetic | given |", "cycles"),
    ],
)
def test_a_table_is_what_its_program_counted(page: str, heading: str, name: str) -> None:
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    _, *told = text[text.index(heading) :].split("\n\n")[0].splitlines()[1:]
    assert told == [line(row) for row in result(name)]


def _identified(dataset: str, told: str) -> Any:
    """The result that a row of the table of real rigs begins, None where no command is kept for it."""
    name = f"real_{dataset}{'_frequency' if 'frequency' in told else ''}"
    return result(name) if name in COMMANDS else None


def test_the_parameters_of_real_rigs_are_those_that_were_identified() -> None:
    found: Any = None
    for dataset, told, parameter, _, shown, fits in rows("| dataset | fitted, options |", REAL):
        found = _identified(dataset, told) if dataset else found
        if found is None:
            continue
        entry = next(entry for entry in found["estimates"] if entry["name"] == parameter.split()[0])
        interval = re.match(rf"({NUMBER}) \(({NUMBER}) \.\. ({NUMBER})\)", shown)
        assert ("at its bound" in shown) == (entry["name"] in found["at_bound"]), parameter
        assert ("not identified" in shown) == (not entry["identified"]), parameter
        for number, key in zip(interval.groups() if interval else (), ("value", "lower", "upper"), strict=False):
            assert abs(float(number) - entry[key]) <= 0.5001 * last_digit(number), (dataset, parameter, key)
        for record, number in re.findall(r"(\w+) (\d+(?:\.\d+)?)(?: %|$)", fits):
            for check in found.get("holdout") or []:
                if check["run"].endswith(record):
                    assert abs(float(number) - 100.0 * check["fit"]) <= 0.5001 * last_digit(number), (dataset, record)
        checks = found.get("frequency", {}).get("checks", [])
        if "published set" in fits:
            told_fits = [float(share) for share in re.findall(r"(\d+) %", fits)]
            kept_fits = [100.0 * share for check in checks for share in (*check["fit"], *check["stated_fit"])]
            assert told_fits == pytest.approx(kept_fits, abs=0.5001)


def _held_out(dataset: str) -> Iterator[list[str]]:
    """The rows of what a rig's held-out records leave."""
    for check in result(f"real_{dataset}")["holdout"]:
        unit, p = unit_of(check["channel"]), check["whiteness_p"]
        left, alone = (f"{check[key]:.2g} {unit}" for key in ("rms", "noise"))
        yield [
            dataset,
            check["run"].partition("-")[2],
            check["channel"],
            left,
            alone,
            "no, below 1e-300" if p == 0.0 else f"no, {p:.0e}",
        ]


def test_what_held_out_records_of_real_rigs_leave_is_what_the_command_wrote() -> None:
    rigs = ("emps", "aeroshield", "quanser_aero", "antx_2dof_drone", "pamh_aeropendulum", "aeroshield_two_clocks")
    assert list(rows("| dataset | held out |", REAL)) == [entry for rig in rigs for entry in _held_out(rig)]


def _share(cases: list[Any], is_right: Callable[[Any], bool]) -> str:
    return f"{sum(map(is_right, cases))} of {len(cases)}"


def _fresh(found: Any) -> list[str]:
    """The column of the table of three families that a score gives."""
    judged = found["judgements"]
    left = {least: [j for j in judged if j["severity_after_retune"] >= least] for least in (1, 2)}
    severe = [j for j in left[2] if j["kind"] != "nominal"]
    seen = [j for j in severe if j["detected"]]
    single = [j for j in left[1] if len(j["effects"]) == 1 and j["kind"] != "outside"]
    several = [j for j in left[1] if len(j["effects"]) > 1]
    outside = [j for j in severe if j["kind"] == "outside"]
    return [
        _share([j for j in judged if j["kind"] == "nominal"], lambda j: j["detected"]),
        _share(severe, lambda j: j["detected"]),
        _share(seen, lambda j: j["place_right"]),
        _share(single, lambda j: j["rank"] == 1),
        _share(several, lambda j: j["rank"] == 1),
        _share(outside, lambda j: j["place_right"] and (not j["found"] or j["rank"] == 1)),
        _share([j for j in severe if j["kind"] != "outside"], lambda j: j["left_out"]),
        _share([within for j in seen for within in j["within_interval"]], bool),
    ]


def test_the_figures_of_three_families_are_those_of_their_scores() -> None:
    found = [result(f"blind_fresh_{name}") for name in ("first", "second", "real")]
    heading = f"|figure|first, {found[0]['cases']}|second, {found[1]['cases']}|real, {found[2]['cases']}|"
    told = [cells for _, *cells in rows(heading, BLIND)][:8]
    assert told == [list(line) for line in zip(*map(_fresh, found), strict=True)]


def test_the_cases_of_three_families_that_are_told_otherwise_are_those_of_their_scores() -> None:
    judged = [
        (family, entry)
        for family in ("first", "second", "real")
        for entry in result(f"blind_fresh_{family}")["judgements"]
        if entry["severity_after_retune"] >= 2 and entry["kind"] != "nominal"
    ]
    nameless = {True: "nothing named", False: "no gap"}
    otherwise = [
        [
            family,
            " + ".join(sorted(entry["effects"])),
            " + ".join(sorted(entry["found"])) or nameless[entry["detected"]],
        ]
        for family, entry in judged
        if not entry["detected"] or entry["rank"] != 1
    ]
    assert list(rows("|family|truth|told|", BLIND)) == otherwise


def test_what_the_page_says_of_300_cases_beside_their_tables_is_in_their_score() -> None:
    found = result("blind_first_rig")["diagnose"]
    figures = {entry["name"]: entry for entry in found["figures"]}

    def missed(name: str) -> str:
        return f"{round((1.0 - figures[name]['value']) * figures[name]['cases'])} of {figures[name]['cases']} "

    assert f"**Pairs**: {missed('two effects, both named')}" in BLIND
    assert f"**Outside**: {missed('out of library: no wrong name, place right')}" in BLIND
    every, whole = (figures[f"hold-out shrinkage, tenth percentile{what}"] for what in ("", ", no frames lost"))
    assert f"**Shrinkage**: {every['cases'] - whole['cases']} of {every['cases']} lost frames" in BLIND
    assert f"its tenth percentile is {whole['value']:.3f}." in BLIND


def test_what_the_page_says_of_all_fresh_cases_is_in_their_score() -> None:
    found = result("blind_fresh_together")
    assert f"All {found['cases']} of seeds" in BLIND
    figures = {entry["name"]: entry for entry in found["figures"]}
    for name, value, interval, cases in rows("|figure|value|95 % interval|cases|", BLIND):
        own = figures[name]
        assert value == _shown(own["value"])
        assert (interval, cases) == (" to ".join(map(_shown, own["interval"])), str(own["cases"]))
    counted = [(entry["count"], entry["stated"]) for entry in found["reliability"]]
    total = sum(count for count, _ in counted)
    # |mean of n honest answers - p| is on average sqrt(2 p (1 - p) / pi n)
    chance = sum(count / total * (2.0 * p * (1.0 - p) / (np.pi * count)) ** 0.5 for count, p in counted)
    assert f"Of the {found['cases']} fresh cases" in BLIND
    error = _shown(figures["expected calibration error"]["value"])
    assert f"Their calibration error is {error}; honest answers would have one of {chance:.2f}." in BLIND


def one_line(text: str) -> str:
    return " ".join(text.split())


def test_what_the_learned_law_is_made_of_is_told_as_its_file_says() -> None:
    law = json.loads((ROOT / "diagnosis" / "decide" / "comparison.json").read_text(encoding="utf-8"))
    together, real = law["out_of_family"], law["families"]["real"]
    assert f"is learned from {together['answers']} answers of {law['commit']} " in BLIND
    errors = [f"{told[key]:.2f}" for told in (together, real) for key in ("calibration_error", "honest")]
    assert "others' law: {}, honest {}; the real one {}, honest {}.".format(*errors) in BLIND


def _shown(value: float | None) -> str:
    return "no case" if value is None else f"{value:.3f}"


def test_the_figures_of_300_cases_are_those_of_their_scores() -> None:
    found = {name: told for name, told in result("blind_first_rig").items() if name not in ("engine", "seed")}
    heading = "|figure|diagnose|95 % interval|cases|target|met|bic|residual-size|sparse-regression|"
    told = [[cell.strip() for cell in cells] for cells in rows(heading, BLIND)]
    figures = {name: {entry["name"]: entry for entry in score["figures"]} for name, score in found.items()}
    assert [cells[0] for cells in told] == list(figures["diagnose"])
    for name, value, interval, cases, target, met, *plain in told:
        own = figures["diagnose"][name]
        assert value == _shown(own["value"])
        assert interval == (" to ".join(map(_shown, own["interval"])) if own["interval"] else "")
        assert cases == str(own["cases"] or "")
        assert (target != "", met) == (own["target"] is not None, {True: "yes", False: "no", None: ""}[own["met"]])
        others = [figures[other][name]["value"] for other in ("bic", "residual-size", "sparse-regression")]
        assert [cell for cell in plain if cell] == [
            _shown(other) for cell, other in zip(plain, others, strict=True) if cell
        ]


@pytest.mark.parametrize(
    ("heading", "found", "lines"),
    [
        ("|severity|", result("blind_first_rig")["diagnose"]["detection_after_retune"], ("cases", "detected")),
        ("|stated|", result("blind_fresh_together")["reliability"], ("count", "stated", "right")),
    ],
)
def test_detection_and_reliability_are_those_of_their_scores(
    heading: str, found: list[dict[str, float]], lines: tuple[str, ...]
) -> None:
    for counted, (_, *cells) in zip(lines, rows(heading, BLIND), strict=True):
        assert [float(cell) for cell in cells] == [round(entry[counted], 3) for entry in found]
