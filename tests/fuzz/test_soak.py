"""Long use, for a short while; and that growth would be noticed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.soak import SCENES, Sample, Soak, growing
from tests.sweeps import cases


def test_a_restless_user_meets_nothing_wrong(tmp_path: Path):
    acts = cases(30, 400)
    user = Soak(list(cases(SCENES[1:], SCENES[:2])), seed=1, folder=tmp_path)
    for _ in range(acts):
        user.act()
    user.rest()
    user.close()
    assert not user.wrong and sum(user.done.values()) == acts
    assert len(user.done) > 12 and user.compared > 0


@pytest.mark.parametrize("what", ["memory", "threads", "files"])
def test_what_grows_is_said(what: str):
    flat = [Sample(float(second), second, 500 << 20, 4, 8) for second in range(100)]
    assert growing(flat) == []
    grown = [sample._replace(**{what: getattr(sample, what) * (1 + sample.acts // 10)}) for sample in flat]
    assert [line.split()[0] for line in growing(grown)] == [what]
    assert growing(grown[:10]) == [], "so few samples tell nothing"
