"""Settings that are declared once, where their value lives: as a field of a frozen dataclass.

    outlines: bool = setting(False, "Outlines", "Draw the borders between primitives.", option="--outlines")

Everything else that there is of a setting is made from this line: its row in a panel, its entry in the command palette,
its option on the command line, its place in saved files, the words of undo, and its row in the documentation.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from enum import Enum
from functools import cache
from numbers import Integral, Real
from types import NoneType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from tracer.util.suggest import did_you_mean

_KEY = "setting"
_ON, _OFF = ("on", "yes", "true", "1"), ("off", "no", "false", "0")
T = TypeVar("T")
AS_DEFAULT = "as the default"
ALWAYS, PICTURES, NEVER = "always", "pictures", "never"
"""Which saved states hold a setting."""


def always(holder: Any) -> bool:
    """Return that a setting applies whatever the others are."""
    return True


def anything(value: Any) -> None:
    """Accept every value."""


@dataclass(frozen=True)
class Setting:
    """The declaration of one setting.

    Parameters
    ----------
    label, help : str
        What it is called, and what it does in a sentence.
    low, high : float
        The range of a number, both ends included; without `high` it has no end.
    slider : tuple of float, or None
        The part of a wide range that a slider covers; more can be typed.
    choices : mapping
        Each value that can be chosen, with what it means.
    unit : str
        Behind the number, as " fps". With `percent` the number is shown as per cent of 1.
    log : bool
        Whether a slider is logarithmic.
    digits : int
        Behind the point, on a slider.
    unset : str
        The word for None, where that is allowed.
    called : function of the value
        What people read of it, where that is not the value itself.
    option : str
        The option of the command line. Of a switch it changes the default: "--no-marks" switches off.
    panel : str
        The panel in which it has a row.
    applies : function
        Whether it does anything, as the other settings are: of the holder here, of the whole state in the viewer.
    check : function of the value
        What else is asked of it: raises ValueError.
    stored : str
        Which states hold it: `ALWAYS`, `NEVER`, or `PICTURES`: those of saved pictures alone, as it is the machine's.
    remembered : bool
        Whether the window starts with it next time.
    in_window : object
        The default in the window where that is another.
    name, kind, default, optional, within
        Of the field: found by `settings_of`. `within` names the fields on the way to it from the holder.
    """

    label: str
    help: str
    low: float = -math.inf
    high: float = math.inf
    slider: tuple[float, float] | None = None
    choices: Mapping[Any, str] = field(default_factory=dict, hash=False)
    unit: str = ""
    percent: bool = False
    log: bool = False
    digits: int = 2
    unset: str = ""
    called: Callable[[Any], str] | None = None
    option: str = ""
    panel: str = ""
    applies: Callable[[Any], bool] = always
    check: Callable[[Any], None] = anything
    stored: str = ALWAYS
    remembered: bool = True
    in_window: Any = AS_DEFAULT
    name: str = ""
    kind: type = bool
    default: Any = None
    optional: bool = False
    within: tuple[str, ...] = ()

    @property
    def path(self) -> str:
        """Its name with those of the fields on the way to it, as "tone.exposure"."""
        return ".".join((*self.within, self.name))

    def get(self, holder: Any) -> Any:
        """Return its value in a holder."""
        for name in (*self.within, self.name):
            holder = getattr(holder, name)
        return holder

    def put(self, holder: T, value: Any) -> T:
        """Return the holder with another value of it."""
        return _put(holder, (*self.within, self.name), value)

    # --- what values it takes --------------------------------------------------------------------

    @property
    def expected(self) -> str:
        """Which values it takes, in words."""
        return self._expected(1.0)

    @property
    def expected_shown(self) -> str:
        """The same in the unit in which it is shown."""
        return self._expected(100.0 if self.percent else 1.0) + (" %" if self.percent else "")

    def _expected(self, scale: float) -> str:
        also = f', or "{self.unset}"' if self.optional and self.unset else ""
        if self.kind is bool:
            return "on or off"
        if self.choices:
            return f"one of {', '.join(str(choice) for choice in self.choices)}{also}"
        if self.kind not in (int, float):
            return ("text" if self.kind is str else self.kind.__name__) + also
        number = "a whole number" if self.kind is int else "a number"
        if math.isinf(self.high):
            return f"{number} from {scale * self.low:g} up{also}" if math.isfinite(self.low) else number + also
        return f"{number} from {scale * self.low:g} to {scale * self.high:g}{also}"

    def problem(self, value: Any) -> str:
        """Return what is wrong with a value, in one line; empty where nothing is."""
        if value is None and self.optional:
            return ""
        if not self._takes(value):
            said = value if not isinstance(value, int) or abs(value) < 1 << 64 else "so large a number"
            return f"{self.name} is {self.expected}, not {said}"
        try:
            self.check(value)
        except ValueError as error:
            return str(error)
        return ""

    def _takes(self, value: Any) -> bool:
        if self.choices:
            return value in self.choices
        if self.kind in (int, float):
            number = isinstance(value, Real if self.kind is float else Integral) and not isinstance(value, bool)
            finite = number and (isinstance(value, Integral) or math.isfinite(value) or self._endless)
            return finite and self.low <= value <= self.high
        return isinstance(value, self.kind)

    @property
    def _endless(self) -> bool:
        """Whether it takes an infinite number, as its default is one."""
        return self.kind is float and self.default == math.inf

    def clamped(self, value: float) -> float:
        """Return the number of its range that is nearest."""
        return min(max(value, self.low), self.high)

    def parse(self, word: str, shown: bool = False) -> Any:
        """Return the value that somebody has typed, in the unit in which it is `shown` or as it is; raises ValueError,
        in one line."""
        typed = word.strip()
        if self.optional and self.unset and typed.lower() == self.unset:
            return None
        value: Any = None
        if self.kind is bool:
            value = True if typed.lower() in _ON else False if typed.lower() in _OFF else None
        elif self.choices:
            value = next((choice for choice in self.choices if str(choice).lower() == typed.lower()), None)
        elif self.kind in (int, float):
            number = typed.removesuffix("%").removesuffix(self.unit.strip()).strip() if shown else typed
            try:
                value = self.kind(number)
            except ValueError:
                value = None
            value = value / 100.0 if value is not None and shown and self.percent else value
        else:
            value = self.kind.parse(typed) if hasattr(self.kind, "parse") else typed
        if value is None:
            expected = self.expected_shown if shown else self.expected
            raise ValueError(f"{word or 'nothing'} is not {expected}{did_you_mean(typed, map(str, self.choices))}")
        if self.problem(value):
            expected = self.expected_shown if shown else self.expected
            raise ValueError(f"{typed} is not {expected}" if self.check is anything else self.problem(value))
        return value

    # --- in words --------------------------------------------------------------------------------

    def text(self, value: Any) -> str:
        """Return a value as panels and the palette show it."""
        if value is None:
            return self.unset or "none"
        if isinstance(value, bool):
            return "on" if value else "off"
        if self.percent:
            return f"{100.0 * value:.6g} %"
        if self.kind in (int, float):
            sign = "+" if -math.inf < self.low < 0 and value else ""
            return f"{value:{sign}.6g}{self.unit}"
        if type(value) is tuple:
            return "changed"
        if self.called is not None:
            return self.called(value)
        return value.in_words() if hasattr(value, "in_words") else str(getattr(value, "label", value))

    def in_words(self, value: Any) -> str:
        """Return what it is now, as undo says it: "outlines on"."""
        called = self.label if self.label[1:2].isupper() else self.label[:1].lower() + self.label[1:]
        return f"{called} of the {self.unset}" if value is None and self.unset else f"{called} {self.text(value)}"

    def words(self, value: Any) -> list[str]:
        """Return the words of a command line that give it this value: none for its default."""
        if not self.option or value == self.default or value is None:
            return []
        if self.kind is bool:
            return [self.option]
        word = str(value.value) if isinstance(value, Enum) else str(value)
        return [f"{self.option}={word}"] if word.startswith("-") else [self.option, word]


def setting(default: Any, label: str, help: str, **more: Any) -> Any:
    """Declare a setting as a field of a dataclass; `more` are fields of `Setting`, where `choices` may be a list."""
    choices = more.pop("choices", {})
    if not isinstance(choices, Mapping):
        choices = {choice: getattr(choice, "meaning", "") for choice in choices}
    return field(default=default, metadata={_KEY: Setting(label, help, choices=choices, **more)})


@cache
def settings_of(holder: type) -> tuple[Setting, ...]:
    """List the settings of a dataclass, and of the dataclasses that are fields of it, in the order of their fields."""
    hints = get_type_hints(holder)
    found: list[Setting] = []
    for item in fields(holder):
        kind, optional = _kind_of(hints[item.name])
        if declared := item.metadata.get(_KEY):
            default = item.default
            choices = declared.choices
            if issubclass(kind, Enum) and not choices:
                choices = {choice: getattr(choice, "meaning", "") for choice in kind}
            found.append(
                replace(declared, name=item.name, kind=kind, default=default, optional=optional, choices=choices)
            )
        elif is_dataclass(kind):
            found += [replace(inner, within=(item.name, *inner.within)) for inner in settings_of(kind)]
    return tuple(found)


def setting_of(holder: type, path: str) -> Setting:
    """Return one setting by its path."""
    return next(found for found in settings_of(holder) if found.path == path)


def check_all(holder: T) -> T:
    """Return a holder whose values are right; raises ValueError, in one line, for the first that is not."""
    kind: type = type(holder)
    for one in settings_of(kind):
        if problem := one.problem(one.get(holder)):
            raise ValueError(problem)
    return holder


def documented(holder: type[T]) -> type[T]:
    """Append the parameters of a dataclass of settings to its docstring."""
    kind: type = holder
    lines = [holder.__doc__ or "", "\n\nParameters\n----------\n"]
    for one in settings_of(kind):
        optional = " or None" if one.optional else ""
        lines.append(f"{one.name} : {one.kind.__name__}{optional}\n    {one.help}\n")
    holder.__doc__ = "".join(lines)
    return holder


def _kind_of(hint: Any) -> tuple[type, bool]:
    """The type of a field without None, and whether None is allowed."""
    kinds = [kind for kind in get_args(hint) if kind is not NoneType] if NoneType in get_args(hint) else [hint]
    return get_origin(kinds[0]) or kinds[0], len(kinds) < len(get_args(hint))


def _put(holder: Any, names: tuple[str, ...], value: Any) -> Any:
    name, *others = names
    inner = _put(getattr(holder, name), tuple(others), value) if others else value
    return replace(holder, **{name: inner})


_KINDS = {
    "int": "a whole number", "float": "a number", "str": "text", "bool": "true or false", "array": "a list",
    "object": "a table",
}  # fmt: skip


def kinds_in_words(kinds: re.Match[str]) -> str:
    """Return the types that msgspec names, such as "int | null", in plain words."""
    return " or ".join(_KINDS.get(kind, kind) for kind in kinds[1].split(" | ") if kind != "null")
