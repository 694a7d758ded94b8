"""Mistakes on the command line: each ends in one line, and nothing is written."""

from __future__ import annotations

import shlex
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import ROOM, Run
from tracer.scene.model import Camera
from viewer.cli import main as command_line
from viewer.output import capture
from viewer.state import codec
from viewer.state.view_state import ViewState

RENDER = "render room.aff -o x.png"
SMALL = "bench figure4 --path-frames 6 --size 48x32"
FAR = '{"position": [1e300, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "angle": 40}'
AWAY = '{"position": [0, 0, 20], "direction": [0, 0, 1]}'
READ, TRACED = "viewer.cli.options.load_visible_scene", "viewer.cli.options.prepare_kernels"

MISTAKES = {
    "": [
        ("rendr x.aff", "did you mean 'render'?"),
        ("info figur4", "figur4: no such file, and no scene of the program: did you mean 'figure4'?"),
        ("info rooom.aff", "rooom.aff: no such file: did you mean '"),
        ("frobnicate", "the commands are render, film, bench"),
        ("--frame 3", "unrecognized arguments"),
        ("room.aff --lamp-samples 0", "argument --lamp-samples: 0 is not a whole number from 1 to 1024"),
        *((f"{command} no.aff", "no.aff: no such file") for command in ("info", "render", "bench", "zoom")),
        *((f"{command} notes.md", "unknown kind of scene") for command in ("info", "render", "bench", "zoom")),
        ("info plain.png", "not one saved by Shadowcull"),
        ("bench saved.png", "saved.png"),
        ("render plain.png", "not one saved by Shadowcull"),
        ("render broken.png", "cannot be read as a picture"),
        ("render gone.png", "no such file"),
        ("render orphan.png", "its scene is gone"),
        ("render endless.png", "endless.png: its scene is gone"),
        (f"check {5000 * 'x'}.png", "xxx.png: File name too long"),
        (5000 * "x", "xxx: File name too long"),
        ("check large.png", "large.png: 11000 x 11000 pixels: no picture of Shadowcull has so many"),
        ("zoom room.aff --primitive 0 --camera gone.png", "--camera: gone.png: no such file"),
    ],
    "render room.aff": [
        ("-o x.gif", "unknown kind of file"),
        ("-o none/x.png", "there is no folder"),
        ("-o taken", "unknown kind of file"),
        ("--buffers x.zip", "unknown kind of file; --buffers writes .npz"),
        ("--figure1 x.png", "--figure1 writes .svg"),
        ("", "nothing to write"),
    ],
    RENDER: [
        ("--frame 10", "frame numbers are 0 to 9"),
        ("--frame -1", "frame numbers are 0 to 9"),
        ("--frame two", "two is not a whole number"),
        ("--time nan", "nan is not a number"),
        ("--time 9.5", "time runs from 0 to 9"),
        ("--frame 1 --time 1", "not allowed with"),
        ("--size big", "is not a size"),
        ("--size 0x10", "is not a size"),
        ("--size 999999x999999", "too many: 67,108,864 at most"),
        ("--size \x1b]0;title\x07", r"\x1b]0;title\x07"),
        ("--samples 0", "0 is not a whole number from 1 to 4096"),
        ("--lamp-radius 1e308", "argument --lamp-radius: 1e308 is not a number from 0 to 1e+09"),
        ("--lamp-samples 2.5", "argument --lamp-samples: 2.5 is not a whole number from 1 to 1024"),
        ("--method magic", "invalid choice: 'magic'"),
        ("--method paper,none", "invalid choice: 'paper;none'"),
        ("--method certfied", "invalid choice: 'certfied': did you mean 'certified'?"),
        ("--accelerator kdtre", "kdtre is not one of bvh8, kdtree, kdtree-lazy: did you mean 'kdtree'?"),
        ("--view heat", "'heat' is not a view; the views are color, occlusion, shadow"),
        ("--view certificat", "'certificat' is not a view: did you mean certificate:LIGHT?"),
        ("--view fate:0 --method lightcuts", "single lights have no rays; give --method paper"),
        ("--view cuts --method auto", "the method auto has nothing for it; give --method lightcuts"),
        ("--view voxels --method none", "the method none has nothing for it; give --method voxels"),
        ("--view cell-lights --method paper", "give --method lie-exact"),
        ("--view shadow:7", "lights are 0 to 1"),
        ("--view depth:1", "is not a view"),
        ("--view wipe:half", "is not a view; give wipe:PART: half is not a number from 0 to 1"),
        ("--slice x:0.1", "--slice does nothing in the view color; it is for voxels"),
        ("--view voxels --slice q:0.1", "is not a slice"),
        ("--tone sepia", "sepia is not one of none, reinhard, filmic, srgb"),
        ("--white 0", "0 is not a number from 0.01 to 1000"),
        ("--range 5:2 --view depth", "'5:2' is not a range; give the smaller number and the larger one"),
        ("--range 0:5", "--range does nothing in the view color; it is for depth, saved, cost, lights"),
        ("--range 0:5 --view cost:share", "in the view cost:share"),
        ("--exposure 1 --view normal", "--exposure does nothing in the view normal; it is for color, "),
        ("--mark-clipped --view depth", "--mark-clipped does nothing in the view depth; it is for color, wipe"),
        ("--camera {bad", '--camera: {bad is not JSON; give a camera like {"position"'),
        ("--camera {}", "--camera: a camera's position"),
        (f"--camera '{AWAY.replace('20', 'true')}'", "a camera needs lists of numbers"),
        (f"--method {10**5 * 'x'}", "xxx ... "),
        (f"--camera '{FAR}'", "a camera's position lies within 1e+09"),
        ("--camera nowhere.json", "neither JSON nor a file"),
        ("--camera plain.png", "--camera: plain.png"),
        ("--hide flier", "--hide flier: no object of this name; there is "),
        ("--make-static flyer", "'flyer' is not an object and a time"),
        ("--hide-primitive 9", "--hide-primitive 9: the scene has the primitives 0 to 3"),
        ("--make-static room=1", "no moving object of this name; there is flyer"),
        ("--make-moving flyer", "no static object of this name"),
        ("--move-light 0", "give them like 2=1.5,3,-0.5"),
        ("--move-light 0=1.1e9,0,5", "a place within 1e+09 of the origin"),
        ("--move-light 0=nan,0,5", "a place within 1e+09 of the origin"),
        ("--without-light 2", "--without-light 2: the scene's lights are 0 to 1"),
        ("--warm 3", "unrecognized arguments"),
        ("--warmup -3", "-3 is not a whole number from 0 to"),
        ("--wurmup 3", "unrecognized arguments: --wurmup 3: did you mean '--warmup'?"),
        ("--telepathy", "unrecognized arguments: --telepathy (see"),
    ],
    "film room.aff": [
        ("", "nothing to write"),
        ("-o d --frames 4-20", "frame numbers are 0 to 9"),
        ("-o d --frames 9-3", "argument --frames: '9-3' is not a range of frames"),
        ("-o d --through saved.png", "needs two bookmarks, or saved pictures, at least; there are 1"),
        ("-o d --bookmarks", "at least; there are 0"),
        ("-o d --bookmarks --frames 0-3", "not allowed with"),
        ("-o taken", "numbered pictures in it already; give another folder"),
        ("-o file", "no folder for the pictures"),
        ("-o gone/d", "gone/d: there is no folder gone"),
        ("-o d --caption {sceen}", "the caption '{sceen}' is wrong: there is no field {sceen}, but scene"),
        ("-o d --view shadow:7", "the scene's lights are 0 to 1"),
        ("-o d --view voxels --method paper", "nothing for it; give --method voxels"),
        ("-o d --exposure 1 --view normal", "--exposure does nothing in the view normal"),
    ],
    "figure room.aff --size 64x48 --threads 1": [
        ("-o f.svg", ".png .pdf"),
        ("-o f.png --crops 60,0,10,10", "60,0,10,10: not inside"),
        ("-o f.png --methods none,none", "each once"),
        ("-o f.png --view certificate:0", "one method alone"),
        ("-o f.png --view shadow:9", "lights are 0 to 1"),
        ("-o f.png --view voxels", "the method none has nothing for it; give --methods voxels"),
        ("-o f.png --view cuts --methods lightcuts,paper", "it; give --methods lightcuts"),
    ],
    "explain room.aff --size 48x32": [
        ("", "the following arguments are required: --pixel"),
        ("--pixel 48,0", "--pixel 48,0: the picture is 48 x 32"),
        ("--pixel 1", "is not a pixel"),
        ("--pixel 1,1 --light 9", "--light 9: "),
        ("--pixel 1,1 --method no", "invalid choice"),
        ("--pixel 1,1 --frame 99", "frame numbers are 0 to 9"),
        ("--pixel 1,1 --before [1]", "not understood"),
    ],
    "hunt room.aff": [
        ("--frames 50-99", "the scene's frame numbers are 0 to 9"),
        ("--method luck", "invalid choice: 'luck'"),
        ("--radius -1", "is not a number from 0 to 100"),
        ("--keep 0", "is not a whole number from 1 to 1000"),
    ],
    SMALL: [
        ("--frames 5:2", "give A:B, the frames A to B - 1 of the 6 there are"),
        ("--frames 1-4", "--frames 1-4: give A:B"),
        ("--zoom-factor 0", "argument --zoom-factor: 0 is not a number from 1 up"),
        ("--method none", "unrecognized arguments: --method none"),
        ("--methods telepathy", "argument --methods: invalid choice: 'telepathy'; it is one of none"),
        ("--methods all,telepathy", "+lightbuffer, +cache-directions, +cache-tile, +packets16, +packets1; or all"),
        ("--methods ''", "argument --methods: invalid choice: ''"),
        ("--methods papr,paper,certifed",
         "invalid choice: 'papr': did you mean 'paper'? 'certifed': did you mean 'certified'? (see"),
        ("--methods papr,all,telepathy", "'papr': did you mean 'paper'? 'telepathy'; it is one of none"),
        ("--accelerator kdtree-lasy", "kdtree-lazy: did you mean 'kdtree-lazy'?"),
        ("--accelerator grid", "grid is not one of bvh8, kdtree"),
        ("--methd paper", "unrecognized arguments: --methd paper: did you mean '--methods'?"),
        ("--lamp-sample=4", "unrecognized arguments: --lamp-sample=4: did you mean '--lamp-samples'?"),
    ],
    "zoom figure4 --size 32x32": [
        (f"--primitive 1 --camera '{AWAY}'", "is not to be seen"),
        ("--pixel 0,0", "shows no primitive"),
    ],
}  # fmt: skip
KNOWN_EARLY = {
    (SMALL, READ): [
        ("--plot plot.gif", "plot.gif: unknown kind of plot; give one of .png .svg .pdf"),
        ("--plot plot", "unknown kind of plot"),
        ("--plot none/plot.png", "there is no folder"),
        ("--json taken", "a folder"),
        ("--csv same --json same", "a file of its own"),
        ("--methods none --plot plot.png", "nothing to compare with none"),
    ],
    ("zoom figure4 --size 32x32", READ): [
        ("", "towards which primitive? give --pixel X,Y"),
        ("--primitive -1", "-1 is not a whole number from 0"),
        ("--pixel middle", "is not a pixel"),
        ("--primitive 0 --pixel 1,1", "not allowed with"),
        ("--primitive 0 --factors 4,zero", "not zoom factors"),
        ("--primitive 0 --ratio 1.5", "argument --ratio: 1.5 is not a number from 0.001 to 0.9999"),
        ("--primitive 0 --zoom-factor 4", "unrecognized arguments"),
        ("--pixel 32,0", "32 × 32 pixels"),
        ("--primitive 0 --ratio 0.5 --steps 50", "go fewer"),
        ("--primitive 0 --factors 2,3,4,5,6,7,8", "these are 7 zoom factors; give 6 at most"),
        ("--primitive 0 --json gone/z.json", "there is no folder"),
    ],
    ("zoom figure4 --size 32x32", TRACED): [
        ("--primitive 7", "there is no primitive 7; the scene's are 0 to 1"),
        ("--primitive 0 --frame 99", "frame numbers are 0 to 59"),
    ],
}


