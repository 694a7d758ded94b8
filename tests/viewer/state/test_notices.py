"""What of the log has not been read yet."""

from __future__ import annotations

from viewer.state.notices import INFO_LASTS, Notices
from viewer.util.messages import failure


def test_errors_and_faults_are_unread_until_the_log_is_read():
    notices = Notices()
    notices.say("opened")
    assert notices.unread == []
    notices.say("cannot be opened", error=True)
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert [(entry.text, entry.count) for entry in notices.unread] == [
        ("cannot be opened", 1), ("RuntimeError: a mistake", 2),
    ]  # fmt: skip
    assert "a mistake" in notices.current.text and notices.current.error and "a mistake" in notices.newest_fault.as_text
    notices.mark_read()
    assert notices.unread == [] and len(notices.entries()) == 3 and notices.newest_fault is None
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert len(notices.unread) == 1, "it has come once more"
    notices.clear()
    assert notices.unread == []


def test_a_notice_goes_after_a_while_and_an_error_stays():
    notices = Notices()
    for error in (False, True):
        notices.say("said", error)
        assert notices.current.text == "said"
        notices.message.at -= INFO_LASTS
        assert (notices.current is not None) == error
