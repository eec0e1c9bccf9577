"""Every constant that decides something in the check of a log: value, unit, reason, and the data that set it."""

from records.deciding import Count, Limit

# clock
CALENDAR_S = Limit(1e6, "s", "eleven days: no run starts so late by its own clock")

# between
WINDOW_DOUBLINGS = Count(5, "log2 rows", "windows of 32 rows are hashed to find a training log's rows")
LEAST_SHARED_CHANGES = Count(8, "rows", "rest is alike in all logs")
BEGINS_ALIKE = Limit(0.2, "share of a hold-out's rows", "that are a common manoeuvre's: more are a copy")
ANGLE_BINS = Count(24, "bins", "bins of the angle for holding inputs")
LEAST_STEADY_ROWS = Count(100, "rows", "quasi-steady rows of a bin in both logs")
STEADY_RAD_S = Limit(0.05, "rad/s", "slower motion is quasi-steady")
LEAST_HOLDING_INPUT = Limit(0.1, "share of the larger limit", "a holding input below says nothing")
NOTE_RATIO = Limit(1.35, "ratio", "two logs hold one angle with inputs this much apart: a note")

# breaks
BRIDGED_ROWS = Count(3, "rows", "so few missing rows are bridged; a longer stretch without rows ends the log")
AROUND_GAP_ROWS = Count(20, "rows", "on either side of a gap show how far apart rows are there")
OFTEN_PERCENT = Limit(90.0, "percentile", "of the steps around: rows at random times often lie far apart")
LONGER_THAN_OFTEN = Limit(4.0, "times that step", "a gap is longer than what often comes between rows at random times")

# dead
DEAD_S = Limit(0.2, "s", "an output that stands this long", "18 000 stands in honest logs")
DEAD_ROWS = Count(5, "rows of one value", "fewer are no stand")
USUAL_MOVE_PERCENT = Limit(99.0, "percentile", "of moves from row to row")
MOVED_STEPS = Limit(4.0, "least moves", "an axis is surely under way")
AROUND_STAND_ROWS = Count(5, "rows", "before or after a stand show how fast the axis is there")
WAY_ROWS = Count(20, "rows", "in which an axis that is under way goes on")
WAY_S = Limit(0.2, "s", "the same, where rows are denser")
TO_AND_FRO = Limit(0.2, "share of all moves", "that are against the one before: a noisy sensor never rests")
SELDOM = Limit(0.02, "share of rows", "that repeat the one before: then five rows of one value do not come by chance")
BROKEN_OFF = Limit(
    3.0,
    "times the largest move near",
    "an axis leaves its rest by no more",
    "stands of five rows and more in the published recordings: 3.0 at most",
)
BROKEN_OFF_STEPS = Limit(4.0, "least moves", "the same stands: 3 at most", "published recordings")
DRIVEN_SHARE = Limit(
    0.05, "share of an input's range", "inputs that move so far during a stand would have moved the axis"
)
EVEN = Limit(
    0.7,
    "share",
    "of the way before, in the rows next to a stand: 1/3 for an even brake, 1 for an axis that goes on unseen; 0.6 at most",
    "9 700 stands in the published recordings and simulated flights",
)
USUAL_CHANGES_PERCENT = Limit(
    95.0,
    "per cent",
    "of the changes of speed within WAY_S are usual: an axis that stops from such a speed may be stopped by what moves it, or rub",
    "180 runs of an arm with dry friction, in 79 of which a stick passed for a sensor that was not read, and 120 of axes with play, 26",
)
COMES_BACK_SHARE = Limit(
    0.1,
    "share",
    "of stretches as long as a stand, behind which the column is where it was: of fewer an axis that was not read would have jumped",
    "the same runs",
)
CUT_OFF_STEPS = Limit(
    14.0, "least moves", "next to a stand on both sides, in as many rows as it lasts at most", "the same stands"
)
CUT_OFF_ROWS = Count(128, "rows", "next to a stand at most", "the same stands")
CUT_OFF_ALONE_STEPS = Limit(20.0, "least moves", "before a stand alone, in half as many rows", "the same stands")
LEAST_CLIPS = Count(
    2,
    "stands",
    "at one level, that the output leaves at full speed: play and dry friction stand so once where they turn back",
    "128 sealed cases: five stand so once, none twice",
)
MOST_CUT_OFF = Limit(
    0.5,
    "share",
    "of the stands at an end of a range, that the output leaves at full speed: the sensor ends there; no honest log has as many",
    "73 published recordings: none is remarked on, and 399 of 516 that were cut off at 60 % or 80 % of their range are",
)
LINK_STOPS_S = Limit(0.5, "s", "within which all outputs stop where the link stops")

