"""Proofs are checked: those that are written hold, and none that has been changed does."""

from __future__ import annotations

import copy
import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from viewer.__main__ import main
from viewer.output.proof_checker import Checker

PAGE = Path(__file__).parents[3] / "docs" / "proofs.md"


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the proofs lie that the documentation's first command writes."""
    path = tmp_path_factory.mktemp("proofs") / "proofs.json"
    command = PAGE.read_text().split("```sh\n")[1].splitlines()[0]
    assert main([str(path) if word == "proofs.json" else word for word in shlex.split(command)[1:]]) == 0
    return path


@pytest.fixture(scope="module")
def proofs(written: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(written.read_text())
    return found


def holding(data: dict[str, Any]) -> list[bool]:
    checker = Checker(data)
    return [checker.check(proof).holds for proof in checker.proofs]


def test_what_is_certified_holds(written: Path, proofs: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    verdicts = [proof["verdict"] for proof in proofs["proofs"]]
    assert verdicts.count("full") > 5 and verdicts.count("lit") > 5
    assert main(["check-proofs", str(written)]) == 0
    assert "0 do not" in capsys.readouterr().out.splitlines()[-1]


def test_no_verdict_holds_in_place_of_the_other(proofs: dict[str, Any]) -> None:
    turned = copy.deepcopy(proofs)
    other = {"full": ("lit", []), "lit": ("full", list(range(len(proofs["triangles"])))[:64])}
    for proof in turned["proofs"]:
        proof["verdict"], proof["by"] = other[proof["verdict"]]
    assert not any(holding(turned))


def test_hidden_cells_need_all_that_hide_them(proofs: dict[str, Any]) -> None:
    fewer = copy.deepcopy(proofs)
    fewer["proofs"] = [proof | {"by": proof["by"][1:]} for proof in fewer["proofs"] if proof["verdict"] == "full"]
    assert fewer["proofs"] and not any(holding(fewer))


def test_cells_are_not_lit_where_something_is_put_in_the_way(proofs: dict[str, Any]) -> None:
    rng = np.random.default_rng(2)
    lit = [proof for proof in proofs["proofs"] if proof["verdict"] == "lit"][:20]
    for proof in lit:
        light, corners = np.array(proofs["lights"][proof["light"]]), np.array(proofs["cells"][proof["cell"]])
        middle = light + rng.uniform(0.1, 0.9) * (rng.dirichlet(np.ones(6)) @ corners - light)
        e1, e2 = 1e-4 * rng.normal(size=(2, 3))
        row = np.concatenate([middle - (e1 + e2) / 3, e1, e2]).tolist()
        blocked = proofs | {"triangles": [*proofs["triangles"], row], "proofs": [proof]}
        assert holding(blocked) == [False]


def test_triangles_hide_together_what_none_hides_alone() -> None:
    """Two triangles that overlap between a light and a prism; and the same with a slit."""
    prism = [[x, y, z] for z in (0.0, 0.01) for x, y in ((-1, -1), (1, -1), (-1, 1))]
    halves = [[-2.0, -2.0, 1.0, 4.0, 0.0, 0.0, 0.0, 4.0, 0.0], [2.0, 2.0, 1.0, -4.4, 0.0, 0.0, 0.0, -4.4, 0.0]]
    data = {"lights": [[0.1, 0.2, 9.0]], "triangles": halves, "boxes": [], "cells": [prism]}

    def hold(by: list[int], triangles: list[list[float]] = halves) -> bool:
        proof = {"cell": 0, "light": 0, "verdict": "full", "by": by}
        return holding(data | {"triangles": triangles, "proofs": [proof]})[0]

    assert hold([0, 1]) and hold([1, 0]) and not hold([0]) and not hold([1]) and not hold([])
    slit = [halves[0], [halves[1][0] + 0.5, *halves[1][1:]]]
    assert not hold([0, 1], slit)


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{}", "[" * 100_000, '{"lights": [[1, 2]], "triangles": [], "boxes": [], "cells": [], "proofs": []}',
     '{"lights": [[1, 2, NaN]], "triangles": [], "boxes": [], "cells": [], "proofs": []}',
     '{"lights": [["1", 2, 3]], "triangles": [], "boxes": [], "cells": [], "proofs": []}',
     '{"lights": [[1, 2, 1' + 400 * "0" + ']], "triangles": [], "boxes": [], "cells": [], "proofs": []}',
     '{"lights": [], "triangles": [], "boxes": [], "cells": [], "proofs": []}'],
)  # fmt: skip
def test_what_is_no_proof_is_one_line(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bad.json"
    path.write_text(text)
    assert main(["check-proofs", str(path)]) == 1
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "bad.json" in line and "a bug" not in line


def test_what_only_touches_is_in_the_way() -> None:
    """A triangle that segments lie in, and a cell of no extent inside of a triangle."""
    flat, light = 2 * [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 10.0]
    within = [0.0, -5.0, 5.0, 0.0, 10.0, 0.0, 0.0, 0.0, 1.0]
    lit = {"cell": 0, "light": 0, "verdict": "lit", "by": []}
    data = {"lights": [light], "triangles": [within], "boxes": [], "cells": [flat], "proofs": [lit]}
    assert holding(data) == [False]
    assert holding(data | {"cells": [6 * [[0.0, 0.0, 5.2]]]}) == [False]


def test_a_frame_of_which_nothing_is_certified_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lamps = ["--lamp-radius", "0.1", "--lamp-samples", "16"]
    assert main(["prove", "figure3", "-o", str(tmp_path / "p.json"), "--size", "32x24", *lamps]) == 1
    assert "no light is a point" in capsys.readouterr().err.strip().splitlines()[-1]
    assert not (tmp_path / "p.json").exists()


def test_names_that_are_not_there_do_not_hold(proofs: dict[str, Any]) -> None:
    by = [{"by": [10**9]}, {"by": [-1]}, {"by": 3}]
    for wrong in ({"cell": 10**9}, {"cell": -1}, {"light": True}, {"light": "x"}, {"verdict": ["lit"]}, *by):
        assert holding(proofs | {"proofs": [proofs["proofs"][0] | {"verdict": "full"} | wrong]}) == [False]
