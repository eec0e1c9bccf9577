"""A bound plant's [design] section in; what its controller shall be out, completed with defaults and checked."""

from design.settings.section import DEFAULTS as DEFAULTS
from design.settings.section import MARGIN_DEFAULTS as MARGIN_DEFAULTS
from design.settings.section import read_settings as read_settings
from design.settings.together import SAMPLE_PERIODS_S as SAMPLE_PERIODS_S
from design.settings.wishes import LEAST_RELATIVE_GAIN as LEAST_RELATIVE_GAIN
from design.settings.wishes import ROLL_OFF_FROM_S as ROLL_OFF_FROM_S
from design.settings.wishes import AxisSettings as AxisSettings
from design.settings.wishes import DesignSettings as DesignSettings
from design.settings.wishes import MarginLimits as MarginLimits
