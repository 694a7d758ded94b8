// The occlusion mode of the unit that is seen: bits 0 and 1 of its word.
uniform vec3 palette[4];

void main() {
    int unit = unit_at(pixel());
    finish(unit < 0 ? background : shaded(palette[mode_bits(unit, 0)]));
}