# ahead, standing
RUN_UP_S = Limit(4.0, "s", "with the first inputs before a log: rotors come to the speed that these ask for")

# ends
MOVED_FAR = Limit(0.5, "share of an input's range", "that moves any axis that is not stopped")
ANSWER_TIMES = Limit(3.0, "times the most rows", "in which an output answers such a move elsewhere")
ANSWER_ROWS = Count(50, "rows", "unanswered at least", "1 058 parts of honest logs: 24 once, of a heater cut short")
LEAST_ANSWERS = Count(20, "answers", "fewer do not tell how an output answers")
ROWS_ASKED = Count(200, "rows", "of a log, spread evenly: time")

# foretold
FORETOLD_S = Limit(0.3, "s", "ahead: long enough for an axis to leave its rest, too short for a wrong plant to stray")
FORETOLD_ROWS = Count(10, "rows", "ahead at least")
FORETOLD_TIMES = Limit(
    2.0,
    "times",
    "as far off as the plant is at most where the output rests elsewhere",
    "969 rests at an end of the range and at the end of sealed cases and published recordings: 1.15 at most",
)

# exchanged
STANDS_SHARE = Limit(0.9, "share of rows", "in which a command that is switched by hand stands")
LEAPS_SHARE = Limit(0.1, "share of a column's range", "that such a command moves by at once")
LEAST_LEAPS = Count(5, "leaps", "fewer may be slips of a sensor")
CHANGES_SHARE = Limit(
    0.1, "share of rows", "in which an axis that moves is read anew, also where its encoder is coarse"
)
CREEPS_SHARE = Limit(0.02, "share of a column's range", "that an axis moves by from row to row")

# held
LONGEST_HOLD_ROWS = Count(64, "rows", "longest hold from one reading to the next")
LEAST_HELD_CHANGES = Count(60, "changes", "fewer changes show no rhythm")
SAME_TURN_SHARE = Limit(0.995, "share", "of the changes that come at one turn")

STALE_STEPS = Limit(
    2.0, "least moves", "a row, before a repeated reading and behind it: slower, an encoder may repeat itself"
)
STALE_LEAP = Limit(
    1.5,
    "times the moves beside",
    "that a repeated reading is made up for by: 2 where the axis goes on evenly, 1 at most where it stood",
)
LEAST_STALE_SHARE = Limit(0.001, "share of rows", "an encoder off by a step now and then: 7 in 100 000 rows by chance")
LEAST_STALE = Count(3, "readings", "fewer in a log are chance", "213 honest logs: four have one, none two")

# inputs
SATURATED_SHARE = Limit(0.02, "share of rows", "more rows at a limit are worth a note")
CLIPPED_SHARE = Limit(0.05, "share of rows", "at one extreme within the limits")
COMMONER = Limit(10.0, "factor", "a staircase has many rows at each of its values")
LEAST_VISITS = Count(3, "visits", "a single long one may be a commanded step")

# locked
LOCKED_S = Limit(20.0, "s", "of a log: time")
WOULD_MOVE = Limit(0.2, "rad or m", "the plant would move an axis that stands")

# motion
LEAST_MOTION_STEPS = Limit(20.0, "encoder steps", "smaller motion is rounding")
JUMPS_RATIO = Limit(
    1.0,
    "ratio",
    "median change from row to row over median distance from the middle; sqrt 2 for numbers without order",
    "exact for white rows",
)

