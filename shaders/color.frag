// The traced picture: display-referred, so a clamp is all it needs.
void main() { finish(clamp(texelFetch(color_buffer, pixel(), 0).rgb, 0.0, 1.0)); }
