"""How the embedded scenes are made: geometry, textures and paths, all computed, all seeded."""
