"""The change of basis between the paper's form and the delta form."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from design.direct_form import DirectForm, to_delta, to_direct

NUMBERS = st.lists(st.floats(-1e3, 1e3), min_size=7, max_size=7)
Z = np.exp(1j * np.linspace(0.1, 3.0, 7))


def direct(values):
    return DirectForm(q=np.array(values[:4]), p=np.append(1.0, values[4:]))


@given(NUMBERS)
def test_both_forms_are_the_same_two_polynomials(values):
    form = direct(values)
    delta_form, delta = to_delta(form), 1.0 - 1.0 / Z
    q = np.polyval(delta_form.q[::-1], delta)
    p = 1.0 - (1.0 - delta_form.p[0] + delta_form.p[1] * delta + delta_form.p[2] * delta**2) / Z
    size = 1.0 + np.max(np.abs(values))
    np.testing.assert_allclose(q, np.polyval(form.q[::-1], 1.0 / Z), atol=1e-13 * size)
    np.testing.assert_allclose(p, np.polyval(form.p[::-1], 1.0 / Z), atol=1e-13 * size)


@given(st.lists(st.integers(-1000, 1000), min_size=7, max_size=7))
def test_there_and_back_is_exact_for_integers(values):
    form = direct([float(value) for value in values])
    back = to_direct(to_delta(form))
    np.testing.assert_array_equal(back.q, form.q)
    np.testing.assert_array_equal(back.p, form.p)


def test_gain_at_rest_and_integrator_are_coefficients_of_their_own():
    delta = to_delta(direct([5.0, -9.0, 3.0, 1.5, -1.5, 0.75, -0.25]))
    assert delta.q[0] == 0.5
    assert delta.p[0] == 0.0
