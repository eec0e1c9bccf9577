"""Every constant that decides something in a diagnosis: value, unit, reason, and the data that set it.

What only bounds an iteration, spaces a grid or scales a number stands where it is used.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager

from identification import thresholds
from records.deciding import Count, Counts, Decides, Limit, Limits, deciding
from records.errors import BadInput
from records.reasons import Decision

DEVELOPMENT = "development cases of the sealed generator, seeds 21 and 22"
DEVELOPMENT_21 = "160 development cases, seed 21"


# Everywhere
BEYOND_CHANCE = Limit(
    3.0,
    "standard deviations",
    "chance goes no further, 0.3 % of estimates apart: two runs told apart, an error's response, a delay of other than whole rows, a "
    "number at which the logs pull, a parameter beyond its spread, which pays in full, as no form a little off makes that cheaper",
    "EMPS, where a friction that falls with speed fits better with another friction fifteen of them from what is published",
)

# Readings (filter, library)
CLIPPED_CHANGE = Limit(
    3.0,
    "usual changes",
    "second differences of readings are clipped there: the edge of a step is no noise",
    DEVELOPMENT,
)
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
GRID_IN_PHASE = Limit(
    0.3, "share of the readings", "that are in phase on a grid: those of one of 1.5 counts without noise are 0.41"
)
GRID_OVERTONE = Limit(
    0.8,
    "share of the highest peak",
    "a slower one as high is the grid's own: overtones of a grid that is read without noise are as high as it",
)

PLAY_CHANGES = Count(3, "changes", "of a reading behind play: fewer say nothing of how long it usually takes")

# Where a log begins (hypothesis)
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

# Priors of numbers (fit)
SIZE_SD = Limit(
    20.0, "references", "standard deviation of an effect's size before the data: an effect costs ln 20 nats"
)
STEPS_COST = Limit(8.0, "nats", "the choice of an input's step: ln of some hundred steps, each of eight kinds")
WAVES_COST = Limit(5.0, "nats", "the choice of a sine's waves: ln of some hundred")
COLOUR_COST = Limit(
    8.0, "nats", "size and time of a noise with a memory, which no fit counts: ln of some thousand rows"
)
SMALLEST_STEP = Limit(
    0.004,
    "share of an input's range",
    "of what its commands take: finer ones are sought of none, a choice which no data set",
)
LARGEST_STEP = Limit(0.25, "share of an input's range", "coarser ones are sought of none: a choice, which no data set")
SHAPE_COST = Limit(
    2.0,
    "nats",
    "a free shape, as if it were known to a seventh of its range; a further form of a class, with ln of the number of its forms",
)
TAKEN_IN = Limit(
    10.0,
    "nats",
    "so much must be gained by anything further, an effect, lost frames, a delay that scatters, commands between "
    "rows, a name than torques that come and go, an axis that creeps than one that sticks; friction a little other than the model's may "
    "gain as much, nothing may where it has none: chance gains 5 by the best of fifty",
    "development cases of the sealed generator, seeds 21 and 22; dry friction of 0.3 mN m under a torque that comes and goes gained 21, a "
    "weight shift of the third rig 85, a rig without effects -41; axes that creep, of ten spent cases of all rigs, 28 to 800",
)
SURE_ROUGHNESS = Limit(
    5.0,
    "standard errors",
    "fourth differences share readings; three if they did not",
    "AeroShield, whose readings are as smooth in fast motion as in slow",
)
LEAST_FAST_READINGS = Count(30, "readings", "fewer that are faster than a step a row show no scatter")

# Is there a gap (detect)
ALARM = Limit(
    1e-3,
    "probability",
    "a tenth of the contract's level: chances hold for the model's noise, and rigs have another",
    "six fresh sets of three families: two rigs without effects lay between 1e-3 and 1e-2, of effects of two floors and more one",
)
PLAIN_TO_SEE = Limit(
    40.0,
    "nats",
    "a smaller gain is a gap only with a hypothesis that explains it, by evidence and by predictions: x nats have a chance of exp(-x) "
    "without a gap",
    "160 development cases, seed 21; of 23 sealed cases below, predictions of rigs without effects gain 5 nats at most, effects of two "
    "floors and more 45 to 178, but for a backlash that predicts nothing better",
)
MATTERS = Limit(
    0.04,
    "nats a reading",
    "a smaller difference of predictions is none: some thousand rows make it certain, and it is nothing to an engineer",
    "third rig, seeds 41 and 181: false gaps -0.05 to 0.03; effects of 1.5 floors and more on all rigs 0.041 and more",
)
LEAST_APART = Count(
    10,
    "readings",
    "of a log, however short, share no error: what is logged so shortly forgets sooner than a second",
    "0.3 s of a motor whose dry friction predicts it by 4.4 nats in three readings",
)
FORMS_OFF = Limit(
    0.1,
    "share of what a name predicts better",
    "that each of its effects must at least, in one output: forms are so far off what they stand for, and a further effect makes up for it",
    "113 sealed answers, log loss of the law that is learned: 0.72 without, 0.68 by a twentieth, 0.66 by a tenth; by output, with a "
    "hold-out that is sure, 28 of 29 true effects beside others and 19 of 42 wrong ones stay, of all outputs together 26 and 23",
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
LEAST_TOLD_SHARE = Limit(
    0.05,
    "share of the stated variance",
    "logs that take away less say nothing of a number, so it cannot have moved for a reason",
    "spent cases of seeds 900008 to 900011",
)
LEAST_LEFT_SHARE = Limit(
    1e-4,
    "share of a signature",
    "one that the plant's coefficients, or forms taken already, imitate but for this has no score",
    DEVELOPMENT,
)
REPLICAS = Count(48, "replicas", "two moments of a Gumbel law need no more", DEVELOPMENT)
BLIND_SHARE = Limit(0.6, "share of the library", "with more of it unseen the data cannot tell")
NEAR_PERIODS = Limit(
    3.0, "periods", "a frequency nearer to the motion's own, over a whole log, would be drawn to it", "EMPS"
)
OWN_MOTION_SHARE = Limit(
    0.3,
    "share of the motion",
    "no sine in time begins where so much of the motion repeats with its frequency: half the carriage's "
    "period explained its friction's offset better than the offset does",
    "EMPS",
)
MOST_PARTS = Count(5, "parts of a period", "or with a second to fifth of it", "EMPS")
WAVES_APART = Limit(0.12, "share", "waves that are closer are one", "seed 900014")

# What is fitted (search)
SINGLES = Count(7, "effects", "single effects that are fitted: time", DEVELOPMENT)
NEXT = Count(
    3,
    "hypotheses",
    "tried of each kind beside or after the best, further effects, effects in the place of another, fits begun once more, axes that yield, "
    "starts of an event, a sine or an input's steps, free curves: time",
    "pairs and triples of seeds 900006 and 900007",
)
BEAM = Counts((3, 2), "hypotheses", "of each size that are worth a further effect: time", DEVELOPMENT)
CLOSE_PAIR_SHARE = Limit(
    0.05,
    "share of the gap",
    "what is further from the best is not worth a further effect, nor to be settled",
    DEVELOPMENT,
)
LEAST_GAIN = Limit(
    4.0,
    "nats",
    "a score test below is not worth a fit; beyond a size that loses as much larger ones are not tried, but for limits",
)
COSTLY_EFFECTS = Count(14, "effects", "worth a costly score test beside others", DEVELOPMENT)
SETTLED_FITS = Count(
    5, "hypotheses", "fitted once more to their end: one not at its end loses to one with an idle effect", DEVELOPMENT
)
CERTAIN = Limit(
    3.5,
    "standard deviations",
    "an effect's size from zero, for it to be there; one whose reference size would show with less would go unseen",
    DEVELOPMENT,
)
LIKELY = Limit(
    1.5,
    "standard deviations",
    "or this, where all is far less likely without it: beside an axis that sticks readings alone make the spread",
    "the Quanser arm",
)
MISSED = Limit(15.0, "nats", "far less likely", "the Quanser arm; seeds 900006 and 900007")
WORTH_REFINING = Limit(
    0.2,
    "share of the best fit's gain",
    "first fits below are not fitted to their end, free curves that promise less not at all: time",
    "development cases of the sealed generator, seeds 21 and 22",
)
NEAR_BEST = Limit(
    30.0,
    "nats",
    "a first fit further short of the best is not fitted to its end; an end so near it is settled, however small the gap",
    "pairs and triples of seeds 900006 and 900007",
)
NEARLY_AS_GOOD = Limit(
    0.03,
    "share of the best's gain",
    "that another must promise to be worth a fit, in its place or alone, and that axes which yield must gain to be worth a search anew",
    "pairs and triples of seeds 900006 and 900007; yields that gained 0.005 and 0.003 of it changed no name and doubled the time",
)
ASTRAY = Limit(
    1.5,
    "mean square standard deviations",
    "a fit whose parameters went further begins once more from the plant as stated: right ones go 1",
    DEVELOPMENT,
)
ASKED = Count(
    4,
    "hypotheses, moves",
    "the likeliest before anything is fitted: beside which axes may yield, of columns in other rows: time",
    "seeds 900010 and 900011",
)
LONGEST_PUSH_SHARE = Limit(
    0.25,
    "share of the longest log",
    "a torque that stays for longer is a constant there and no noise: it swallowed what a parameter beyond its spread does",
    "a flight of 5 s, whose torque came and went within 30 s",
)
LONGEST_READING_S = Limit(5.0, "s", "errors alike for longer are an offset")
PARAMETERS_BACK = Limit(
    3.0,
    "factor",
    "of what innovations foretell that noise with a memory gains where none was found beside a name yet: parameters come back which bent",
    "third rig, seed 344: right names gained 2.2 and 3.0 times as much",
)
NO_NOISE_SHARE = Limit(0.02, "shares of the least start", "a smaller noise with a memory is none")
RETUNE_WIDER = Limit(
    8.0,
    "factor",
    "by which a spread is taken wider at least where the logs pull at its number; an effect whose reference size lies within is nothing "
    "but another value of that number",
)
RETUNE_NATS = Limit(4.0, "nats", "that each parameter beyond its spread costs")
RETUNE_MOST = Count(4, "parameters", "set free one after another: more are no re-tune")

# How probable (decide)
ALIKE_SCALES = Limit(
    3.0,
    "scales",
    "hypotheses of as many effects that are no further apart are told as hardly told apart",
    DEVELOPMENT_21,
)
MOST_FORMS = Count(4, "forms", "of one class")
SAME_PLACE = Limit(
    0.3, "factor", "a form at a hypothesis' own place is rather its own form, a little other", DEVELOPMENT
)
OTHER_KNEE = Limit(0.05, "factor", "a limit's knee may be rounder than the library's", DEVELOPMENT)

MOST_FORESEEN = Count(
    16, "explanations", "by evidence, of which it is asked how they predict: of 58 right names one had a lower rank"
)

# What other logs say (decide)
SURELY = Limit(2.0, "standard errors", "a difference of predictions that chance makes once in twenty times")
LIKELIER_THAN_NOT = Limit(0.5, "probability", "likelier than all else together")
CONTRADICTION = Limit(
    150.0,
    "nats",
    "logs of one rig were seen to gain up to 85 by numbers of their own, logs of two rigs 250 to 1200",
    "ten development cases; seed 900001",
)
KNOWS_NOTHING = Limit(
    0.9,
    "ratio of errors",
    "predictions no better than holding the last reading are of another plant's logs",
    "logs of other rigs, shuffled rows",
)
ANOTHER_PLANT = Limit(
    8.0,
    "standard deviations",
    "a parameter so far off beside every effect is another plant's, or of other columns",
    "logs of other rigs",
)
MOVES_FLOORS = Limit(5.0, "floors", "windows in which an output moves less do not count")
PROMISED_SHARE = Limit(
    0.25,
    "share of the nats that are needed",
    "that axes which yield, or columns moved by rows, must promise with all noise as it was, to be fitted: time",
    "eleven moves and eight axes in spent sealed cases and own flights: fits gained 2.8 times what was promised at most",
)
COLUMNS_ROWS = Count(
    4000,
    "rows",
    "of each log, by which its columns are asked: time; seven times as many nats as a row of a published recording needs",
)
COLUMNS_TOLD = Limit(
    25.0,
    "nats",
    "another reading of the columns, a turned sign, an exchange or a move by rows, that is likelier by so much is told",
    "24 published recordings and 48 sealed cases as they are: signs and exchanges gain 12 at most; with a column turned 32 and more, where "
    "the plant is not alike both ways round",
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
RANGE_ENDS = Limit(
    30.0,
    "nats",
    "by which readings at an output's extreme make what follows less likely than none: the sensor's range ends there; a play that stands "
    "where its axis turns gains some",
    "stands at extremes in 128 sealed cases, most of them with effects: 20 at most; five logs of an arm and a CE150 that were cut off 40 "
    "and more",
)
RANGE_BEHIND_ROWS = Count(30, "rows", "behind a stand, in which what an axis did unseen still shows", "the same logs")
RANGE_STAND_ROWS = Count(16, "rows", "of a stand at least: in fewer no axis goes far unseen", "the same logs")
CLOCK_SD = Limit(
    0.03,
    "share",
    "a clock runs fast or slow: a crystal by 1e-5, a processor's own oscillator by 0.01, a loop that waits and then works by more",
)
CLOCK_MOST = Limit(
    0.125,
    "share",
    "a clock runs fast or slow at most, and a fortieth by which logs tell it wrong: what gains by more is a rig that is slower or faster "
    "than its file says",
    "logs of a real arm gain 26 and 56 by 0.16 and 0.17; times 10 % off of a carriage's are told as 11 %",
)

# How it predicts, and what the improved plant does in a closed loop (validate)
SETTLE_S = Limit(
    2.0, "s", "of a log from which nothing is predicted: until then the filter cannot tell the speeds well enough"
)
SHORT_ROWS = Count(
    300,
    "rows",
    "and more of a log too short for that and a window: both shrink with it; so many they hold at 100 Hz, at which helicopter and arms are "
    "logged",
)
ASTRAY_S = Limit(1.0, "s", "so long in all a flight may be further from the log than the log's own range")

# What to record next (experiment)
LEAST_AT_STAKE = Limit(0.02, "probability", "that a hypothesis must have, and that must be at stake")
SURELY_APART = Limit(5.0, "standard deviations", "more of them tell hardly more")
EFFORT = Limit(0.2, "share of a sure separation", "that an experiment of effort 1 costs")
BEYOND_SURE = Limit(
    0.05,
    "share of a sure separation",
    "that each factor of ten beyond it is worth: no model is so right that the noise alone decides",
)
NEAR_LIMITS_SHARE = Limit(0.3, "share of a sure separation", "that a run costs which leaves the limits")
MOST_CLIPPED = Limit(0.05, "share of the samples", "of a plan that may ask for more than an input can give")
INPUT_FLOOR = Limit(0.02, "share of an input's range", "less is no outcome to look for")
OUTPUT_FLOOR = Limit(3.0, "encoder steps", "less is no outcome to look for")

# What is told beside it (explain)
IMITATED = Limit(0.995, "share of a signature", "that the plant's own parameters imitate, for a sentence")
BELIEVED = thresholds.GOOD_COHERENCE
LEAST_POWER_SHARE = Limit(
    1e-3, "share of the power of an output's modelled answers", "an input below is not there to move it"
)
KNOWN_TO = Limit(0.25, "share of a response", "to which it must be known for its band to be named")
LEAST_LISTED_SHARE = Limit(0.02, "share of the gap", "smaller ones of a time, region or band are not listed")
LEAST_PLACE_SHARE = Limit(0.005, "share of the gap", "smaller ones of a place are not listed")
MOST_TERMS = Count(3, "terms", "of the form that sparse regression suggests: more are no form that one reads")
NATS_PER_TERM = Limit(
    6.0, "nats", "that a term must gain: a number, and the choice of its form among some three hundred"
)
FURTHER_TERM_SHARE = Limit(0.1, "share of the gain so far", "that a further term must add")


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
