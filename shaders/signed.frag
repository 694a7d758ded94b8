// B - A: from `less` over `same` to `more`, as far as `limit` to both sides.
uniform sampler2D difference_buffer;
uniform float limit;
uniform vec3 less, same, more;
out vec4 result;

void main() {
    float t = clamp(texelFetch(difference_buffer, ivec2(gl_FragCoord.xy), 0).r / limit, -1.0, 1.0);
    result = vec4(mix(same, t < 0.0 ? less : more, abs(t)), 1.0);
}
