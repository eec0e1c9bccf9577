"""Every constant that decides which estimate is kept, and what is said of it: value, unit, reason, and the data that set it."""

from records.deciding import Limit

# runs: where windows begin
AT_RANDOM = Limit(
    0.2, "share of the steps", "that are longer than usual: with more, rows come at random times, and none are missing"
)

# uncertainty: what two sets of data say of one parameter
CONTRADICTS = Limit(
    5.0,
    "standard deviations",
    "between two estimates of one parameter: once in a million by chance; runs fitted together, new data against what was known, long "
    "windows against short ones",
)
NO_NEWS = Limit(
    3.0,
    "standard deviations of what was known",
    "a move within that is no news, however sure the new data are",
)
NOT_IDENTIFIED = Limit(
    0.5, "share of the parameters' size", "a direction that is known no better is told as one that the data do not see"
)

# stages: which of several fits is kept
WORSE = Limit(
    1.5,
    "times the least error",
    "of the shortest windows: a fit over longer ones that predicts them worse has gone astray",
)
MOST_LEFT = Limit(
    0.3, "share of its readings' motion", "that a fit may leave: one that leaves more caught a wrong phase"
)
SENSORS = Limit(1.1, "times what a sensor alone leaves", "up to that no more is left than the sensor's own errors")
NEARLY = Limit(2.0, "times what a sensor alone leaves", "the same of a fit that has not settled")
POOR = Limit(
    5.0,
    "times what a sensor alone leaves",
    "calls for a look at the mount, and the other mount must leave as many times less to be the right one",
)

# results: what is told of an estimate
FARTHEST = Limit(
    0.6, "share of a size", "an interval that reaches farther was held by having been given a size, not by data"
)

# frequency
GOOD_COHERENCE = Limit(0.6, "coherence", "below which a frequency response is not read", "Tischler and Remple (2012)")
FAST_RAD_S = Limit(
    2.7,
    "rad/s",
    "slowest designed pole of the CE150's loops: a slower loop passes nothing of so fast a reference, and the feedback of the sensor's "
    "steps is all that is left; a faster one is swept as it is, since a shorter record tells less",
    "tank of new-plant, poles from 0.3 rad/s: misfit 3.9 by the band as it is, 0.42 by a ninth of it; heater, from 0.5: sd of the capacity "
    "0.56 and 0.053 %; motor, from 15: sd of K 2 and, five times faster, 10 %",
)
POOR_J = Limit(
    100.0,
    "cost J",
    "mean of the pairs: a model that leaves more has not the form of the responses",
    "Tischler and Remple (2012)",
)
COLUMNS_TIMES = Limit(
    5.0,
    "times the cost J",
    "of the plant as stated that it has less once a column is turned or two are exchanged: they are not what they are called",
    "raptor50, twelve plant files 30 % off: none of its sweeps refused as they are; each with a turned or two exchanged columns by name",
)
ROWS_TIMES = Limit(
    2.0,
    "times the cost J",
    "of the matched model that it has less once all commands are moved by rows: they may stand there",
    "raptor50, one row late or early: 5 times; in its rows: less than 1",
)
BANDWIDTH_rad_s = Limit(
    25.0,
    "rad/s",
    "twice the highest frequency of the sweeps: what the lever adds is right within 5 % there, and its noise is a quarter of it",
    "sweeps of raptor50: the lever adds 0.014 m/s^2 rms, its noise is 0.0037 by 25 rad/s, 0.0013 by 12, 0.014 by 60",
)