@pytest.fixture(autouse=True)
def files(room: Path) -> None:
    """What lies in the folder: saved pictures, one of them of a scene that is gone, and what is none."""
    Path("taken").mkdir()
    for name in ("taken/0110.png", "file", "notes.md", "broken.png"):
        Path(name).write_bytes(b"no picture")
    Image.new("RGB", (4, 4)).save("plain.png")
    for name, scene in (("saved.png", "room.aff"), ("orphan.png", "gone.aff"), ("endless.png", "a" * 5000)):
        state = ViewState(str(Path(scene).absolute()), camera=Camera((0.0, 2.0, 3.0), (0.0, -0.5, -1.0)))
        carried = capture.Carried(codec.state_to_json(state, of_picture=True), state.camera.to_json())
        capture.write(Path(name), np.zeros((4, 4, 3), np.uint8), carried.text())
    file = bytearray(Path("saved.png").read_bytes())  # whose head says another size
    file[16:24] = 2 * (11_000).to_bytes(4, "big")
    file[29:33] = zlib.crc32(file[12:29]).to_bytes(4, "big")
    Path("large.png").write_bytes(file)


def complained(run: Run, command: str) -> str:
    """The one line that a command says, which writes nothing."""
    before = sorted(Path().rglob("*"))
    said = run.fails(*shlex.split(command))
    assert "\x1b" not in said and sorted(Path().rglob("*")) == before
    return said


