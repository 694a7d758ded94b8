"""The light buffer: what each light sees in each direction, proved with the roundings of float32.

A cube of cells stands around a light (`cube`).  Faces are divided (`divide`) by the functions of what may be seen there
(`items`), and what is then known of cells is kept (`cubes`).  Rays are looked up (`lookup`), and tested
against the candidates of their cells (`candidates`); what moves has depths of its own (`moving`), and `tell` says all
for people. Only the method `lightbuffer` uses it, and what shows it."""
