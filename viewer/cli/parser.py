"""How command lines are read, and what is said of wrong ones: one line, which asks what may have been meant."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from tracer.similar import did_you_mean, similar
from viewer.cli.mesh_arguments import joined
from viewer.util.messages import ERROR, say

MISUSED = 2
"""Exit code where a command line is wrong."""


class Parser(argparse.ArgumentParser):
    """Options by their whole names; errors in one line, which names where help is."""

    _unknown: Sequence[str] = ()
    """Words of the last command line that are no arguments, about which there is an error."""

    def __init__(self, prog: str, description: str, epilog: str) -> None:
        super().__init__(
            prog=prog,
            description=description,
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )

    def parse_known_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> Any:  # type: ignore[override]
        self._unknown = ()
        options, self._unknown = super().parse_known_args(joined(sys.argv[1:] if args is None else args), namespace)
        return options, self._unknown

    def _meant(self) -> str:
        """A question about the first unknown word that is like an option; its dashes, which all have, do not count."""
        told = [name for name, what in self._option_string_actions.items() if what.help is not argparse.SUPPRESS]
        known = [name[2:] for name in told if name.startswith("--")]
        words = (word[2:].partition("=")[0] for word in self._unknown if word.startswith("--"))
        found = next(filter(None, (similar(word, known, 0.7) for word in words)), "")
        return f": did you mean '--{found}'?" if found else ""

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError:
            hint = did_you_mean(str(value), map(str, action.choices or ()))
            if not hint:
                raise
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}{hint}") from None

    def error(self, message: str) -> NoReturn:
        say(f"{message}{self._meant()} (see '{self.prog} --help')", ERROR)
        sys.exit(MISUSED)
