// What became of each pixel's shadow ray to one light.
uniform usampler2D fate_buffer;  // the fate, 0 where it is not known yet
uniform vec3 palette[11];        // of all fates

void main() {
    ivec2 p = pixel();
    finish(primitive_at(p) < 0 ? background : shaded(palette[texelFetch(fate_buffer, p, 0).r]));
}
