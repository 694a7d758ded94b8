"""Numbers as people read them."""

from __future__ import annotations

import pytest

from tracer.util.text import saved
from viewer.util.numbers import changed, saved_in_words


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (0.4123, "41.2%"), (0.0, "0.0%"), (-9.99, "-999.0%"), (-17.413, "18.4 × as many"),
        (-1193.6, "1,195 × as many"),
    ],
)  # fmt: skip
def test_what_takes_far_more_is_told_as_so_many_times(part: float, said: str):
    assert saved(part) == said
    assert saved_in_words(part) == (said if "×" in said else f"{said} saved")


def test_savings_vary_in_the_same_unit():
    assert saved(0.4123, 0.012) == "41.2% ± 1.2"
    assert saved(-17.413, 0.5) == "18.4 ± 0.5 × as many"


def test_changes_have_a_sign():
    assert (changed(-0.412), changed(0.031), changed(1193.6)) == ("−41.2%", "+3.1%", "1,195 × as many")
