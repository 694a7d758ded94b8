// Rays traced for each pixel, from none to `top` and more.
uniform isampler2D cost_buffer;
uniform float top;

void main() { finish_mapped(float(texelFetch(cost_buffer, pixel(), 0).r) / top); }
