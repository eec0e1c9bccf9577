"""Generated C in the simulation's compiled loop: the same law.c that the firmware has, called by the kernel once a sample."""

from collections.abc import Mapping

from records.loops import LOOPS, Loop
from sim.runs.compiled_run import CController
from sim.wiring import Wiring
from toolchain.host import STRICT_FLOAT_FLAGS, CText, build_shared, load_shared
from verification.drivers import driver


class FlownLaw:
    """A compiled float32 law that flies whole flights without Python, one after another."""

    declarations = """
        uint32_t law_flight_size(void);
        void law_flight_start(void *self, uint32_t samples);
        void law_flight_step(void *context, const double *reference_rad, const double *angle_rad, double *u_V);
    """

    def __init__(self, texts: Mapping[str, str], loops: tuple[Loop, ...] = LOOPS, wires: Wiring | None = None) -> None:
        """Compile the generated `texts` (file name -> C) of a law of `loops`, by which a plant is wired, or whose columns are the plant's.

        Raises BadInput when the compiler refuses.
        """
        places = tuple(range(len(loops)))
        outputs, inputs = (places, places) if wires is None else (wires.outputs, wires.inputs)
        rest_V = [] if wires is None else wires.rest_V.tolist()
        resting = [(place, u_V) for place, u_V in enumerate(rest_V) if place not in inputs]
        flight = driver("law_flight.c", loops, outputs=outputs, inputs=inputs, resting=resting)
        sources = [CText(name, text) for name, text in texts.items()]
        library = build_shared("flight", [*sources, flight], flags=STRICT_FLOAT_FLAGS)
        self._ffi, self._lib = load_shared(self.declarations, library)
        self._state = self._ffi.new("char[]", self._lib.law_flight_size())

    def controller(self, samples: int) -> CController:
        """The law for flights of `samples` samples each, to be given to sim.simulate; this object must outlive the flight."""
        self._lib.law_flight_start(self._state, samples)
        address = self._ffi.addressof(self._lib, "law_flight_step")
        return CController(int(self._ffi.cast("intptr_t", address)), int(self._ffi.cast("intptr_t", self._state)))
