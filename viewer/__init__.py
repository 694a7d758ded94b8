"""The viewer: everything a person touches, over the `tracer`.

    script           `viewer.show`, the window for scripts and notebooks
    cli | window     the command line; the window, which alone knows GL and widgets
    services         threads, files, runs, and the controller that wires them
    output           pictures, figures, legends, reports
    state            what the user looks at and has chosen
    util             files, messages, numbers

Each knows only what is below it.  `viewer.__main__` starts the command line, and hands it the window to open.
"""

from viewer.script import show

__all__ = ["show"]
