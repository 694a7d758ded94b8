"""The window: layout, panels, keys, and the picture drawn by GL.

The only package that may import GL, GLFW and ImGui."""