# plant
FINEST_GRID = Limit(1e5, "steps", "beyond it the step is a number format's")
FEW_DIGITS = Count(5, "digits", "a float32 has seven; an encoder's steps are all told apart by five in most ranges")
LEAST_COARSE = Count(
    3, "different readings", "that a grid ten times finer has one in ten of, all by chance in one log of a thousand"
)
COARSE_SHARE = Limit(
    0.5, "share of rows", "rounded by more than the sensor does: what is left would be of small angles alone"
)
COARSER = Limit(10.0, "steps", "that no reading stands between by chance")
ON_GRID = Limit(0.97, "mean phase", "1 for numbers on the grid, 0 for any")
LEAST_GRID_POINTS = Count(20, "points of a grid", "that a column of another kind shares none of by chance")
OFF_GRID = Limit(0.6, "mean phase", "1 for numbers on the grid, 0 for any")
BEYOND_STOP_rad = Limit(0.1, "rad", "offsets and scales of a sensor may carry an angle beyond its stop")
UNIT_QUANTILE = Limit(0.95, "quantile", "rows that speak for the unit")
FAR_BEYOND = Limit(1.5, "times the stop", "an angle this far beyond a stop is in another unit")
LEAST_OF_STOP = Limit(0.2, "share of the stop", "that an angle in degrees reaches where only its size speaks")
ROUND_deg = Limit(
    0.01, "deg", "on whole ones of which readings may be degrees though they lie on the sensor's grid in radians"
)
MOTION_TELLS = Limit(
    2.0, "ratio of misfits", "the unit in which the plant moves so fits so much better; 3.7 and more where it was tried"
)
MOST_rad = Limit(1000.0, "rad", "an axis without stops is counted to")
FULL_percent = Limit(100.5, "percent", "a duty in percent reaches no more")
MACHINE_CLOSE = Limit(1.6, "factor", "a rig may need this much more or less than its plant file says")

# seams
USUAL_SPEED_PERCENT = Limit(99.0, "percentile", "of the speeds from row to row is the usual one")
SEAM_FASTER = Limit(
    5.0, "times the usual speed", "honest logs of two outputs reached 1.5 in both at once", "honest logs"
)
LEAST_SEAM_STEPS = Limit(20.0, "encoder steps", "a quiet log usually moves by one")
SEAM_KINK = Limit(2.0, "times the usual change of speed", "across a step: no force stops a mass at once", "honest logs")
SEAM_ROWS = Count(5, "rows", "a mass that is thrown is fast in the next rows too; a reading that fails comes back")
BESIDE_FIRST_STEPS = Limit(4.0, "encoder steps", "rigs come to rest so near to where they rested before")
BESIDE_FIRST_SHARE = Limit(0.02, "share of a column's range", "a run begins so near to where the one before began")
SEAM_EVEN = Limit(
    0.4,
    "share of the mean move",
    "by which each move beside is off where an axis goes on evenly: an encoder's by a step of four",
)
LONGEST_HELD_S = Limit(
    0.2, "s", "readings repeated so long move on by all that they missed; longer ones are dead stretches"
)

# spikes
SPIKE_STEPS = Limit(
    2.75,
    "least moves",
    "off the way on both sides",
    "75 outputs of published recordings, 6 100 of sealed cases: with these limits no row",
)
UNSPOILT_PERCENT = Limit(
    90.0, "percentile", "of how far rows are off their way, whatever spikes in one of twenty add to that"
)
SPIKE_FACTOR = Limit(4.0, "times that", "off the way: a noisy sensor often is")
SPIKE_SPREAD = Limit(
    0.75, "share of it", "by which the lines beside may disagree about it: an axis that shakes has no line"
)
MOST_OFF_ARE_SPIKES = Limit(
    0.5,
    "share of the rows that are so far off",
    "0.38 at most of honest outputs, 0.7 and more with up to 8 % of spikes",
)
SHAKES_ROWS = Count(3, "rows", "from one to the next at most, at a third of the sampling rate and above")
MOST_NEAR = Limit(0.6, "share of the rows found", "that are so near to another: 0.4 by chance with 8 % of spikes")
SCATTER_AROUND = Count(4, "rows on either side", "that tell the way of an axis where many rows are off it")
SCATTER_PERCENT = Limit(60.0, "percentile", "of how far rows are off that, whatever spikes in one of four add to it")
LEAST_SCATTERED = Limit(0.05, "share of rows", "fewer have an even way beside them")
MOST_SCATTERED = Limit(0.25, "share of rows", "with more, four of nine are off too often")
MOST_HALF_OFF = Limit(0.25, "rows off by half as far", "for each row found: 0.39 and more in published recordings")
NEAR_BY_CHANCE = Limit(
    0.12,
    "share of the rows found",
    "more or less than chance gives of those so near to another: 0.18 and more in published recordings",
)
LEAST_SPIKES = Count(3, "readings", "fewer in a log are chance")
LEAST_SPIKES_SHARE = Limit(0.001, "share of rows", "a carriage between two blows: three rows of 24 841")
SPIKE_ROWS = Count(5, "rows", "in which spikes come together by chance, once some are found")

