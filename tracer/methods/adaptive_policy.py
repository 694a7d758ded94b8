"""Whether certificates pay, by what they are seen to cost and to save: what the method `auto` goes by.

A frame is traced as `none` traces it until look-ups are seen to pay, and from then on as `certified` does, as long as
they do.  What is done to find out is paid from a purse, in seconds:

- Each frame puts a small share of its time into it, and while look-ups pay a part of what they have saved as well.
- Certifying takes from it what it took, and so does setting certificates up and keeping them up to date.
- Now and then a *trial*: a tile of the picture is shaded both ways, one after the other, for the same pixels.  Both
  times are those of the processor, so that others at work on the machine hardly matter.  What one of the two took
  more than the picture needed is paid for.

The purse holds no more than a part of a frame, and nothing is bought that it cannot pay.  So over any fifty frames
`auto` takes hardly longer than `none`: the share, and what a wrong decision costs until trials tell.  Decisions depend
on times, pictures never: both ways give the same, bit for bit.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

SHARE, LEAST_SHARE = 0.01, 0.005  # of each frame's time goes into the purse, at first, and after long without return
FADING = 0.995  # of what is above the least share is left from one frame without return to the next
RETURNED = 0.5  # of what look-ups save goes into the purse
ROOM, SAVED = 0.6, 0.9  # frames' time that the purse holds at most, and until certificates have been set up
TRIAL_SHARE = 0.2  # of what is earned goes into trials
FEW, LATELY, MANY = 6, 10, 40  # trials that a decision needs, that tell of a change, and that are kept
OLD = 80  # frames after which a trial is forgotten
ON, OFF = 0.01, 0.0  # part of the shading time that look-ups must surely save to be made, and may save to go on
SURE = 3.0  # standard errors: as good as surely, though it is asked in every frame
KNOWN = 0.6  # of the rays due: where so many are known and look-ups do not pay, more certificates would not help
PAUSE = 200  # frames for which nothing is certified then
SMALLEST = 2e-3  # seconds: less is not worth the search for what to certify
RECENT = 0.8  # of the memory of how long a frame takes is kept from one to the next
TRIED_FIRST = 0.15  # of a frame's time may go into trials where look-ups are made before any trial
AT_ONCE, FEW_TILES = 2, 16  # trials in a frame, at most, and of a picture with fewer tiles not in each
IDLE_TRIALS = 8  # tiles, in a frame that nobody waits for


@dataclass(frozen=True)
class Plan:
    """What a frame does about certificates: look them up, make some for so many seconds, and try so many tiles."""

    looks_up: bool = False
    seconds: float = 0.0
    trials: int = 0

    @property
    def needs_certificates(self) -> bool:
        return self.looks_up or self.seconds > 0.0 or self.trials > 0


@dataclass(frozen=True)
class Trial:
    """A tile shaded both ways: seconds without certificates (`plain`) and with (`certified`), shadow rays due, and how
    many of these were known."""

    plain: float
    certified: float
    due: int
    known: int


class AdaptivePolicy:
    """Decides for one renderer.  `price` is about what setting certificates up takes, in seconds; where rays are
    `dear`, certificates pay as a rule, and are made and looked up from the second frame on."""

    def __init__(self, price: float, dear: bool) -> None:
        self._price, self._dear = price, dear
        self._purse = 0.0
        self._typical = 0.0  # seconds of a frame, without what was spent in it
        self._share = SHARE
        self._trials: deque[tuple[int, Trial]] = deque(maxlen=MANY)
        self._frame = 0
        self._for_trials = 0.0
        self._spent = 0.0  # in this frame
        self._paused_until = 0
        self._ready = False
        self.looks_up = False

    def plan(self, tiles: int, patience: float = 0.0) -> Plan:
        """What the next frame, of so many tiles, does.  It may take `patience` seconds for certificates that cost
        nothing, as nobody waits for it."""
        paused = self._frame < self._paused_until
        if patience > 0.0:
            return Plan(self.looks_up, 0.0 if paused else patience, min(tiles, IDLE_TRIALS))
        saved, doubt = self.saving
        # Whether looking up is right must be known soon, but small pictures of few tiles cannot try one in each frame.
        unknown = self.looks_up and saved <= doubt and len(self._trials) < MANY
        urgent = min(tiles, AT_ONCE) if unknown and self._frame % max(1, FEW_TILES // max(1, tiles)) == 0 else 0
        if not self._frame or self._purse < (0.0 if self._ready else self._price):
            return Plan(self.looks_up, trials=urgent)
        left = self._purse if self._ready else self._purse - self._price
        trial = self._typical / max(1, tiles)
        trials = int(min(self._for_trials, left) / trial) if self._ready and trial > 0.0 else 0
        trials = max(urgent, min(trials, AT_ONCE))
        left -= trials * trial
        worthwhile = left >= max(SMALLEST, 0.02 * self._typical) or not self._ready
        seconds = max(left, SMALLEST) if worthwhile and not paused else 0.0
        return Plan(self.looks_up or (self._dear and not self._ready), seconds, trials)

    def spend(self, seconds: float, trying: bool = False) -> None:
        """So many seconds went into certificates, or into trials."""
        self._purse -= seconds
        self._spent += seconds
        if trying:
            self._for_trials -= seconds

    def made_ready(self) -> None:
        """Certificates have been set up."""
        self._ready = True
        self.looks_up = self.looks_up or self._dear

    def abandon(self, free: bool = False) -> None:
        """A frame was left before anything of it was shaded; `free` if nobody waited."""
        if free:
            self._purse += self._spent
        self._spent = 0.0

    def finish(self, seconds: float, shading: float, trials: list[Trial], free: bool = False) -> None:
        """A frame took so long, of which `shading` was spent on what the picture shows; `free` if nobody waited."""
        self._frame += 1
        useful = max(0.0, seconds - self._spent)
        if free:
            self._purse += self._spent  # paid by nobody
        first = self._typical == 0.0
        self._typical = useful if first else RECENT * self._typical + (1.0 - RECENT) * useful
        income = self._share * useful
        if first and self._dear:
            income, self._for_trials, self._share = SAVED * useful, TRIED_FIRST * useful, LEAST_SHARE
        self._trials.extend((self._frame, trial) for trial in trials if trial.plain > 0.0)
        while self._trials and self._trials[0][0] < self._frame - OLD:
            self._trials.popleft()
        saved, doubt = self.saving
        if self.looks_up and saved > 0.0 and not math.isinf(doubt):
            income += RETURNED * shading * saved / (1.0 - saved)
            self._share = SHARE
        else:
            self._share = LEAST_SHARE + FADING * (self._share - LEAST_SHARE)
        self._purse = min(self._purse + income, (ROOM if self._ready else SAVED) * self._typical)
        self._for_trials = min(self._for_trials + TRIAL_SHARE * income, TRIED_FIRST * self._typical)
        self._spent = 0.0
        self._decide(saved, doubt)

    @property
    def saving(self) -> tuple[float, float]:
        """The part of the shading time that look-ups save, by the trials at hand, and its standard error; inf for a
        handful of trials."""
        return _saving([trial for _, trial in self._trials])

    def _decide(self, saved: float, doubt: float) -> None:
        if math.isinf(doubt):
            return
        if self.looks_up:
            lately, unsure = _saving([trial for _, trial in self._trials][-LATELY:])
            may = saved + (0.0 if len(self._trials) == MANY else doubt)
            self.looks_up = may > OFF and lately + 2.0 * unsure > OFF
        else:
            self.looks_up = saved - SURE * doubt > ON
        due = sum(trial.due for _, trial in self._trials)
        known = sum(trial.known for _, trial in self._trials)
        if not self.looks_up and known > KNOWN * due and saved + doubt < ON and self._frame >= self._paused_until:
            self._paused_until = self._frame + PAUSE

    @property
    def reason(self) -> str:
        """What is done now, and why, in a sentence."""
        saved, doubt = self.saving
        if not self._ready:
            return "Every shadow ray is traced: certificates are not worth setting up yet."
        if self.looks_up:
            if math.isinf(doubt):
                return "Certificates are looked up: tracing is slow here, so they should save time; trials will tell."
            return f"Certificates are looked up: that saves {100.0 * saved:.0f} % of the shading time."
        if math.isinf(doubt):
            return "Every shadow ray is traced: certificates have had too few trials yet."
        if saved < 0.0:
            return f"Every shadow ray is traced: certificates would make shading {-100.0 * saved:.0f} % slower."
        return f"Every shadow ray is traced: certificates would save only {100.0 * saved:.0f} % of shading."


def _saving(pairs: list[Trial]) -> tuple[float, float]:
    """What look-ups save by these trials, and its standard error.  A pair that is far from all others, as one of them
    was disturbed, counts as less."""
    if len(pairs) < FEW:
        return 0.0, math.inf
    ratios = sorted(trial.certified / trial.plain for trial in pairs)
    low, high = ratios[len(ratios) // 10], ratios[-1 - len(ratios) // 10]
    certified = [trial.plain * min(max(trial.certified / trial.plain, low), high) for trial in pairs]
    whole = sum(trial.plain for trial in pairs)
    saved = 1.0 - sum(certified) / whole
    apart = sum((trial.plain * (1.0 - saved) - t) ** 2 for trial, t in zip(pairs, certified))
    return saved, math.sqrt(apart) / whole
