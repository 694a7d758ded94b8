"""Marks of tests that need what not every system has."""

from __future__ import annotations

import os
import sys

import pytest

posix_only = pytest.mark.skipif(os.name != "posix", reason="only POSIX has pipes and devices among its files")
linux_only = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux has /proc")
permissions = pytest.mark.skipif(
    os.name != "posix" or os.geteuid() == 0, reason="nothing is unreadable for root, nor by permissions on Windows"
)
