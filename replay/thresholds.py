"""Every constant that decides which cause a difference of firmware has: value, unit, reason, and the data that set it."""

from records.deciding import Count, Counts, Limit, Limits

# columns
NEAR_SHARE = Limit(
    1e-5,
    "share of the largest value",
    "what is nearer is held to the log's digits by the run itself",
    "synthetic faults",
)
MOVES_V = Limit(1e-3, "V", "an output that moves less tells no factor from an offset")
WHOLE_FACTOR = Limit(1e-6, "share", "rounding of a found factor to a short decimal, a power of ten is a unit")

# events
LONGEST_HOLD = Count(64, "samples", "longest run in which one output may be held")
LOOK_AHEAD = Count(200, "samples", "how far a single incident must explain what follows")
LEAST_EXPLAINED_SHARE = Limit(
    0.4,
    "share of moving samples",
    "the law itself must explain 0.4 of the samples in which the output moved, else incidents explain anything",
    "synthetic faults",
)
LEAST_EXPLAINED_SAMPLES = Count(20, "samples", "the same for short logs", "synthetic faults")

MOST_MISREAD = Limit(0.1, "share of samples", "in which a log holds another reading: more are the firmware's doing")
MISREAD_REACH = Count(24, "counts", "from the log's reading at most, where its axis moves so far in three rows: time")
MISREAD_IN_A_ROW = Count(3, "samples", "in a row at most, as by chance one of twenty comes so")

# flight
LINE_COUNTS = Limit(
    1.5, "counts", "a line through whole counts is off by half of one, and a sensor between two by one: more is a leap"
)
MOST_MISSING = Limit(0.2, "share of samples", "with more missing, rows are taken as they come")
CLOCK_ERROR = Limit(0.2, "sample periods", "measured period within 20 % of the stated replaces it")

# lone
OLDEST_ANGLES = Count(4, "samples", "oldest stale angle tried")
FARTHEST_OUTPUTS = Count(3, "samples", "late or early that an output is tried, as the log check asks of columns")
OLDEST_REFERENCES = Count(50, "samples", "oldest stale reference tried")

# midair
SETTLED_CONSTANTS = Limit(
    20.0, "time constants", "exp(-20)(1 + 20) of a wrong beginning of the reference filter is left", "computed"
)
HISTORY = Count(4, "samples", "differences of s reach back three samples, and one", "exact")
BOUNDS_V = Limits((1e-6, 1e-5, 1e-4, 1e-3), "V", "agreement bounds tried from fine to coarse")
LEAST_ROWS = Count(200, "rows", "that must remain to compare")
TOLD_ANEW = Count(
    3000,
    "rows",
    "after which the state is told anew: what rounding of the inputs leaves of it grows to 0.1 mV within 5000 rows of the CE150",
)
FIRST_TRIED = Count(5, "rows", "are tried one after the other as the first that tells the state", "flights cut at rest")
TRIED_LATER = Count(120, "rows", "between two of them", "the same")
CLEARLY_OFF = Limit(100.0, "times the bound", "a law from rest is off by this much in a log that begins in flight")

# overflow
LEAST_WRAP_V = Limit(0.05, "V", "less is no overflow of a voltage")
RANGE_TOLERANCE = Limit(0.01, "share of the range", "what a grid or missing rows may add to a multiple")
LEAST_WRAPPED = Count(2, "samples", "one sample proves no range, unless it is one that integers have")
DECIMALS = Count(5, "decimals of a volt", "units in which an integer counts, 1 V to 10 uV")
ANGLE_BITS = Counts(
    (16, 8, 12, 10, 14, 11, 9, 7), "bits", "of those that explain a log the first is named: order of likelihood"
)
DECIMAL_DIGITS = Counts((2, 3, 4, 5, 6, 7), "decimal digits", "range ends of decimal integers tried")
FRACTION_BITS = Counts((8, 10, 12, 14, 15, 16), "bits", "Q formats tried")
UNSIGNED_V = Limits((65.536, 16.0, 32.0, 64.0, 20.0), "V", "usual unsigned ranges")

# printed
ROUNDED_RUNS = Count(8, "runs", "of the law on numbers that the log may have rounded to what it holds")
ROUNDED_FARTHER = Limit(1.5, "times the farthest of these runs", "the log's own rounding is one more of them")
SAME_ROUNDING_V = Limit(2e-6, "V", "float32 itself rounds by so much")

# stretches
MOST_UNREAD = Count(10, "rows", "more rows in a row that lack a reading leave the law's state unknown")

# prefilter
LOG10_RANGE_S = Limits((-2.5, 1.0), "log10 s", "time constants tried")
WRITTEN_DIGITS = Counts((1, 2, 3, 4, 6), "digits", "a time constant is tried with few digits, as people write it")

# stretches
MOST_STANDS = Count(3, "stands", "of a sensor that are left out to follow the law behind them")

# digits
MOST_DECIMALS = Count(7, "decimals", "more reproduce any voltage or angle of a float32 law", "exact")
MOST_DIGITS = Count(8, "digits", "nine significant digits give every float32 back", "exact")
FEWEST_VALUES = Count(10, "distinct values", "a handful of round numbers proves nothing")

# search
MANY_INCIDENTS = Count(3, "incidents", "more than three of them are one change")
BY_CHANCE = Limit(0.01, "probability", "chance of repeated rows below which they are told")
CHANGE_COST = Count(2, "incidents", "incidents that one change of the firmware outweighs")

# variants
OBSERVER_POLES = Limits((0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.95, 0.98), "pole z", "anti-windup observers tried")
LEAST_PLATEAU = Count(2, "samples", "a float32 that moves freely does not meet its extreme twice")
PWM_STEP_V = Limit(10.0 / 3200.0, "V", "10 V over 3200 timer counts", "the board's timer")
LEAST_GRID_V = Limit(5e-5, "V", "a finer grid is the log's digits")

# arithmetic
FLOWN_IN_FIXED = Limit(
    0.5, "share of samples", "so many, and more than in float32, must agree for a log to count as flown in fixed point"
)
