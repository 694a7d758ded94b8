// The shadow mode of the unit that is seen, for one light: bits 2 + 2 l and the next. Units that move
// (occlusion mode 3) have none and get the palette's last colour; so has a light that culling does not cover.
uniform vec3 palette[5];
uniform int light;  // -1: not covered by culling
const int DYNAMIC = 3;

void main() {
    int unit = unit_at(pixel());
    if (unit < 0) { finish(background); return; }
    int mode = light < 0 ? 0 : mode_bits(unit, 2 + 2 * light);
    if (mode_bits(unit, 0) == DYNAMIC) mode = 4;
    finish(shaded(palette[mode]));
}
