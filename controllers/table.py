"""The table of controllers: a new one is a file with its row here (and a template, where its C is not another's)."""

from collections.abc import Mapping

from controllers import fuzzy, instantaneous, lqg, pid, scheduled
from controllers.controller import Controller

CONTROLLERS: Mapping[str, Controller] = {
    row.name: row
    for row in (
        scheduled.CONTROLLER,
        instantaneous.CONTROLLER,
        pid.CONTROLLER,
        fuzzy.CONTROLLER,
        lqg.CONTROLLER,
    )
}
