"""Lamps: lights with many samples, whose shadow rays are answered for all samples at once.

`find_lamp_answers` finds what is known of a wave's points and a lamp, by beams around vectors of points
(`area_light_query`); `recent_occluders` asks only what has just hidden a lamp from neighbours; `lamp_answers` keeps and
gives what either finds.  The methods `certified` of few and of many lights use them.
"""
