"""How good pictures are while the camera moves, and how soon they are whole after it.

    make motion                                      the default scene, and BART's Kitchen where it is there
    make motion ARGS="--json motion.json robot.aff"  other scenes

Each scene is opened in a window of its own, once as it is, once with the resolution divided until whole frames come in
time, which is the baseline; both aim at the same time for a frame.  The path is played and the camera led
by hand, in turn.  What was shown is held against the exact picture of its moment by structural similarity
(SSIM: Wang et al. 2004) and by PSNR, and what the method `paper` saves against what it saves in whole
frames of the same moments.  A picture is settled when all of its pixels are exact; that is told as a
multiple of what a whole frame takes at that place, in the same window.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tests.bench.frame_times import KITCHEN, in_words, machine
from tests.bench.motion_server import WAYS
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.resources import scene_path
from viewer.util.screen import has_display, no_display_reason

ROOT = Path(__file__).resolve().parents[2]
GOALS = (
    "goals: SSIM 0.92 or better at 15 frames a second, settled after 1.15 full frames; of what whole frames save, "
    "70 %, and at most twice their wrong answers"
)
SHARES = ("saved", "saved_verified", "saved_whole", "wrong", "wrong_whole")


def measure(scene: Path, size: str, way: str, bursts: int) -> dict[str, Any]:
    """What a window showed and how good it was, or RuntimeError in one line where it fails."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "motion.json"
        environment = os.environ | {"SHADOWCULL_CONFIG_DIR": folder}
        command = [sys.executable, "-m", "tests.bench.motion_server", str(scene.absolute()), size, way, str(bursts)]
        done = subprocess.run(
            [*command, str(out)], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=1200
        )
        if done.returncode or not out.exists():
            raise RuntimeError(f"{scene.name}: {(done.stderr.strip().splitlines() or ['the window failed'])[-1]}")
        return json.loads(out.read_text())


def summary(result: dict[str, Any]) -> dict[str, float]:
    """A window's bursts of motion in a few figures."""
    bursts = result["bursts"]
    pictures = [one for burst in bursts for one in burst["compared"]]
    ssim, psnr = (np.array([one[name] for one in pictures]) for name in ("ssim", "psnr"))
    window = np.array([seconds for burst in bursts for seconds in burst["window"]])
    settled = np.array([[burst["settled"], burst["full"]] for burst in bursts])
    shares = {name: float(np.mean([burst[name] for burst in bursts])) for name in SHARES}
    return {
        "ssim_median": float(np.median(ssim)),
        "ssim_p5": float(np.percentile(ssim, 5)),
        "psnr_median": float(np.median(psnr)),
        "psnr_p5": float(np.percentile(psnr, 5)),
        "frames_per_second": sum(b["pictures"] for b in bursts) / sum(b["seconds"] for b in bursts),
        "part_median": float(np.median([one["part"] for one in pictures])),
        "divisor_median": float(np.median([one["divisor"] for one in pictures])),
        "window_ms_median": float(1e3 * np.median(window)),
        "window_ms_p99": float(1e3 * np.percentile(window, 99)),
        "settled_ms": float(1e3 * np.median(settled[:, 0])),
        "full_ms": float(1e3 * np.median(settled[:, 1])),
        "settle": float(np.median(settled[:, 0] / settled[:, 1])),
        **shares,
    }


def _table(scene: str, size: list[int], ways: dict[str, dict[str, float]]) -> Table:
    title = f"{scene}, {size[0]} × {size[1]} pixels, in motion"
    made = Table(title=title, title_justify="left", title_style="bold", caption=GOALS, caption_justify="left")
    made.add_column("")
    for heading in ("SSIM (5 %)", "PSNR, dB (5 %)", "frames / s", "shaded", "1/n size", "window, ms (99 %)",
                    "settled, ms", "full frames", "saved (of whole)", "wrong (whole)"):  # fmt: skip
        made.add_column(heading, justify="right")
    for name, s in ways.items():
        made.add_row(
            {"parts": "in parts", "coarse": "coarser (baseline)"}[name],
            f"{s['ssim_median']:.3f} ({s['ssim_p5']:.3f})",
            f"{s['psnr_median']:.1f} ({s['psnr_p5']:.1f})",
            f"{s['frames_per_second']:.1f}",
            f"{s['part_median']:.0%}",
            f"{s['divisor_median']:.1f}",
            f"{s['window_ms_median']:.0f} ({s['window_ms_p99']:.0f})",
            f"{s['settled_ms']:.0f}",
            f"{s['settle']:.2f}",
            f"{s['saved']:.1%} ({s['saved'] / max(s['saved_whole'], 1e-9):.0%})",
            f"{s['wrong']:.3%} ({s['wrong_whole']:.3%})",
        )
    return made


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make motion", description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: the default scene, and Kitchen if there")
    parser.add_argument("--bursts", type=int, default=8, help="of two seconds of motion in each window (default: 8)")
    parser.add_argument("--size", default="1280x800", help="of the window (default: 1280x800)")
    parser.add_argument("--json", type=Path, default=Path("out/motion.json"), help="(default: out/motion.json)")
    options = parser.parse_args(arguments)
    if not has_display():
        say(f"no window can be moved: {no_display_reason()}")
        return 1
    scenes = [scene_path(name) for name in options.scenes] or [scene_path(None), *([KITCHEN] * KITCHEN.exists())]
    report: dict[str, Any] = {"machine": machine(), "window": options.size, "scenes": {}}
    try:
        for scene in scenes:
            results = {way: measure(scene, options.size, way, options.bursts) for way in WAYS}
            ways = {way: summary(result) for way, result in results.items()}
            names = ("ssim_median", "ssim_p5", "frames_per_second", "settle", *SHARES)
            about = {name: ways["parts"][name] for name in names}
            about |= {f"baseline_{name}": ways["coarse"][name] for name in names}
            report["scenes"][scene.stem] = about | {"ways": ways, "bursts": results}
            print_table(_table(scene.name, results["parts"]["size"], ways))
    except RuntimeError as error:
        say(error)
        return 1
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(report, indent=1) + "\n")
    print(f"{in_words(report['machine'])}; all in {options.json}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
