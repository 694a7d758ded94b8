"""The paper's sections: `modes` (§2.2), `occlusion` (§2.3, §2.6), `shadow_testing` (§2.4; §2.5 is in
`tracer.methods.paper`), and `mode_history`, which keeps modes from frame to frame.  The packages in it prove what is
visible, each for its method.  Methods and shading use it; it asks the world about rays.
"""
