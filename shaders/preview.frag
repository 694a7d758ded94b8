// Diffuse light of a few lamps, which nothing stands in the way of; no shadows, no reflections.
in vec3 seen;
in vec3 outward;
in vec3 tint;
uniform vec3 eye;
uniform vec3 sky;                // ambient light
uniform vec3 lights[16];         // place and colour of each
uniform int light_count;

out vec4 result;

void main() {
    vec3 geometric = normalize(cross(dFdx(seen), dFdy(seen)));
    if (dot(geometric, seen) > 0.0) geometric = -geometric;
    vec3 normal = dot(outward, outward) > 0.0 ? normalize(outward) : geometric;
    if (dot(normal, geometric) < 0.0) normal = -normal;
    vec3 light = sky;
    for (int i = 0; i < light_count; ++i) {
        vec3 to = lights[2 * i] - eye - seen;
        light += lights[2 * i + 1] * max(dot(normal, normalize(to)), 0.0);
    }
    result = vec4(clamp(light * tint, 0.0, 1.0), 1.0);
}
