"""Pictures of meshes remember how the mesh was read, and say so in the command that makes them again."""

from __future__ import annotations

from pathlib import Path

import pytest

from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO, MeshOptions
from tracer.settings import Settings
from viewer.cli.main import viewer_parser
from viewer.cli.options import mesh_options
from viewer.output import commands
from viewer.state import codec
from viewer.state.view_state import ViewState


@pytest.mark.parametrize("meshes", [AS_IN_FILE, IN_STUDIO, MeshOptions(True, "-z", 12.5), MeshOptions(False, "x", 0.0)])
def test_the_command_and_the_options_lead_back(meshes: MeshOptions) -> None:
    made = ViewState("/a.ply", meshes, settings=Settings(method="none"))
    words = commands.words(made, None, "a.png")
    assert (
        mesh_options(viewer_parser().parse_args([w for w in words if w.startswith(("--up", "--crease", "--no-st"))]))
        == meshes
    )
    assert mesh_options(viewer_parser().parse_args(["a.ply", *commands.mesh_options(meshes)])) == meshes
    of_aff = commands.words(ViewState("/a.aff", meshes, settings=Settings(method="none")), None, "a.png")
    assert not {"--no-studio", "--up=-z"} & set(of_aff)


def test_a_dash_and_an_axis_are_a_value() -> None:
    assert mesh_options(viewer_parser().parse_args(["a.ply", "--up", "-z"])) == MeshOptions(True, "-z")


def test_a_state_keeps_them_and_one_without_had_no_studio(tmp_path: Path) -> None:

    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    data = codec.state_to_json(ViewState(meshes=MeshOptions(True, "-x", 3.0)))
    assert codec.state_from_json(data).meshes == MeshOptions(True, "-x", 3.0)
    assert codec.state_from_json({k: v for k, v in data.items() if k != "meshes"}).meshes == AS_IN_FILE
    for bad in (5, {"up": 3}, {"up": "w"}, {"crease": "x"}, {"crease": 1e9}):
        with pytest.raises(ValueError, match="mesh|axis|up|crease") as error:
            codec.state_from_json(data | {"meshes": bad})
        assert "\n" not in str(error.value)
