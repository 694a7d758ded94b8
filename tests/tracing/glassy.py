"""A small scene with all that rays can meet: glass, mirrors, a cone, and a triangle on its way."""

SCENE = """\
b 0.2 0.3 0.4
v from 0.3 2.2 5 at 0 0 0 up 0 1 0 angle 55 hither 1 resolution 32 32
l 2 4 3 1 1 1
l -3 4 -2 0.5 0.5 0.5
l 0.5 -3 1 0.5 0.5 0.5
f 0.8 0.6 0.4 0.9 0.2 10 0 1
p 4 -2 -0.5 -2 -2 -0.5 2 2 -0.5 2 2 -0.5 -2
p 3 -1.4 0.4 0 -0.6 0.9 0.2 -1.1 0.2 0.7
f 0.3 0.5 0.8 0.5 0.3 10 0.6 1.4
s 0 0 0 0.5
c
1 -0.5 0.4 0.35
1.2 0.3 0.3 0.1
x flyer { p 3 -0.5 0.9 0 0.5 0.9 0 0 1.0 0.9 }
k flyer { transl 4 -1 0 0 0 0 0 0  0 0 0 0 0 0 0  9 1 0 0 0 0 0  10 1 0 0 0 0 0 }
"""
