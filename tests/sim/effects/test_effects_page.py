"""docs/effects.md is what the library says."""

from sim.composition.page import effects_page
from sim.effects import effects_for
from sim.plants import MODELS
from tests.test_project import ROOT


def test_the_page_is_made_from_the_library() -> None:
    """To write it anew: python -c "from sim.composition.page import *; print(effects_page(), end='')" > docs/effects.md"""
    assert (ROOT / "docs" / "effects.md").read_text(encoding="utf-8") == effects_page()


def test_the_page_names_every_effect() -> None:
    page = effects_page()
    for model in MODELS.values():
        assert all(f"`{name}`" in page for name in effects_for(model()))
