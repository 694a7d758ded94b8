"""The command line: what people type, and the commands that need no window.

`main` reads a command line; `render`, `bench`, `zoom` and `info` do what it says and print what came of it.
"""
