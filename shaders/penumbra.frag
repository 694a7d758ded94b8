// How many samples of one light reach each pixel, of those that it faces: all, none or, on a ramp, some.
uniform usampler2D penumbra_buffer;  // samples that the pixel faces, and those of them that reach it
uniform vec3 palette[5];             // it faces none, none reach it, a few do, most do, all do

void main() {
    ivec2 p = pixel();
    if (primitive_at(p) < 0) { finish(background); return; }
    uvec2 samples = texelFetch(penumbra_buffer, p, 0).rg;
    vec3 color = mix(palette[2], palette[3], float(samples.y) / float(max(samples.x, 1u)));
    if (samples.y == samples.x) color = palette[4];
    if (samples.y == 0u) color = palette[1];
    finish(shaded(samples.x == 0u ? palette[0] : color));
}
