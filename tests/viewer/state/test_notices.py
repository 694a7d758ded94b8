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
    assert [entry.text for entry in notices.unread] == ["cannot be opened", "RuntimeError: a mistake"]
    notices.fault(failure(RuntimeError("a mistake"), known=()))
    assert len(notices.unread) == 2, "the same again is counted once"
    notices.mark_read()
    assert notices.unread == [] and len(notices.entries()) == 3
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


def test_an_internal_error_is_counted_and_stands_in_the_status_bar_until_the_next_line():
    notices = Notices()
    for text in ("one", "two", "one"):
        notices.fault(failure(RuntimeError(text), known=()))
    assert [entry.count for entry in notices.entries()] == [2, 1] and "two" in notices.newest_fault.as_text
    assert "one" in notices.current.text and notices.current.error
    notices.mark_read()
    assert notices.newest_fault is None
