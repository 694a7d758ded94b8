"""What works for the window and the user while they go on: threads, files, runs, and the controller that wires them.

Nothing here knows widgets or GL, so that all of it can be driven without a window."""
