"""The window, and the commands that need none: everything a person touches.

The viewer stands on `tracer` and is the only part that knows of GL, of a window and of
widgets.  `viewer.cli` and what it imports for `render` and `info` know none of them, so that
pictures and numbers can be had on machines without a screen or a GL library.
"""
