// How many samples of one light reach each pixel, of those that it faces: all, none or, on a ramp, some.
uniform usampler2D penumbra_buffer;  // samples that the pixel faces, and those that reach it; more where not known yet
uniform vec3 palette[6];             // it faces none, none reach it, a few do, most do, all do; not known yet

void main() {
    ivec2 p = pixel();
    if (primitive_at(p) < 0) { finish(background); return; }
    uvec2 samples = texelFetch(penumbra_buffer, p, 0).rg;
    vec3 color = mix(palette[2], palette[3], float(samples.y) / float(max(samples.x, 1u)));
    if (samples.y == samples.x) color = palette[4];
    if (samples.y == 0u) color = palette[1];
    if (samples.x == 0u) color = palette[samples.y == 0u ? 0 : 5];
    finish(shaded(color));
}
