"""What the commands' `--help` says below their options."""

from __future__ import annotations

COMMANDS = """\
commands:
  shadowcull [SCENE]       open the viewer
  shadowcull render SCENE  trace one frame into a picture, its buffers, or both; needs no display
  shadowcull film SCENE    trace a path, or a flight through bookmarks, into pictures and a video
  shadowcull bench SCENE   measure, over a path of frames, what culling saves
  shadowcull sweep STUDY   measure many scenes, methods and settings by several processes, or machines
  shadowcull zoom SCENE    move towards a primitive, and see whether its shadows stay right
  shadowcull explain SCENE say what became of each ray of one pixel
  shadowcull hunt SCENE    search a path for the worst wrong pixels of a method
  shadowcull cube SCENE    save what a light sees in each direction, as a picture
  shadowcull figure SCENE  draw a frame by several methods side by side
  shadowcull check FILE    render saved pictures and figures again, and say whether they are still true
  shadowcull info SCENE    say what a scene holds

examples:
  shadowcull
  shadowcull kitchen.aff --lamp-radius 0.1
  shadowcull render kitchen.aff -o kitchen.png --frame 50 --warmup 10 --view occlusion
  shadowcull info kitchen.aff --json

Each command has its own --help.
"""

RENDER = """\
examples:
  shadowcull render -o room.png
  shadowcull render kitchen.aff -o kitchen.png --size 1024x768 --samples 16
  shadowcull render kitchen.aff -o soft.png --frame 100 --lamp-radius 0.1 --lamp-samples 64
  shadowcull render kitchen.aff -o bright.png --exposure 1 --white 4 --tone filmic
  shadowcull render kitchen.aff -o modes.png --frame 50 --warmup 20 --view shadow:2
  shadowcull render kitchen.aff -o wrong.png --frame 50 --warmup 20 --view difference
  shadowcull render kitchen.aff -o cells.png --frame 50 --warmup 20 --method certified --view certificate:0
  shadowcull render kitchen.aff --frame 50 --warmup 20 --figure1 kitchen.svg
  shadowcull render Robot.aff --frame 10 --warmup 10 --buffers robot.npz
  shadowcull render Robot.aff -o robot.exr --frame 10 --warmup 10 --verify
  shadowcull render saved.png --samples 16 --size 1920x1080
  shadowcull render kitchen.aff -o same.png --camera saved.png
  shadowcull render bunny.ply -o bunny.png --camera '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'

Modes are set and certificates made from frame to frame, so culling acts only after some frames: --warmup N first
traces the N frames before the one that is rendered.

A picture saved by the window or by render carries its scene, camera, time, settings and view. Given instead of
SCENE, it is rendered again, and options replace what it carries. Without -o the result is NAME-rendered.png.

The .npz holds color (H,W,3 float32), depth (H,W float32, distance along the unit ray, inf for a miss),
primitive and cell (H,W int32, -1 for a miss), occlusion_mode (H,W uint8, 255 for a miss), shadow_mode
(H,W,lights uint8), and for each light and primary hit lit and due (H,W,lights bool); with --verify also
reference (H,W,3 float32), the colour with every shadow answer right, and wrong (H,W int32), the number of
wrong shadow answers of each pixel. A frame of the method certified has certificate (H,W,lights uint8: 0 none,
1 in full shadow, 2 lit, 3 a few candidates), and the views saved and cost have arrays of their names (H,W int32).

An .exr needs OpenEXR (install shadowcull[exr]). It holds the linear colours and the same buffers as channels, those of
each light as lit.0, lit.1 and so on for up to 32 lights, and the scene, camera, settings and statistics as JSON in the
attribute shadowcull.

--view difference and --view wipe verify by themselves: the first shows the pixels with wrong shadow answers,
the second the traced picture left of a line, and the correct one right of it; wipe:0.3 puts the line at 30 % of
the width. Rings show where wrong pixels are, unless --no-marks is given. --view saved and --view cost are maps of
the shadow rays that culling saves at each pixel, and of all rays that are traced for it.
"""

