"""The command line: `main` reads it, and each command, in the file of its name, does what it says."""
