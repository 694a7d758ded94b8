// Shadow rays of each pixel that were spared, from none to `top` and more.
uniform isampler2D saved_buffer;
uniform float top;

void main() { finish_mapped(float(texelFetch(saved_buffer, pixel(), 0).r) / top); }