FILM = """\
examples:
  shadowcull film kitchen.aff -o kitchen --size 1280x720 --samples 4
  shadowcull film kitchen.aff -o kitchen.mp4 --frames 100-300 --method certified --size 1920x1080
  shadowcull film default -o modes.mp4 --frames 0-49 --view occlusion --legend
  shadowcull film kitchen.aff -o flight.mp4 --through door.png table.png window.png --seconds 10
  shadowcull film kitchen.aff -o flight --bookmarks --fps 30

Every frame is traced whole, and is a picture that says how it was made: `shadowcull check` tells whether it is still
true. Modes are learnt from frame to frame. A flight moves evenly: each frame goes on as far as the others, where
turning counts as well, and time goes on from picture to picture. The video needs PyAV: install shadowcull[video].
An odd width or height of the video is made even by its last row or column once more. Ctrl-C keeps what is done, and
the exit code is then 130.
"""

FIGURE = """\
examples:
  shadowcull figure default -o methods.pdf --frame 50 --warmup 20 --size 640x480
  shadowcull figure kitchen.aff -o paper.png --frame 100 --warmup 20 --crops '40,60,80,60;200,90,80,60'
  shadowcull figure kitchen.aff -o cost.pdf --frame 100 --warmup 20 --view cost --methods none,certified,certified+cache

Each method has a column, with modes of its own: the picture with the crops marked in it, each crop enlarged without
smoothing, how far it is from the picture of none, all in one range of colours, and the counters. Maps of work have
one range of colours as well. The counters are those of the kd-tree, ray by ray, unless --accelerator says otherwise;
the work that goes into certificates is among them. The figure carries how it was made, and `shadowcull check` draws
it again.
"""

CHECK = """\
examples:
  shadowcull check figure.png
  shadowcull check paper/*.png paper/methods.pdf

A picture carries its scene, camera, time, settings, view and the frames that its modes came from. It is true if it
is the same again, bit for bit; a view that a GPU has drawn may be off by rounding. Otherwise the line says how many
pixels differ, and what has changed since: a part of the scene, the version, or the file itself. Files that are missing,
or none of these kinds, are errors. The exit code is 0 only if all are true.
"""

BENCH = """\
examples:
  shadowcull bench kitchen.aff --path-frames 100
  shadowcull bench Robot.aff --frames 100:200 --size 256x256 --verify
  shadowcull bench kitchen.aff --path-frames 100 --methods paper,cells,certified,certified+cache
  shadowcull bench kitchen.aff --path-frames 100 --lamp-radius 0.03,0.1 --lamp-samples 16,64 --accelerator bvh8
  shadowcull bench default --methods none,paper --symmetric --json default.json --csv default.csv
  shadowcull bench kitchen.aff --path-frames 100 --verify --plot kitchen.svg

Savings compare the work of shadow rays with that of the method none, averaged over frames, as in the
paper's Table 1. Ctrl-C ends the run and keeps the finished frames: the table and the files cover these,
and the exit code is 130; a second Ctrl-C ends it at once.

The JSON holds scene, size, frames, and for each method and figure a list with one entry per frame; the
CSV is the table. The plot shows the savings of each frame, their average and maximum, and with --verify
the wrong answers.

Several values of --lamp-radius or --lamp-samples make another table: for each radius, number of samples and method
the time of a frame, its shadow rays, the speed-up over none, and how much that is of the speed-up of free, for which
shadow rays cost nothing. The JSON then has the figures of all lamps under "lamps", and those of the first where a
single one has its own.
"""

