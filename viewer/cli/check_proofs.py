"""The command `check-proofs`: hold proofs against exact arithmetic."""

from __future__ import annotations

import json
from argparse import Namespace
from collections import Counter
from pathlib import Path

from tracer.util.text import printable
from viewer.cli.arguments import FAILED, Parser, count
from viewer.cli.console import working
from viewer.output.proof_checker import Checker
from viewer.util.numbers import several

SHOWN = 10  # of the proofs that do not hold
EPILOG = """\
examples:
  shadowcull check-proofs proofs.json
  shadowcull check-proofs proofs.json --most 500

The exit code is 0 only if all checked proofs hold. The checker shares no code with the tracer, and decides by integers.
It can check proofs of other programs, too: docs/proofs.md describes the file.
"""


def parser() -> Parser:
    parser = Parser("check-proofs", "Check proofs of visibility in exact arithmetic.", EPILOG)
    parser.add_argument("proofs", type=Path, metavar="FILE", help="proofs, as `shadowcull prove` writes them")
    parser.add_argument("--most", type=count(1, 2**31 - 1), metavar="N", help="check so many of them (default: all)")
    return parser


def run(given: Namespace) -> int:
    """Check; raises ValueError and OSError, each in one line, or Cancelled."""
    try:
        data = json.loads(given.proofs.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):  # of bytes that are no text, too
        raise ValueError(f"{given.proofs}: this is not JSON") from None
    try:
        checker = Checker(data)
    except ValueError as error:
        raise ValueError(f"{given.proofs}: {error}") from None
    total = len(checker.proofs)
    most = min(given.most or total, total)
    held, failed = Counter[str](), []
    with working() as work:
        for done in range(most):
            work.count("checking", done, most)
            if work.cancelled():
                most = done
                break
            number = done * total // most
            cell, light, verdict, _ = proof = checker.proofs[number]
            answer = checker.check(proof)
            if answer.holds:
                held[verdict] += 1
            else:
                named = printable(f"cell {cell}, light {light}, {verdict}")
                failed.append(f"proof {number} ({named[:60]}): {answer.why}")
    for line in failed[:SHOWN]:
        print(line)
    if len(failed) > SHOWN:
        print(f"and {len(failed) - SHOWN:,} more")
    print(f"{several(most, 'proof')} checked of {total:,}: {held['full']:,} hidden and {held['lit']:,} lit hold, "
          f"{len(failed):,} do not")  # fmt: skip
    return FAILED if failed else 0
