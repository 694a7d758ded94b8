"""What of the log has not been read yet."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from viewer.state.notices import Notices
from viewer.util.messages import failure


def test_errors_and_faults_are_unread_until_the_log_is_read():
    notices = Notices()
    notices.say("opened")
    assert notices.log.unread == []
    notices.say("cannot be opened", error=True)
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert [entry.text for entry in notices.log.unread] == ["cannot be opened", "RuntimeError: a mistake"]
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert len(notices.log.unread) == 2, "the same again is counted once"
    notices.log.mark_read()
    assert notices.log.unread == [] and len(notices.log.entries()) == 3
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert len(notices.log.unread) == 1, "it has come once more"
    notices.log.clear()
    assert notices.log.unread == []


def test_a_newer_notice_survives_the_end_of_an_older(monkeypatch: pytest.MonkeyPatch):
    """A thread may say something while the window looks whether the last notice is old."""
    notices = Notices()
    notices.say("older")

    def now() -> float:
        if notices.message.text == "older":
            monkeypatch.setattr(time, "monotonic", lambda: 100.0)
            notices.say("newer")
        return 100.0

    notices.message = replace(notices.message, at=0.0)
    monkeypatch.setattr(time, "monotonic", now)
    notices.current  # noqa: B018
    assert notices.message.text == "newer" and notices.current is notices.message
