// The shading normal, -1 to 1 on each axis shown as 0 to 1.
uniform sampler2D normal_buffer;

void main() {
    vec3 normal = texelFetch(normal_buffer, pixel(), 0).rgb;
    finish(primitive_at(pixel()) < 0 ? background : normal * 0.5 + 0.5);
}
