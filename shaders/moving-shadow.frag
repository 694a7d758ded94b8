// Shadows of moving objects over the paled picture in greys, on which pale colours say which rays ask dynamic objects
// only, and what moves.
uniform usampler2D moving_buffer;  // what moving objects have to do with each pixel and one light
uniform vec3 palette[5];           // nothing; asks them only, lit; the same, darkened; traced and darkened; one itself
uniform float pale;                // how far the picture is paled towards white
const uint DARK = 2u, TRACED = 3u;

void main() {
    ivec2 p = pixel();
    if (primitive_at(p) < 0) { finish(background); return; }
    uint code = texelFetch(moving_buffer, p, 0).r;
    float paled = mix(luminance(clamp(texelFetch(color_buffer, p, 0).rgb, 0.0, 1.0)), 1.0, pale);
    finish(code == DARK || code == TRACED ? shaded(palette[code]) : paled * palette[code]);
}
