// Moving shadows, what asks dynamic objects only, and these, over the paled picture in greys.
uniform usampler2D moving_buffer;  // what moving objects have to do with each pixel and one light
uniform vec3 palette[5];           // nothing; asks them only, lit; the same, darkened; traced and darkened; one itself
uniform float pale;                // how far the picture is paled towards white

void main() {
    ivec2 p = pixel();
    if (primitive_at(p) < 0) { finish(background); return; }
    uint code = texelFetch(moving_buffer, p, 0).r;
    float paled = mix(luminance(clamp(texelFetch(color_buffer, p, 0).rgb, 0.0, 1.0)), 1.0, pale);
    finish(code == 0u ? vec3(paled) : shaded(palette[code]));
}
