"""The panels: each a function that shows one part of the state and offers what can be done to it."""