# stamps
LEAST_ROWS = Count(
    50,
    "rows",
    "fewer rows tell nothing; how long they last does not matter: half a second is a long run of a small motor",
)
GAP_PERIODS = Limit(1.5, "sample periods", "a longer step has rows missing")
GAP_JITTER = Limit(
    4.0, "times the jitter", "more than that is added to a step: what is longer is no late row and no early one"
)
SLOW_S = Limit(1.0, "s", "rows of a plant with an axis that are so far apart are remarked on")
STANDING_S = Limit(
    5.0,
    "s",
    "and refused: no axis shows its motion in them",
    "rigs of all data sets are sampled every 0.5 to 50 ms: in milliseconds 0.5 to 50 s",
)
JITTER_PERIODS = Limit(0.01, "sample periods rms", "more is told")
PERIOD_ERROR_PPM = Limit(500.0, "ppm", "beyond what a crystal does")
THINNED_MOVES = Limit(0.1, "share of rows", "in which an input moves: one that moves less hardly did between the rows")
OF_SO_MANY = Limit(0.01, "share of a whole number of periods", "rows that are so near to it apart are one in so many")

# turned
MIRRORED = Limit(
    0.5,
    "ratio",
    "of the sum to the difference of the ways before and behind: a mirrored one is a third to three times as long",
)

# units
UNIT_FACTOR = Limit(1.35, "factor", "a slope this near a unit's is that unit")
LEAST_CORRELATION = Limit(0.8, "correlation", "less correlated columns are not one quantity in two units")
FOLLOWS_CORRELATION = Limit(
    0.3, "correlation", "the same for an angle that follows its reference late and with overshoot"
)
FOLLOWS_FACTOR = Limit(2.0, "factor", "the same for an angle that follows its reference late and with overshoot")
CLEARLY_BETTER = Limit(5.0, "ratio of errors", "the other unit must fit so much better")
LEAST_MOVING_ROWS = Count(50, "rows", "fewer moving rows tell no unit")

# values
COPY_SHARE = Limit(0.999, "share of rows", "two columns are one number")
GLITCH_FACTOR = Limit(30.0, "times the usual move", "a reading that leaps so far and comes back is left out")
GLITCH_STEPS = Limit(20.0, "encoder steps", "on a coarse grid a leap is at least so far")

# zeros
BESIDE_ZERO_STEPS = Limit(1.5, "least moves", "an axis that passes zero reads it once")
MOST_ZEROS = Limit(0.1, "share of rows", "in which an input was not written down: one that is zero in more is switched")
ZERO_STANDS = Limit(
    0.1, "share", "of the places where an input goes to zero and back, at which it rests there: it is switched"
)

# stretches
MOST_READINGS = Count(25_000, "readings", "time: two logs of a minute of two angles at 100 Hz are taken whole", "timed")
ENOUGH_ROWS = Count(
    4_000, "rows", "of short logs the dense rows are left, as each still tells of noise", "the dense logs below"
)
STRETCHES = Count(8, "stretches", "parts of a long log")
LEAST_STRETCH_S = Limit(10.0, "s", "a stretch is at least so long")
COARSEST_S = Limit(
    10e-3,
    "s",
    "apart, for what the plant file does not state: a mode of 25 Hz is seen four times a swing, and a delay of part of a row is told",
    "cases of the third rig logged at 1 and 2 ms, seeds 348, 349, 351: eight thinned towards 10 ms and twenty to 4 ms have the same "
    "verdicts as those of them that were asked otherwise; of two names the twin came first, and one lag had 0.44, by all rows 0.65",
)
TIMES_SHOWN = Count(3, "times", "of what happened often are named, and the rest counted")