@pytest.mark.parametrize(
    ("command", "said"), [(f"{begin} {rest}", said) for begin, rows in MISTAKES.items() for rest, said in rows]
)
def test_mistakes_end_in_one_line(run: Run, command: str, said: str) -> None:
    assert said in complained(run, command)


@pytest.mark.parametrize(
    ("command", "never", "said"),
    [(f"{begin} {rest}", never, said) for (begin, never), rows in KNOWN_EARLY.items() for rest, said in rows],
)
def test_what_words_alone_tell_is_told_before_any_work(
    run: Run, monkeypatch: pytest.MonkeyPatch, command: str, never: str, said: str
) -> None:
    monkeypatch.setattr(never, lambda *_: pytest.fail(never))
    assert said in complained(run, command)


@pytest.mark.parametrize(
    ("module", "command", "said"),
    [
        ("OpenEXR", "render room.aff -o out.exr", "shadowcull[exr]"),
        ("av", "film room.aff -o d.mp4", "shadowcull[video]"),
        ("distributed", "sweep study.toml", "install shadowcull[sweep]"),
    ],
)
def test_what_is_not_installed_is_named(
    run: Run, monkeypatch: pytest.MonkeyPatch, module: str, command: str, said: str
) -> None:
    Path("study.toml").write_text('scenes = ["room.aff"]\nmethods = ["none", "paper"]\nsizes = ["40x30"]\n')
    monkeypatch.setitem(sys.modules, module, None)
    assert said in complained(run, command)


