"""Makes all kernels of a program ready before they are needed: `compilation` is what is called, `steps` lists them,
`processes` compiles them side by side, and `estimate` says how long that takes.  Only programs call it, as it imports
all that they start with.
"""
