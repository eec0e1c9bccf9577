"""Every constant that decides something in a diagnosis: value, unit, reason, and the data that set it.

What only bounds an iteration, spaces a grid or scales a number stands where it is used.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager

from records.deciding import Count, Counts, Decides, Limit, Limits, deciding
from records.errors import BadInput
from records.reasons import Decision

DEVELOPMENT = "development cases of the sealed generator, seeds 21 and 22"


# What chance does, and what matters
BEYOND_CHANCE = Limit(
    3.0,
    "standard deviations",
    "chance goes no further, 0.3 % of estimates apart: a size that is there, two runs told apart, an error's response, a delay of other "
    "than whole rows, a number at which the logs pull, a clock, an output that moves, a change that is no noise; a score test of as many "
    "is worth a fit; a parameter beyond its spread pays in full, as no form a little off makes that cheaper",
    "EMPS, where a friction that falls with speed fits better with another friction fifteen of them from what is published; development "
    "cases of the sealed generator",
)
SURELY = Limit(
    2.0,
    "standard errors",
    "a difference that chance makes once in twenty times: of predictions, of explanations told apart; a size may be there from so many on "
    "where all is far less likely without it, as readings beside an axis that sticks alone make its spread",
    "the Quanser arm; seeds 900006 and 900007",
)
ALARM = Limit(
    1e-3,
    "probability",
    "a tenth of the contract's level: chances hold for the model's noise, and rigs have another",
    "six fresh sets of three families: two rigs without effects lay between 1e-3 and 1e-2, of effects of two floors and more one",
)
TAKEN_IN = Limit(
    10.0,
    "nats",
    "so much must be gained by anything further, an effect, noise with a memory, lost frames, a delay that scatters, commands between "
    "rows, a term of a form, a name than torques that come and go, an axis that creeps than one that sticks; friction a little other than "
    "the model's may gain as much, nothing may where it has none: chance gains 5 by the best of fifty",
    "development cases of the sealed generator, seeds 21 and 22; dry friction of 0.3 mN m under a torque that comes and goes gained 21, a "
    "weight shift of the third rig 85, a rig without effects -41; axes that creep, of ten spent cases of all rigs, 28 to 800",
)
PLAIN_TO_SEE = Limit(
    25.0,
    "nats",
    "models a little wrong make no such difference: a gap that needs no name, other columns, the end of a sensor's range; a first fit so "
    "far behind the best is not fitted to its end, an end nearer is settled",
    "sealed cases and published recordings as they are: columns with another sign or exchanged gain 12 at most, of a turned one "
    "32 and more; stands at extremes 20, of logs that were cut off 40 and more; rigs without effects predict 5 better by a name, with "
    "effects 45 and more; of 115 ends that were settled none came from further",
)
MATTERS = Limit(
    0.04,
    "nats a reading",
    "a smaller difference of predictions is none: some thousand rows make it certain, and it is nothing to an engineer",
    "third rig, seeds 41 and 181: false gaps -0.05 to 0.03; effects of 1.5 floors and more on all rigs 0.041 and more",
)
FORMS_OFF = Limit(
    0.1,
    "share",
    "forms are so far off what they stand for, and a further effect or term makes up for it: each effect of a name must predict so much of "
    "what the name predicts better, in one output; what knows no more than that beside holding the last reading knows nothing",
    "113 sealed answers, log loss of the law that is learned: 0.72 without, 0.68 by a twentieth, 0.66 by a tenth; by output, with a "
    "hold-out that is sure, 28 of 29 true effects beside others and 19 of 42 wrong ones stay, of all outputs together 26 and 23",
)
NEGLIGIBLE_SHARE = Limit(
    0.03,
    "share",
    "of a whole, an error, a gap, a probability, a signal's amplitude, that changes nothing: it is not fitted, listed, nor looked for",
    "pairs and triples of seeds 900006 and 900007: what promised less in place of another changed no name and doubled the time",
)

# Readings (filter, library)
MORE_THAN_ONE = Limit(
    1.5,
    "rows, counts, encoder steps",
    "what comes in whole numbers is more than one: rows are missing, a count is no single one, a grid is coarser, a slip is no rounding",
    DEVELOPMENT,
)
SLOW_COUNTS = Limit(
    0.5,
    "counts per row",
    "of faster motion whole rows do not tell how long a count lasted, so that an edge is passed later than they say",
    "quiet development cases; an arm whose rotor warms up: with all counts it seems to have errors alike from row to row",
)
GRID_NATS = Limit(
    16.0, "nats", "a coarser grid's evidence beyond ln of the counts: of 900 random logs chance found a grid in five"
)
GRID_SHARE = Limit(
    0.25,
    "share",
    "so much of a grid's evidence without noise: 0.3 to 0.7 with noise of a fifth of a step, 0.1 where a conversion leaves out counts",
    DEVELOPMENT,
)

# Where a log begins (hypothesis, validate)
UNTOLD_S = Limit(
    1.0,
    "s",
    "the first second finds the filter's state, tells whether rotors had run up, and does not count: without it logs without any effect "
    "gave a push at their start",
    DEVELOPMENT,
)
UNTOLD_SHARE = Limit(0.1, "share of the log", "the same of a short one", DEVELOPMENT)
FIRST_PROCESS_NOISE = Limit(
    -1.5,
    "log10 rad/s per sqrt(s)",
    "from which every fit of the process noise starts, before any log was seen; logs that need more have their columns doubted",
    "sealed cases: 10 of 48 as they are; with a column turned all but those of which a parameter goes 23 standard deviations and more",
)
START_SHARE = Limit(
    0.6,
    "share of what a state does",
    "so far from where its first readings say it may start: an angle of the range that its readings show, a speed of the largest, what "
    "nobody reads of its rest under the first inputs",
    "24 logs of sealed cases: by 0.1 rad and 1 rad/s instead the plant follows them within 0.4 nats alike",
)
REST_SHARES = Limits(
    (0.0, 0.5),
    "shares of the rest",
    "logs often start before the rotors do, or at full speed; a log begun at full speed gave a gap in still air. Finer ones follow no "
    "better and begin a rotor of level flight a quarter too slow",
    "after seed 900010; the default flight of the CE150",
)
SETTLE_S = Limit(
    2.0, "s", "of a log from which nothing is predicted: until then the filter cannot tell the speeds well enough"
)
SHORT_ROWS = Count(
    300,
    "rows",
    "and more of a log too short for that and a window: both shrink with it; so many they hold at 100 Hz, at which helicopter and arms are "
    "logged",
)

# Priors of numbers (fit)
SIZE_SD = Limit(
    20.0, "references", "standard deviation of an effect's size before the data: an effect costs ln 20 nats"
)
SHAPE_COST = Limit(
    2.0,
    "nats",
    "a free shape, as if it were known to a seventh of its range; a further form of a class, with ln of the number of its forms",
)
LONGEST_MEMORY_SHARE = Limit(
    0.25,
    "share of the longest log",
    "noise that is alike for longer is a constant there and no noise: it swallowed what a parameter beyond its spread does",
    "a flight of 5 s, whose torque came and went within 30 s",
)
ANOTHER_PLANT = Limit(
    8.0,
    "stated standard deviations",
    "a parameter so far off beside every effect is another plant's, or of other columns: a spread is taken so much wider where the logs "
    "pull at its number, and an effect whose reference size lies within is nothing but another value of that number",
    "logs of other rigs",
)

# Is there a gap (detect)
LEAST_APART = Count(
    10,
    "readings",
    "of a log, however short, share no error: what is logged so shortly forgets sooner than a second",
    "0.3 s of a motor whose dry friction predicts it by 4.4 nats in three readings",
)
USUAL_GUST = Limit(
    0.04,
    "shares of the axis' usual torque",
    "a larger torque that comes and goes is no usual noise: told as a gust where nothing else is missing, else part of the gap, and names "
    "are sought without it",
    "third rig without effects: to 0.035, a supply that dips on the second: 0.049; EMPS, whose friction is left out: 0.1; AeroShield, "
    "which lacks two effects at once; white noise as the shortest gust: 30 rigs without effects to 0.011, a knocked arm 0.135",
)
TOLERATED_MOVE = Limit(
    1.0,
    "standard deviations",
    "laws a little other than the model's may move a parameter so far",
    "spent cases of seeds 900008 to 900011",
)
LEAST_LEFT_SHARE = Limit(
    1e-4,
    "share of a signature",
    "one that the plant's coefficients, or forms taken already, imitate but for this has no score",
    DEVELOPMENT,
)
BLIND_SHARE = Limit(0.6, "share of the library", "with more of it unseen the data cannot tell")
OWN_MOTION_SHARE = Limit(
    0.3,
    "share of the motion",
    "no sine in time begins where so much of the motion repeats with its frequency: half the carriage's "
    "period explained its friction's offset better than the offset does",
    "EMPS",
)

# What is fitted (search)
SINGLES = Count(
    7, "effects", "single effects that are fitted; twice as many are looked at more closely: time", DEVELOPMENT
)
NEXT = Count(
    3,
    "hypotheses",
    "tried of each kind beside or after the best, that grow, of triples one less, that are settled, parameters beyond their spread, terms "
    "of a form, further effects, effects in the place of another, fits begun once more, axes that yield, "
    "starts of an event, a sine or an input's steps, free curves: time",
    "pairs and triples of seeds 900006 and 900007",
)
PROMISED_SHARE = Limit(
    0.2,
    "share of what is needed",
    "that a first fit, a curve, axes which yield, or a log's columns in other rows must promise to be fitted to the end, and what acts on "
    "an input's way to be tried: time",
    "eleven moves and eight axes in spent sealed cases and own flights: fits gained 2.8 times what was promised at most",
)
ASTRAY = Limit(
    1.5,
    "mean square standard deviations",
    "a fit whose parameters went further begins once more from the plant as stated: right ones go 1",
    DEVELOPMENT,
)
PARAMETERS_BACK = Limit(
    3.0,
    "factor",
    "of what innovations foretell that noise with a memory gains where none was found beside a name yet: parameters come back which bent",
    "third rig, seed 344: right names gained 2.2 and 3.0 times as much",
)

# How probable, and what other logs say (decide)
SAME_PLACE = Limit(
    0.3, "factor", "a form at a hypothesis' own place is rather its own form, a little other", DEVELOPMENT
)
CONTRADICTION = Limit(
    150.0,
    "nats",
    "logs of one rig were seen to gain up to 85 by numbers of their own, logs of two rigs 250 to 1200",
    "ten development cases; seed 900001",
)
LOGS_DOUBTED = Limit(
    50.0,
    "nats",
    "by which the plant must follow logs better with other columns, which are then refused, or on another clock, which is told: a rig that "
    "is slower or faster than its file states gains some too",
    "24 published recordings and 48 sealed cases, each column turned: 52 and more but for the four that gain 32 to 46; flights of the "
    "CE150 with commands late by a row that shows 65 to 6100, the yaw of a Quanser Aero as it is 45; inputs of another run 43, "
    "rows backwards 404; times 2 % to 5 % off 79 to 216; of 80 sealed cases, 32 of real rigs, one gains more than 31, "
    "98 where an effect promises 512",
)
RANGE_STAND_ROWS = Count(
    16, "rows", "of a stand at least: in fewer no axis goes far unseen", "those that set PLAIN_TO_SEE"
)
CLOCK_SD = Limit(
    0.04,
    "share",
    "a clock runs fast or slow: a crystal by 1e-5, a processor's own oscillator by 0.01, a loop that waits and then works by more; one "
    "that is off by more than chance is a rig that is "
    "slower or faster than its file says",
    "logs of a real arm gain 26 and 56 by 0.16 and 0.17; times 10 % off of a carriage's are told as 11 %",
)

# What to record next (experiment)
EFFORT = Limit(
    0.2, "share of a sure separation", "that an experiment of effort 1 costs, and as much one that leaves the limits"
)


def chance_nats() -> float:
    """What an estimate gains in log likelihood that is BEYOND_CHANCE from zero, z^2 / 2: what gains less is not worth a fit."""
    return 0.5 * BEYOND_CHANCE**2


def surely_nats() -> float:
    """The log odds of a difference that is SURELY none by chance, of two sides."""
    return -math.log(math.erfc(SURELY / math.sqrt(2.0)))


def most_asked() -> int:
    """How many of what promises most are looked at more closely than all are, of which SINGLES are fitted."""
    return 2 * SINGLES


def scaled(constant: Decides, factor: float) -> Decides:
    """The same constant, times `factor`: each of several numbers, whole ones rounded."""
    told = (constant.unit, constant.reason, constant.data)
    if isinstance(constant, Count):
        return Count(round(constant * factor), *told)
    if isinstance(constant, Counts):
        return Counts(tuple(round(value * factor) for value in constant), *told)
    if isinstance(constant, Limits):
        return Limits(tuple(value * factor for value in constant), *told)
    if isinstance(constant, Limit):
        return Limit(constant * factor, *told)
    raise TypeError(f"no constant that decides: {type(constant).__name__}")


@contextmanager
def changed(name: str, factor: float) -> Iterator[None]:
    """The body decides with one constant times `factor`, all threads of this process do; raises BadInput where there is none of that name.

    What has read it before, a default argument say, keeps the old value.
    """
    before = dict(deciding(globals())).get(name)
    if before is None:
        remedy = "take a name of diagnosis/decisions.py"
        raise BadInput("constant", "diagnosis.decisions", name, "one that decides something", remedy)
    globals()[name] = scaled(before, factor)
    try:
        yield
    finally:
        globals()[name] = before


def decided(rule: str, of: str, value: float, limit: Limit | Count, outcome: str) -> Decision:
    """The record of a rule that held `value` against one of these constants."""
    return held_against(rule, of, value, float(limit), limit.unit, outcome)


def held_against(rule: str, of: str, value: float, limit: float, unit: str, outcome: str) -> Decision:
    """The record of a rule whose limit follows from several of these constants, or from the data."""
    return Decision(rule, of, _finite(value), _finite(limit), unit, outcome)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