ZOOM = """\
examples:
  shadowcull zoom figure4 --primitive 0 --size 128x128 --factors 4,64 --plot figure4.png
  shadowcull zoom kitchen.aff --frame 100 --primitive 15548 --size 256x256 --ratio 0.9 --factors 4,64
  shadowcull zoom figure4 --pixel 64,64 --size 128x128 --json zoom.json --csv zoom.csv

A primitive that was fully rendered from afar is culled by what its few pixels met then, until it covers more
pixels than the zoom factor times its highest pixel count; then it is examined again. The camera starts where
it is at that time and moves straight towards the primitive: along its view if that meets the primitive, else
turned to the middle of the visible part. The first frames stay in place until the modes settle. Every culled
shadow ray is verified, and a pixel with a wrong answer is a wrong pixel. Ctrl-C ends the test and keeps the
finished frames; the exit code is then 130.

The tables show the steps where something changes, and a summary of each factor; the JSON and the CSV hold every
step, and the plot draws them. In these, wrong_of_primitive counts the wrong pixels of this primitive, wrong those
of the whole picture. A primitive that is never fully rendered is never culled, so nothing is tested.
"""

CUBE = """\
examples:
  shadowcull cube default --light 1 -o cube.png
  shadowcull cube kitchen.aff --side 512 --accelerator kdtree

Left, cells with nothing in them are white, and those that one triangle covers blue; those with a list of candidates go
from violet, for one, to yellow, for the longest list there is, and those with more than eight are grey. Right is the
distance at which full shadow begins. The legends have the numbers.
"""

EXPLAIN = """\
examples:
  shadowcull explain default --pixel 200,300
  shadowcull explain kitchen.aff --frame 50 --warmup 10 --pixel 256,400 --only wrong
  shadowcull explain default --pixel 200,300 --method certified
  shadowcull explain default --pixel 200,300 --accelerator kdtree --json

The tree has the pixel's primary, reflected and refracted rays, and below each the shadow rays from where it ends.
Each shadow ray was not asked, as the surface faces away from its light; culled, by a mode of the paper, a certificate
or a cached occluder; passed over, as its light is hidden from the region; or traced, with so many traversal steps and
intersection tests, counted for the ray alone. It says what blocks a ray first, seen from the light; a culled answer
that is not true is said to be wrong. Where a point has more than 12 lights, those with the same fate have one line.

Modes are set and certificates made from frame to frame, so culling acts only after some frames: --warmup N first
traces the N frames before the one that is explained, and --repeat N that frame itself N times.
"""

HUNT = """\
examples:
  shadowcull hunt kitchen.aff --frames 0-99 --size 256x256 --output wrong
  shadowcull hunt kitchen.aff --method paper --step 10 --around 100 --radius 0.5 --seed 7
  shadowcull hunt default --method certified --around 50
  shadowcull check wrong/*.png
  shadowcull explain kitchen.aff --frame 12 --pixel 147,125 --before '[[0, null]]' --only wrong

The frames are traced one after another, as in bench, so that the method learns from each; every culled shadow ray is
verified. Wrong pixels are ranked by how far their colour is from the right one, and of each primitive and light the
worst is kept. Of the frames before it, the fewest are then looked for that make the pixel just as wrong: often the one
that taught the mode. --around N traces N more pictures near the worst finds, after these frames; --radius says how far
from the camera of a find, in parts of its distance to what is wrong there, and --seed draws other ones.

--output writes for each find a figure that shows it beside the right picture, which `shadowcull check` can draw again,
a JSON with all about it, whose frames before it --before of render, figure and explain takes, and hunt.json with all.
For an exact method nothing is found, and the table says how many pixels were compared. Ctrl-C ends the hunt and keeps
what was found; the exit code is then 130.
"""

INFO = """\
examples:
  shadowcull info kitchen.aff
  shadowcull info default --json
"""


def methods() -> str:
    """A line for each method, as the registry describes it."""
    from tracer.method import additions, bases

    lines = [(kind.name, kind.summary) for kind in bases(measures=True)]
    lines += [(f"+{kind.name}", kind.summary) for kind in additions(measures=True)]
    width = max(len(name) for name, _ in lines)
    return "\nmethods:\n" + "".join(f"  {name:{width}}  {summary}\n" for name, summary in lines)
