// The shadow mode of the primitive that is seen, for one light: bits 2 + 2 l and the next. Primitives that move
// (occlusion mode 3) have none and get the palette's last colour; so has a light that culling does not cover.
uniform vec3 palette[5];
uniform int light;  // -1: not covered by culling
const int DYNAMIC = 3;

void main() {
    int primitive = primitive_at(pixel());
    if (primitive < 0) { finish(background); return; }
    int mode = light < 0 ? 0 : mode_bits(primitive, 2 + 2 * light);
    if (mode_bits(primitive, 0) == DYNAMIC) mode = 4;
    finish(shaded(palette[mode]));
}
