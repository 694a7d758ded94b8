"""Edits of a scene, as the window's What if makes them: `edits` says what is changed, `carry_modes` what a renderer of
the edited scene may keep of the modes. Nothing that traces knows of it.
"""
