"""What is said of references that lie beyond what an input can do."""

from records.text.units import unit_of, unit_suffix

LONG = "for {:.3g} s on end"
MOSTLY = "for most of the second before the next step"


def beyond_reach(output: str, own_input: str, limit_V: float, how_long: str) -> str:
    """That an output's references lie beyond what its input can do, which stood at a limit so long."""
    at = f"{limit_V:.4g} {unit_of(own_input)}".rstrip()
    return f"{own_input} stands at its limit of {at} {how_long}: the references of {output} lie beyond what it can do"


def smaller(output: str) -> str:
    """What makes an output's references smaller."""
    ends = " and ".join(f"reference_{end}_{unit_suffix(output)}".rstrip("_") for end in ("min", "max"))
    return f"Fly smaller ones: narrow {ends} in [design]"
