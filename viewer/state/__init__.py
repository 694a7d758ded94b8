"""What the user looks at and has chosen, as plain values: scene, camera, time, settings, view, history, messages.

Nothing here starts a thread, draws or traces."""
