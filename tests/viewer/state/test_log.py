"""What of the log has not been read yet."""

from __future__ import annotations

from viewer.state.notices import Notices
from viewer.util.failures import failure


def test_errors_and_faults_are_unread_until_the_log_is_read():
    notices = Notices()
    notices.say("opened")
    assert notices.log.unread == []
    notices.say("cannot be opened", error=True)
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert [entry.text for entry in notices.log.unread] == ["cannot be opened", "RuntimeError: a mistake"]
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert len(notices.log.unread) == 2, "the same again is counted once"
    notices.log.read()
    assert notices.log.unread == [] and len(notices.log.entries()) == 3
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert len(notices.log.unread) == 1, "it has come once more"
    notices.log.clear()
    assert notices.log.unread == []
