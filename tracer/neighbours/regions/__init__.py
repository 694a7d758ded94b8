"""Regions of space, and the lights that shine on nothing in them: what makes thousands of lights bearable.

`store` divides a scene into regions, and keeps the lights that each is left with, as far as rays have asked about it
and `tracer.visibility.hidden_lights` could prove it; `lookup` says which lights the points of a wave have to look at.
The methods `certified` and `lightcuts-certified` use it where there are more lights than a cell's word has room for.
"""
