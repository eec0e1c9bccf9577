"""An ARMv6-M image and how often its loops pass in; static bounds on cycles and stack of its functions out."""

from verification.static_bound.bound import LoopPasses as LoopPasses
from verification.static_bound.bound import PathShare as PathShare
from verification.static_bound.bound import StaticBound as StaticBound
from verification.static_bound.bound import static_bound as static_bound
from verification.static_bound.kept import kept_bound as kept_bound
from verification.static_bound.routines import LoopBound as LoopBound
