"""Kills, full disks and several windows, for a short while: `make faults` goes on for longer."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.fuzz import faults
from tests.fuzz.kills import Written
from tests.fuzz.written import WRITTEN
from tests.platforms import linux_only
from tests.sweeps import cases

QUICK = ("settings, bookmarks, presets", "captures", "pictures as JPEG", "tables as CSV")

pytestmark = linux_only


@pytest.mark.parametrize(
    "written", [what for what in WRITTEN if what.name in cases(QUICK, [w.name for w in WRITTEN])], ids=lambda w: w.name
)
def test_a_kill_leaves_the_old_file_or_the_new_one_and_nothing_else(written: Written):
    line = faults.kills(written, cases(8, 50), np.random.default_rng(1))
    assert not line.failed, line.first


def test_a_file_that_is_not_written_whole_is_found_out(tmp_path):
    def write(folder, number):
        with (folder / "a.txt").open("w") as file:
            for _ in range(100):
                file.write("line\n")
                file.flush()

    def check(folder):
        assert (folder / "a.txt").read_text().count("line\n") == 100

    assert faults.kills(Written("half", write, check), 8, np.random.default_rng(1)).failed


def test_windows_that_save_at_once_lose_nothing():
    line = faults.bookmarks_at_once(3, 8)
    assert not line.failed, line.first


@pytest.mark.parametrize("attack", [faults.full_disk, faults.read_only])
def test_a_disk_that_takes_nothing_is_one_line(attack):
    for written in WRITTEN:
        if written.name in (*QUICK, "OpenEXR, small"):
            more = (np.random.default_rng(2), 2) if attack is faults.full_disk else ()
            try:
                line = attack(written, *more)
            except faults.NotAllowed:
                pytest.skip("only root may mount a file system, and not everywhere")
            assert not line.failed, f"{line.what}: {line.first}"


@pytest.mark.parametrize("option", cases(["--help"], ["--version", "--help"]))
def test_a_full_disk_is_said_of_help_too(option: str) -> None:
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "viewer", option]
        done = subprocess.run(command, cwd=Path(__file__).parents[2], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "No space left" in done.stderr
