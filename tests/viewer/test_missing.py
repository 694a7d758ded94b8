"""What is said over a picture in a view that its method has nothing to show in."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.conftest import make_frame, with_certificates
from tracer.frame import Settings
from viewer.methods import BASES_TOLD
from viewer.missing import missing
from viewer.views import View


@pytest.mark.parametrize("method", [*BASES_TOLD, "certified+cache", "paper+rest", "none+cache"])
@pytest.mark.parametrize("view", list(View))
def test_a_view_that_a_method_has_nothing_for_names_a_method_that_has(view: View, method: str):
    frame = make_frame(Settings(16, 8, method=method, modes=True, verify=True))
    if method.startswith("certified"):
        frame = with_certificates(frame)
    found = missing(view, frame)
    shows = {View.CERTIFICATE: ("certified",), View.DIFFERENCE: ("paper", "cells"), View.WIPE: ("paper", "cells")}
    if view not in shows or method.split("+")[0] in shows[view]:
        assert found is None
    else:
        assert found is not None and found.base in shows[view] and method.split("+")[0] in found.text


def test_modes_that_were_not_kept_are_missing():
    frame = make_frame(Settings(16, 8, method="none"))
    for view in (View.OCCLUSION, View.SHADOW, View.PIXEL_COUNT):
        assert not view.can_draw(frame) and "no modes" in missing(view, frame).text
        kept = replace(frame, settings=replace(frame.settings, modes=True))
        assert view.can_draw(kept) and missing(view, kept) is None
