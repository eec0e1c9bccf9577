"""Names and numbers of a file's signals in words."""

from recordings.signals import counted, listed


def test_names_are_listed_as_far_as_they_fit_with_how_many_more_there_are() -> None:
    names = ["u", *(f"output[{k}]" for k in range(16)), "q[0]", "esc[0].rpm", "esc[1].rpm", "t_s [s]"]
    assert listed(names) == "u, output[0..15], q[0], esc[0].rpm, esc[1].rpm, t_s [s]"
    assert listed(names, 26) == "u, output[0..15], q[0] and 3 more"
    assert listed(["a" * 50, "b"], 20) == f"{'a' * 20} and 1 more"
    assert listed([]) == "nothing of numbers"


def test_one_thing_is_one() -> None:
    assert (counted(1, "samples"), counted(2, "samples")) == ("1 sample", "2 samples")
