"""Names, classes and notes of a diagnosis, and numbers from small to many times the model's, as a person reads them."""

from dataclasses import replace

from records.diagnosis import ErrorResponse
from records.reasons import Note
from tests.twinlaw.pages.diagnose.told import WORDS, text_of
from twinlaw.pages.diagnose.summary import summary_text
from twinlaw.pages.diagnose.words import class_in_words, plain_notes


def test_words_stand_beside_what_is_short_or_has_no_meaning() -> None:
    assert class_in_words("torque(domega_M/dt)").endswith("a torque or force that depends on how fast omega_M changes")
    assert class_in_words("torque(psi, sgn psi_dot) on elevation").endswith(
        "depends on psi and the direction in which psi moves"
    )
    lost = class_in_words("output(sum of phi_dot) of phi")
    assert lost.endswith("an error of the reading that depends on how far phi moved at each speed")
    assert class_in_words("dead band of u_V on input") == "dead band of u_V on input"
    kept = Note("something_else_missing", "a.b", {"gain_nats": 0.1, "left_nats": 0.9})
    said = (
        "a.b makes predictions of the hold-out 1.1 times as good, yet they stay 2.5 times as far off as "
        "the sensors and the noise would leave them: something else is missing"
    )
    assert plain_notes([kept, kept]) == [said]
    (plain,) = plain_notes([Note("contradiction", "b", {"gain_nats": 250.0, "moved": {"K_M": 4.2}})])
    assert "b would be e^250 times likelier with numbers of its own (K_M +4.2," in plain


def test_an_answer_many_times_the_models_is_told_without_powers_of_ten() -> None:
    rows = tuple(
        ErrorResponse("psi_rad", "u_M_V", 1.0, 2.0, error, sd, 0.7, coherence)
        for error, sd, coherence in ((12.14, 2.1, 0.97), (0.04541, 0.0052, 0.9))
    )
    told = summary_text(replace(WORDS, error_responses=rows))
    assert "psi to u_M from 1 to 2 Hz differs by 1210 ± 210 %, phase 40 deg (coherence 0.97)" in told
    assert "4.54 ± 0.52 %" in text_of(replace(WORDS, error_responses=rows))