def test_errors_in_a_scene_name_file_and_line(run: Run) -> None:
    Path("bad.aff").write_text("b 0 0 0\ns 0 0 zero 1\n")
    for command in ("info bad.aff", "render bad.aff -o x.png"):
        assert "bad.aff:2" in complained(run, command)
    Path("empty.aff").write_text("v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 hither 1 resolution 8 8\nl 0 1 0\n")
    assert "nothing to see" in complained(run, "render empty.aff -o x.png")
    run.ok("info", "empty.aff", "--json")


def test_a_scene_reads_from_its_folder_and_those_that_are_named(run: Run) -> None:
    Path("scene").mkdir()
    Path("scene/a.aff").write_text(f"{ROOM}i 0 ../room.aff\n")
    assert "lies outside of the scene's folder" in run.fails("info", "scene/a.aff")
    run.ok("info", "scene/a.aff", "--folder", ".")


def test_names_are_neither_broken_nor_obeyed(run: Run) -> None:
    long, red = f"{'long-' * 20}name.aff", "\x1b[31mred"
    Path(long).write_text(ROOM)
    assert run.ok("info", long).splitlines()[0] == long
    assert "\x1b" not in run.fails("info", f"{red}.aff")
    Path(f"{red}.aff").write_text(ROOM)
    for arguments in (("info",), ("render", "-o", f"{red}.png", "--size", "48x32")):
        code, out, err = run(*arguments, f"{red}.aff")
        assert code == 0 and "\x1b" not in out + err and r"\x1b[31mred" in out


def test_an_output_that_cannot_be_written_is_known_before_tracing(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "touch", refuse)
    monkeypatch.setattr("viewer.cli.render.Renderer", lambda *_: pytest.fail("nothing may be traced"))
    assert "cannot be written to: Permission denied" in complained(run, RENDER)


def test_help_shows_examples(run: Run) -> None:
    for command in ([], *([name] for name in command_line.COMMANDS)):
        code, out, err = run(*command, "--help")
        assert (code, err) == (0, "")
        assert "examples:\n  shadowcull" in out
