// The occlusion mode of the primitive that is seen: bits 0 and 1 of its word.
uniform vec3 palette[4];

void main() {
    int primitive = primitive_at(pixel());
    finish(primitive < 0 ? background : shaded(palette[mode_bits(primitive, 0)]));
}
