// The traced picture, by the tone that is chosen.
void main() { finish(marked_where_clipped(texelFetch(color_buffer, pixel(), 0).rgb)); }
